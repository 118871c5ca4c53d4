#pragma once

#include "core/physics/st_venant_kirchhoff.hpp"

/// What happens at one integration point: St Venant-Kirchhoff stress, viscous stress and the drilling term, which ties
/// the blended rotation Qbar = Σ w Q to the rotation in F. Everything that a frame feels follows from P and Y:
///
///   f = v P g,   L = v (P (Q B)ᵀ + w Y Qᵀ),   torque = axl(Lᵀ),   rotation-rotation tangent = sym(L) − tr(L) I.
namespace fascia {

template <class T>
struct PointMaterial {
  T volume, lambda, mu;  ///< [m³], [Pa], [Pa]
  T drilling;            ///< γ [Pa]
  T viscosity;           ///< κ = β/dt [-]: viscous stress κ C : (E − E_old)
};

/// Displacement gradient H = F − I and blended rotation increment Dbar = Σ w (Q − I).
template <class T>
struct PointMotion {
  Mat3<T> H, Dbar;
};

template <class T>
struct PointStress {
  Mat3<T> P;  ///< first Piola-Kirchhoff stress with all terms [Pa]
  Mat3<T> Y;  ///< F Tᵀ [Pa], conjugate to Qbar
  Mat3<T> S;  ///< second Piola-Kirchhoff stress, elastic and viscous [Pa]
  Mat3<T> E;  ///< Green-Lagrange strain [-]
};

/// γ (M − Mᵀ) with M = QbarᵀF, formed from H and Dbar so that small rotations keep their digits.
template <class T>
FASCIA_HD Mat3<T> drilling_stress(const PointMotion<T>& x, const T& gamma) {
  const Mat3<T> M = transpose(x.Dbar) + x.H + transpose_times(x.Dbar, x.H);
  return (M - transpose(M)) * gamma;
}

/// Stress of a point. With `Drilling` false, γ is taken as zero and Y stays zero.
///
/// @param E_old  strain at the start of the time step, used where material.viscosity is not zero
template <bool Drilling, class T>
FASCIA_HD PointStress<T> point_stress(const PointMotion<T>& x, const PointMaterial<T>& material, const Mat3<T>& E_old) {
  const StVenantKirchhoff<T> law{material.lambda, material.mu};
  PointStress<T> r;
  r.E = green_strain(x.H);
  r.S = law.second_piola(r.E + (r.E - E_old) * material.viscosity);
  r.P = r.S + x.H * r.S;
  if constexpr (Drilling) {
    const Mat3<T> Tm = drilling_stress(x, material.drilling);
    r.P += Tm + x.Dbar * Tm;
    const Mat3<T> Tt = transpose(Tm);
    r.Y = Tt + x.H * Tt;
  }
  return r;
}

/// Energies of a point [J]: elastic; drilling v/(4γ) T:T; viscous v κ ψ(E − E_old).
template <class T>
struct PointEnergy {
  T elastic{}, drilling{}, viscous{};
};

template <class T>
FASCIA_HD PointEnergy<T> point_energy(const PointMotion<T>& x, const PointMaterial<T>& material, const Mat3<T>& E_old) {
  const StVenantKirchhoff<T> law{material.lambda, material.mu};
  const Mat3<T> E = green_strain(x.H);
  const Mat3<T> M = drilling_stress(x, T(1));
  return {material.volume * law.energy_density(E), material.volume * material.drilling * T(0.25) * contract(M, M),
          material.volume * material.viscosity * law.energy_density(E - E_old)};
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
template <bool Drilling, class T>
FASCIA_HD PointStressDifferential<T> point_stress_differential(const PointMotion<T>& x, const Mat3<T>& S,
                                                               const PointMaterial<T>& material, Tangent tangent,
                                                               const Mat3<T>& dH, const Mat3<T>& dQbar) {
  const StVenantKirchhoff<T> law{material.lambda, material.mu};
  PointStressDifferential<T> r;
  const Mat3<T> dE = sym(dH + transpose_times(x.H, dH));
  const Mat3<T> dS = law.second_piola(dE) * (T(1) + material.viscosity);
  r.dP = dS + x.H * dS;
  if (tangent == Tangent::full) r.dP += dH * S;
  if constexpr (Drilling) {
    const Mat3<T> dM = transpose(dQbar) + transpose_times(dQbar, x.H) + dH + transpose_times(x.Dbar, dH);
    const Mat3<T> dT = (dM - transpose(dM)) * material.drilling;
    const Mat3<T> dTt = transpose(dT);
    r.dP += dT + x.Dbar * dT;
    r.dY = dTt + x.H * dTt;
    if (tangent == Tangent::full) {
      const Mat3<T> Tm = drilling_stress(x, material.drilling);
      r.dP += dQbar * Tm;
      r.dY += times_transpose(dH, Tm);
    }
  }
  return r;
}

}  // namespace fascia
