#pragma once

#include "core/math/mat3.hpp"
#include "core/physics/law_constants.hpp"

namespace fascia {

/// Green-Lagrange strain E = (FᵀF − I)/2 of F = I + H, without the cancellation that FᵀF − I has for small H.
template <class T>
FASCIA_HD constexpr Mat3<T> green_strain(const Mat3<T>& H) {
  return sym(H) + transpose_times(H, H) * T(0.5);
}

/// St Venant-Kirchhoff: ψ = λ/2 (tr E)² + μ E:E  [J/m³].
template <class T>
struct StVenantKirchhoff {
  static constexpr bool kSmall = false;
  static constexpr int kOwn = 0;
  T lambda, mu;  ///< [Pa]

  /// Second Piola-Kirchhoff stress S = λ tr(E) I + 2μ E  [Pa]; linear, so it also maps dE to dS.
  FASCIA_HD constexpr Mat3<T> second_piola(const Mat3<T>& E) const {
    return Mat3<T>::diagonal(lambda * trace(E)) + E * (T(2) * mu);
  }
  /// ψ [J/m³]
  FASCIA_HD constexpr T energy_density(const Mat3<T>& E) const {
    const T t = trace(E);
    return T(0.5) * lambda * t * t + mu * contract(E, E);
  }

  // This is a law of solids (solid_law.hpp) with θ = tr E.
  struct At {
    FASCIA_HD explicit At(const Mat3<T>&) {}
    At() = default;
  };
  FASCIA_HD static Mat3<T> strain(const Mat3<T>& H) { return green_strain(H); }
  FASCIA_HD static T volumetric_strain(const Mat3<T>& H) { return trace(green_strain(H)); }
  FASCIA_HD static Mat3<T> volumetric_gradient(const Mat3<T>& H) { return Mat3<T>::identity() + H; }
  FASCIA_HD T volumetric_modulus() const { return lambda; }
  FASCIA_HD T shear_energy(const Mat3<T>& H) const {
    const Mat3<T> E = green_strain(H);
    return mu * contract(E, E);
  }
  FASCIA_HD Mat3<T> second_piola(const At&, const Mat3<T>& E, const T& p) const {
    return E * (T(2) * mu) + Mat3<T>::diagonal(p);
  }
  FASCIA_HD Mat3<T> second_piola_differential(const At&, const T&, const T& k, const Mat3<T>& dE, bool /*full*/) const {
    return StVenantKirchhoff{k, mu}.second_piola(dE);
  }
};

}  // namespace fascia
