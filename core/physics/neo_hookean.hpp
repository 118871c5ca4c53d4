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
  static constexpr bool kSmall = false;
  static constexpr int kOwn = 0;
  T lambda, mu;  ///< [Pa]

  /// ln J
  FASCIA_HD static T log_volume(const Mat3<T>& H) {
    using std::log1p;
    return log1p(volume_change(H));
  }
  /// tr E − ln J, which is zero to the square of rounding for rotations: ln J = ln det(I + 2E)/2 from the same E. Not
  /// finite where J ≤ 0.
  FASCIA_HD static T distortion(const Mat3<T>& H) {
    using std::log1p;
    const Mat3<T> E = green_strain(H);
    const T change = volume_change(H);
    return trace(E) - where_positive(change + T(1), T(0.5) * log1p(volume_change(E * T(2))), log1p(change));
  }

  // This is a law of solids (solid_law.hpp) with θ = ln J.
  struct At {
    Mat3<T> F_inverse;
    FASCIA_HD explicit At(const Mat3<T>& H) : F_inverse(inverse(Mat3<T>::identity() + H)) {}
    At() = default;
    FASCIA_HD Mat3<T> C_inverse() const { return times_transpose(F_inverse, F_inverse); }
  };
  FASCIA_HD static Mat3<T> strain(const Mat3<T>& H) { return green_strain(H); }
  FASCIA_HD static T volumetric_strain(const Mat3<T>& H) { return log_volume(H); }
  FASCIA_HD static Mat3<T> volumetric_gradient(const Mat3<T>& H) { return transpose(inverse(Mat3<T>::identity() + H)); }
  FASCIA_HD T volumetric_modulus() const { return lambda; }
  FASCIA_HD T shear_energy(const Mat3<T>& H) const { return mu * distortion(H); }
  /// S = μ (I − C⁻¹) + p C⁻¹  [Pa]
  FASCIA_HD Mat3<T> second_piola(const At& at, const Mat3<T>& E, const T& p) const {
    const Mat3<T> C_inverse = at.C_inverse();
    return (C_inverse * E) * (T(2) * mu) + C_inverse * p;
  }
  /// dS = 2 (μ − p) C⁻¹ dE C⁻¹ + k (C⁻¹ : dE) C⁻¹  [Pa]
  FASCIA_HD Mat3<T> second_piola_differential(const At& at, const T& p, const T& k, const Mat3<T>& dE,
                                              bool full) const {
    const Mat3<T> C_inverse = at.C_inverse();
    return C_inverse * dE * C_inverse * (T(2) * shear(p, full)) + C_inverse * (k * contract(C_inverse, dE));
  }
  /// μ − p; the material tangent takes no negative one.
  FASCIA_HD T shear(const T& p, bool full) const {
    const T value = mu - p;
    return full ? value : where_positive(value, value, T(0));
  }
};

}  // namespace fascia
