#pragma once

#include "core/math/batch.hpp"
#include "core/physics/st_venant_kirchhoff.hpp"

namespace fascia {

/// J − 1 of F = I + H, without the cancellation that det F − 1 has for small H.
template <class T>
FASCIA_HD constexpr T volume_change(const Mat3<T>& H) {
  const T t = trace(H);
  return t + T(0.5) * (t * t - contract(H, transpose(H))) + determinant(H);
}

/// Cofactors of I + H: J F⁻ᵀ, the derivative of J.
template <class T>
FASCIA_HD constexpr Mat3<T> cofactor(const Mat3<T>& F) {
  return transpose(
      Mat3<T>::from_columns(cross(F.row(1), F.row(2)), cross(F.row(2), F.row(0)), cross(F.row(0), F.row(1))));
}

/// d(cofactor) for dF.
template <class T>
FASCIA_HD constexpr Mat3<T> cofactor_differential(const Mat3<T>& F, const Mat3<T>& dF) {
  const auto part = [&](int i, int j) { return cross(dF.row(i), F.row(j)) + cross(F.row(i), dF.row(j)); };
  return transpose(Mat3<T>::from_columns(part(1, 2), part(2, 0), part(0, 1)));
}

/// Compressible neo-Hookean material: ψ = μ/2 (tr C − 3) − μ ln J + λ/2 (ln J)²  [J/m³] (Bonet and Wood 2008, 6.28).
/// Not finite where J ≤ 0: no finite load turns it inside out.
template <class T>
struct NeoHookean {
  T lambda, mu;  ///< [Pa]

  /// ln J
  FASCIA_HD static T log_volume(const Mat3<T>& H) {
    using std::log1p;
    return log1p(volume_change(H));
  }
  FASCIA_HD static Mat3<T> inverse_right_cauchy_green(const Mat3<T>& H) {
    const Mat3<T> F_inverse = inverse(Mat3<T>::identity() + H);
    return times_transpose(F_inverse, F_inverse);
  }

  /// S = μ (I − C⁻¹) + λ ln J C⁻¹  [Pa]
  FASCIA_HD Mat3<T> second_piola(const Mat3<T>& H) const {
    const Mat3<T> C_inverse = inverse_right_cauchy_green(H);
    return second_piola(green_strain(H), C_inverse, lambda * log_volume(H));
  }
  /// The same with a pressure-like p in the place of λ ln J.
  FASCIA_HD Mat3<T> second_piola(const Mat3<T>& E, const Mat3<T>& C_inverse, const T& p) const {
    return (C_inverse * E) * (T(2) * mu) + C_inverse * p;
  }
  /// tr E − ln J, which is zero to the square of rounding for rotations: ln J = ln det(I + 2E)/2 from the same E. Not
  /// finite where J ≤ 0.
  FASCIA_HD static T distortion(const Mat3<T>& H) {
    using std::log1p;
    const Mat3<T> E = green_strain(H);
    const T change = volume_change(H);
    return trace(E) - where_positive(change + T(1), T(0.5) * log1p(volume_change(E * T(2))), log1p(change));
  }
  /// ψ [J/m³]
  FASCIA_HD T energy_density(const Mat3<T>& H) const {
    const T l = log_volume(H);
    return mu * distortion(H) + T(0.5) * lambda * l * l;
  }
  /// dS = 2 (μ − λ ln J) C⁻¹ dE C⁻¹ + λ (C⁻¹ : dE) C⁻¹  [Pa]
  FASCIA_HD Mat3<T> second_piola_differential(const Mat3<T>& H, const Mat3<T>& dE) const {
    const Mat3<T> C_inverse = inverse_right_cauchy_green(H);
    return C_inverse * dE * C_inverse * (T(2) * (mu - lambda * log_volume(H))) +
           C_inverse * (lambda * contract(C_inverse, dE));
  }
};

}  // namespace fascia
