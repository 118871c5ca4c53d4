#pragma once

#include "core/physics/point_law.hpp"

#include <type_traits>

/// What happens at one integration point: elastic stress, viscous stress and stabilisation. Drilling ties the blended
/// rotation Qbar = Σ w Q to the rotation in F; with affine frames the blended A is tied to all of F. Everything that a
/// frame feels follows from P and Y:
///
///   f = v P g,   N = v (P Bᵀ + w Y) conjugate to Q or A,   L = N Qᵀ,   torque = axl(Lᵀ),
///   rotation-rotation tangent of a rigid frame = sym(L) − tr(L) I.
namespace fascia {

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

/// γ (M − Mᵀ) with M = QbarᵀF, formed from H and Dbar so that small rotations keep their digits.
template <class T>
FASCIA_HD Mat3<T> drilling_stress(const PointMotion<T>& x, const T& gamma) {
  const Mat3<T> M = transpose(x.Dbar) + x.H + transpose_times(x.Dbar, x.H);
  return (M - transpose(M)) * gamma;
}

/// K (displacement − target) in the first column.
template <class T>
FASCIA_HD Mat3<T> tether_stress(const ThinMaterial<T>& material, const Vec3<T>& stretch) {
  Mat3<T> P;
  const Vec3<T> force = material.axes * stretch;
  for (int i = 0; i < 3; ++i) P(i, 0) = force[i];
  return P;
}

/// Stress of a point.
///
/// @param E_old  strain at the start of the time step, used where material.viscosity is not zero
template <Stabilization Tie, class T, template <class> class Material>
FASCIA_HD PointStress<T> point_stress(const PointMotion<T>& x, const Material<T>& material, const Mat3<T>& E_old) {
  PointStress<T> r;
  if constexpr (std::is_same_v<Material<T>, ThinMaterial<T>>) {
    if (material.law == Law::tether) {
      r.P = tether_stress(material, x.H.column(0) - material.target);
      return r;
    }
  }
  const Mat3<T> E = green_strain(x.H);
  r.S = stress(material, x.H, E, E_old);
  r.P = r.S + x.H * r.S;
  if constexpr (Tie == Stabilization::drilling) {
    const Mat3<T> Tm = drilling_stress(x, material.stabilization);
    r.P += Tm + x.Dbar * Tm;
    const Mat3<T> Tt = transpose(Tm);
    r.Y = Tt + x.H * Tt;
  }
  if constexpr (Tie == Stabilization::affine) {
    const Mat3<T> G = (x.H - x.Dbar) * material.stabilization;
    r.P += G;
    r.Y = G * T(-1);
  }
  return r;
}

/// Energies of a point [J]: elastic; stabilisation (drilling v/(4γ) T:T, affine v γ/2 |F − Σ w A|²) and tethers;
/// viscous v κ ψ(E − E_old).
template <class T>
struct PointEnergy {
  T elastic{}, stabilization{}, viscous{};
};

template <Stabilization Tie, class T, template <class> class Material>
FASCIA_HD PointEnergy<T> point_energy(const PointMotion<T>& x, const Material<T>& material, const Mat3<T>& E_old) {
  PointEnergy<T> r;
  if constexpr (std::is_same_v<Material<T>, ThinMaterial<T>>) {
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
    const Mat3<T> M = drilling_stress(x, T(1));
    r.stabilization = material.volume * material.stabilization * T(0.25) * contract(M, M);
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

/// Directional derivative of P and Y.
///
/// @param dH     direction of F, with the frames' rotations
/// @param dQbar  direction of Qbar
template <Stabilization Tie, class T, template <class> class Material>
FASCIA_HD PointStressDifferential<T> point_stress_differential(const PointMotion<T>& x, const Mat3<T>& S,
                                                               const Material<T>& material, Tangent tangent,
                                                               const Mat3<T>& dH, const Mat3<T>& dQbar) {
  PointStressDifferential<T> r;
  if constexpr (std::is_same_v<Material<T>, ThinMaterial<T>>) {
    if (material.law == Law::tether) {
      r.dP = tether_stress(material, dH.column(0));
      return r;
    }
  }
  const Mat3<T> dE = sym(dH + transpose_times(x.H, dH));
  const Mat3<T> dS = stress_differential(material, x.H, dE);
  r.dP = dS + x.H * dS;
  if (tangent == Tangent::full) r.dP += dH * S;
  if constexpr (Tie == Stabilization::drilling) {
    const Mat3<T> dM = transpose(dQbar) + transpose_times(dQbar, x.H) + dH + transpose_times(x.Dbar, dH);
    const Mat3<T> dT = (dM - transpose(dM)) * material.stabilization;
    const Mat3<T> dTt = transpose(dT);
    r.dP += dT + x.Dbar * dT;
    r.dY = dTt + x.H * dTt;
    if (tangent == Tangent::full) {
      const Mat3<T> Tm = drilling_stress(x, material.stabilization);
      r.dP += dQbar * Tm;
      r.dY += times_transpose(dH, Tm);
    }
  }
  if constexpr (Tie == Stabilization::affine) {
    const Mat3<T> dG = (dH - dQbar) * material.stabilization;
    r.dP += dG;
    r.dY = dG * T(-1);
  }
  return r;
}

}  // namespace fascia
