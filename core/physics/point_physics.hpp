#pragma once

#include "core/physics/point_law.hpp"

#include <type_traits>

/// Physics of one integration point: elastic stress, viscous stress and stabilisation. Drilling ties the blended
/// rotation Qbar = Σ w Q to the rotation in F; with affine frames the blended A is tied to all of F. Everything that a
/// frame feels follows from P and Y:
///
///   f = v P g,   N = v (P Bᵀ + w Y) conjugate to Q or A,   L = N Qᵀ,   torque = axl(Lᵀ),
///   rotation-rotation tangent of a rigid frame = sym(L) − tr(L) I.
namespace fascia {

/// Calls act.operator()<Stabilization>().
template <class Act>
FASCIA_HD void with_stabilization(Stabilization tie, const Act& act) {
  switch (tie) {
    case Stabilization::none:
      return act.template operator()<Stabilization::none>();
    case Stabilization::drilling:
      return act.template operator()<Stabilization::drilling>();
    case Stabilization::affine:
      return act.template operator()<Stabilization::affine>();
  }
}

/// Calls act.operator()<L>() for a law of points; all thin ones are one.
template <class Act>
FASCIA_HD void with_point_law(Law law, const Act& act) {
  if (is_thin(law))
    act.template operator()<Law::sheet>();
  else
    with_solid_law(law, act);
}

/// Calls act.operator()<Kind>() for a rule.
template <class Act>
FASCIA_HD void with_kind(const PointRule& rule, const Act& act) {
  with_point_law(rule.law, [&]<Law L>() {
    with_stabilization(rule.stabilization, [&]<Stabilization Tie>() { act.template operator()<PointKind{Tie, L}>(); });
  });
}

/// Displacement gradient H = F − I and blended rotation increment Dbar = Σ w (Q − I). Of a tether, H's first column is
/// the displacement of the point.
template <class T>
struct PointMotion {
  Mat3<T> H, Dbar;
};

template <class T>
struct PointStress {
  Mat3<T> P;  ///< first Piola-Kirchhoff stress with all terms [Pa]
  Mat3<T> Y;  ///< conjugate to Qbar [Pa]
  Mat3<T> S;  ///< second Piola-Kirchhoff stress, elastic and viscous [Pa]
};

/// The stresses that the tangent's geometric part is made of.
template <class T>
struct TangentStress {
  Mat3<T> S;         ///< second Piola-Kirchhoff stress, elastic and viscous [Pa]
  Vec3<T> drilling;  ///< the drilling stress is skew(drilling) [Pa]
};

/// M − I of M = QbarᵀF, formed from H and Dbar so that small rotations keep their digits.
template <class T>
FASCIA_HD Mat3<T> drilling_motion(const PointMotion<T>& x) {
  return transpose(x.Dbar) + x.H + transpose_times(x.Dbar, x.H);
}
template <class T>
FASCIA_HD Mat3<T> drilling_differential(const PointMotion<T>& x, const PointMotion<T>& d) {
  return transpose(d.Dbar) + transpose_times(d.Dbar, x.H) + d.H + transpose_times(x.Dbar, d.H);
}
/// t of γ (M − Mᵀ) = skew(t).
template <class T>
FASCIA_HD Vec3<T> drilling_axis(const Mat3<T>& M, const T& gamma) {
  return axl(M) * -gamma;
}

/// K (displacement − target) in the first column.
template <class T>
FASCIA_HD Mat3<T> tether_stress(const ThinMaterial<T>& material, const Vec3<T>& stretch) {
  Mat3<T> P;
  const Vec3<T> force = material.axes * stretch;
  for (int i = 0; i < 3; ++i) P(i, 0) = force[i];
  return P;
}

/// These stresses of a point at a state. A tether's tangent has none.
///
/// @param E_old  strain at the start of the time step, used where material.viscosity is not zero
template <Stabilization Tie, class T, class Material>
FASCIA_HD TangentStress<T> tangent_stress(const PointMotion<T>& x, const Material& material, const Mat3<T>& E_old) {
  TangentStress<T> r{stress(material, x.H, green_strain(x.H), E_old), {}};
  if constexpr (Tie == Stabilization::drilling) r.drilling = drilling_axis(drilling_motion(x), material.stabilization);
  return r;
}

/// Extrapolated along a step: at its start, with the first-order change. A full step of Newton's method turns a slender
/// body and stretches it by the square of that, which the next step takes back: the stress of the stretch, let into the
/// tangent, would make it too stiff or indefinite (Magisano, Leonetti and Garcea 2017: mixed integration points;
/// docs/decisions/extrapolated_stress.md). Where steps are small it is the stress at the end, to the square of the
/// step.
template <Stabilization Tie, class T, class Material>
FASCIA_HD TangentStress<T> extrapolated_stress(const PointMotion<T>& start, const PointMotion<T>& step,
                                               const Material& material, const Mat3<T>& E_old) {
  TangentStress<T> r = tangent_stress<Tie>(start, material, E_old);
  r.S += stress_differential(material, start.H, sym(step.H + transpose_times(start.H, step.H)));
  if constexpr (Tie == Stabilization::drilling)
    r.drilling += drilling_axis(drilling_differential(start, step), material.stabilization);
  return r;
}

/// P and Y of a point with given stresses.
template <Stabilization Tie, class T, class Material>
FASCIA_HD PointStress<T> point_stress(const PointMotion<T>& x, const Material& material, const TangentStress<T>& s) {
  PointStress<T> r;
  r.S = s.S;
  r.P = r.S + x.H * r.S;
  if constexpr (Tie == Stabilization::drilling) {
    const Mat3<T> Tm = skew(s.drilling), Tt = transpose(Tm);
    r.P += Tm + x.Dbar * Tm;
    r.Y = Tt + x.H * Tt;
  }
  if constexpr (Tie == Stabilization::affine) {
    const Mat3<T> G = (x.H - x.Dbar) * material.stabilization;
    r.P += G;
    r.Y = G * T(-1);
  }
  return r;
}

/// Stress of a point at a state.
template <Stabilization Tie, class T, class Material>
FASCIA_HD PointStress<T> point_stress(const PointMotion<T>& x, const Material& material, const Mat3<T>& E_old) {
  if constexpr (std::is_same_v<Material, ThinMaterial<T>>) {
    if (material.law == Law::tether) {
      PointStress<T> r;
      r.P = tether_stress(material, x.H.column(0) - material.target);
      return r;
    }
  }
  return point_stress<Tie>(x, material, tangent_stress<Tie>(x, material, E_old));
}

/// Energies of a point [J]: elastic; stabilisation (drilling v/(4γ) T:T, affine v γ/2 |F − Σ w A|²) and tethers;
/// viscous v κ ψ(E − E_old).
template <class T>
struct PointEnergy {
  T elastic{}, stabilization{}, viscous{};
};

template <Stabilization Tie, class T, class Material>
FASCIA_HD PointEnergy<T> point_energy(const PointMotion<T>& x, const Material& material, const Mat3<T>& E_old) {
  PointEnergy<T> r;
  if constexpr (std::is_same_v<Material, ThinMaterial<T>>) {
    if (material.law == Law::tether) {
      const Vec3<T> stretch = x.H.column(0) - material.target;
      r.stabilization = material.volume * T(0.5) * dot(stretch, material.axes * stretch);
      return r;
    }
  }
  const Mat3<T> E = green_strain(x.H);
  r.elastic = material.volume * elastic_energy(material, x.H, E);
  r.viscous = material.volume * material.viscosity * energy_density(material, E - E_old);
  if constexpr (Tie == Stabilization::drilling) {
    const Vec3<T> t = drilling_axis(drilling_motion(x), T(1));
    r.stabilization = material.volume * material.stabilization * T(0.5) * squared_norm(t);
  }
  if constexpr (Tie == Stabilization::affine) {
    const Mat3<T> G = x.H - x.Dbar;
    r.stabilization = material.volume * material.stabilization * T(0.5) * contract(G, G);
  }
  return r;
}

/// The second derivative, or its positive semidefinite part: without δF S and all that turns with a frame (the 2014
/// paper's tangent), drilling by Gauss-Newton.
enum class Tangent { full, material };

template <class T>
struct PointStressDifferential {
  Mat3<T> dP, dY;
};

/// Adds what a tie of the frames' rotations to F gives the directional derivative of P and Y.
template <Stabilization Tie, class T, class Material>
FASCIA_HD void add_tie_differential(const PointMotion<T>& x, const TangentStress<T>& s, const Material& material,
                                    Tangent tangent, const PointMotion<T>& d, PointStressDifferential<T>& r) {
  if constexpr (Tie == Stabilization::drilling) {
    const Mat3<T> dT = skew(drilling_axis(drilling_differential(x, d), material.stabilization)), dTt = transpose(dT);
    r.dP += dT + x.Dbar * dT;
    r.dY = dTt + x.H * dTt;
    if (tangent == Tangent::full) {
      const Mat3<T> Tm = skew(s.drilling);
      r.dP += d.Dbar * Tm;
      r.dY += times_transpose(d.H, Tm);
    }
  }
  if constexpr (Tie == Stabilization::affine) {
    const Mat3<T> dG = (d.H - d.Dbar) * material.stabilization;
    r.dP += dG;
    r.dY = dG * T(-1);
  }
}

/// Directional derivative of P and Y, with the frames' rotations.
///
/// @param s  the stresses of the geometric part: tangent_stress(), or extrapolated
/// @param d  direction
template <Stabilization Tie, class T, class Material>
FASCIA_HD PointStressDifferential<T> point_stress_differential(const PointMotion<T>& x, const TangentStress<T>& s,
                                                               const Material& material, Tangent tangent,
                                                               const PointMotion<T>& d) {
  PointStressDifferential<T> r;
  if constexpr (std::is_same_v<Material, ThinMaterial<T>>) {
    if (material.law == Law::tether) {
      r.dP = tether_stress(material, d.H.column(0));
      return r;
    }
  }
  const Mat3<T> dE = sym(d.H + transpose_times(x.H, d.H));
  const Mat3<T> dS = stress_differential(material, x.H, dE);
  r.dP = dS + x.H * dS;
  if (tangent == Tangent::full) r.dP += d.H * s.S;
  add_tie_differential<Tie>(x, s, material, tangent, d, r);
  return r;
}

}  // namespace fascia
