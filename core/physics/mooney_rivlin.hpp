#pragma once

#include "core/physics/neo_hookean.hpp"

namespace fascia {

/// Mooney-Rivlin material of five terms, of what a deformation changes beside the volume, and with a quadratic volume
/// term (Holzapfel 2000, 6.147 and 6.103):
///
///   ψ = c10 x + c01 y + c20 x² + c11 x y + c02 y² + K/2 (J − 1)²  [J/m³],   x = Ī₁ − 3,  y = Ī₂ − 3,
///   Ī₁ = J^(−2/3) tr C,  Ī₂ = J^(−4/3) I₂,   μ = 2 (c10 + c01),  K = λ + 2μ/3.
///
/// Not finite where J ≤ 0.
template <class T>
struct MooneyRivlin {
  static constexpr bool kSmall = false;
  enum Own { kC10, kC01, kC20, kC11, kC02, kOwn };
  T lambda, mu;   ///< [Pa]
  T own[kOwn]{};  ///< by Own [Pa]

  // This is a law of solids (solid_law.hpp) with θ = J − 1.
  struct At {
    Mat3<T> E, C_inverse;
    T J, a;  ///< a = J^(−2/3)
    FASCIA_HD explicit At(const Mat3<T>& H) : E(green_strain(H)), J(T(1) + volume_change(H)) {
      using std::cbrt;
      const Mat3<T> F_inverse = inverse(Mat3<T>::identity() + H);
      C_inverse = times_transpose(F_inverse, F_inverse);
      a = T(1) / cbrt(J * J) / where_positive(J, T(1), T(0));
    }
    At() = default;

    FASCIA_HD T first_invariant() const { return T(3) + T(2) * trace(E); }
    /// I₂ − 3
    FASCIA_HD T second_invariant_change() const {
      const T t = trace(E);
      return T(4) * t + T(2) * (t * t - contract(E, E));
    }
    /// x and y. @param a_change  a − 1, with the digits that the caller needs
    FASCIA_HD T x(const T& a_change) const { return T(3) * a_change + a * T(2) * trace(E); }
    FASCIA_HD T y(const T& a_change) const { return T(3) * a_change * (a + T(1)) + a * a * second_invariant_change(); }
  };
  FASCIA_HD static Mat3<T> strain(const Mat3<T>& H) { return green_strain(H); }
  FASCIA_HD static T volumetric_strain(const Mat3<T>& H) { return volume_change(H); }
  FASCIA_HD static Mat3<T> volumetric_gradient(const Mat3<T>& H) { return cofactor(Mat3<T>::identity() + H); }
  FASCIA_HD T volumetric_modulus() const { return lambda + mu * T(2.0 / 3); }

  FASCIA_HD T shear_energy(const Mat3<T>& H) const {
    using std::expm1;
    using std::log1p;
    const At at(H);
    // a − 1 from ln J² = ln det(I + 2E): with the same E, the energy of a rotation is zero to the square of rounding.
    const T a_change = expm1(log1p(volume_change(at.E * T(2))) * T(-1.0 / 3));
    const T x = at.x(a_change), y = at.y(a_change);
    return own[kC10] * x + own[kC01] * y + own[kC20] * x * x + own[kC11] * x * y + own[kC02] * y * y;
  }

  /// S = 2 ψ₁ ∂Ī₁/∂C + 2 ψ₂ ∂Ī₂/∂C + p J C⁻¹  [Pa], with ψ₁ = ∂ψ/∂Ī₁; without cancellation at small strain,
  ///   ∂Ī₁/∂C = 2 a C⁻¹ dev E,   ∂Ī₂/∂C = a² C⁻¹ dev((2 + 4 tr E) E − 4 E²).
  FASCIA_HD Mat3<T> second_piola(const At& at, const Mat3<T>& E, const T& p) const {
    const Slopes s = slopes(at);
    const T t = trace(E);
    const Mat3<T> M = E * (T(2) * at.a * s.first + (T(2) + T(4) * t) * at.a * at.a * s.second) -
                      E * E * (T(4) * at.a * at.a * s.second);
    return at.C_inverse * (M - Mat3<T>::diagonal(trace(M) * T(1.0 / 3))) * T(2) + at.C_inverse * (p * at.J);
  }

  /// dS of dE  [Pa]. With d = C⁻¹ : dE,
  ///   d(∂Ī₁/∂C) = 2a (I₁/3 C⁻¹ dE C⁻¹ − tr dE/3 C⁻¹) − 2/3 d ∂Ī₁/∂C,
  ///   d(∂Ī₂/∂C) = a² (2 tr dE I − 2 dE − 2/3 dI₂ C⁻¹ + 4/3 I₂ C⁻¹ dE C⁻¹) − 4/3 d ∂Ī₂/∂C,   dI₂ = 2 (I₁ I − C) : dE.
  /// Where not full: deviators of the spatial strain with the present shear modulus, and the volume on its own.
  FASCIA_HD Mat3<T> second_piola_differential(const At& at, const T& p, const T& k, const Mat3<T>& dE,
                                              bool full) const {
    const Slopes s = slopes(at);
    const Mat3<T>& C_inverse = at.C_inverse;
    const Mat3<T> turned = C_inverse * dE * C_inverse;
    const T d = contract(C_inverse, dE), pJ = p * at.J, kJ2 = k * at.J * at.J, I1 = at.first_invariant(),
            I2 = T(3) + at.second_invariant_change();
    if (!full) {
      const T shear = T(2.0 / 3) * (at.a * I1 * s.first + at.a * at.a * I2 * s.second) - pJ;
      const T stiff = where_positive(shear, shear, T(0)), volume = kJ2 + pJ * T(1.0 / 3);
      return (turned - C_inverse * (d * T(1.0 / 3))) * (T(2) * stiff) +
             C_inverse * (where_positive(volume, volume, T(0)) * d);
    }
    const T a2 = at.a * at.a, tr = trace(dE);
    const Mat3<T> G1 = first_gradient(at), G2 = second_gradient(at);
    const T dI2 = T(2) * (I1 * tr - tr - T(2) * contract(at.E, dE));
    const T dx = T(2) * contract(G1, dE), dy = T(2) * contract(G2, dE);
    const T d_first = T(2) * own[kC20] * dx + own[kC11] * dy, d_second = own[kC11] * dx + T(2) * own[kC02] * dy;
    Mat3<T> dS = G1 * (d_first - T(2.0 / 3) * d * s.first) + G2 * (d_second - T(4.0 / 3) * d * s.second);
    dS += (Mat3<T>::diagonal(tr) - dE) * (T(2) * a2 * s.second);
    dS += turned * (T(2.0 / 3) * at.a * I1 * s.first + T(4.0 / 3) * a2 * I2 * s.second - pJ);
    dS -= C_inverse * (T(2.0 / 3) * (at.a * tr * s.first + a2 * dI2 * s.second));
    return dS * T(2) + C_inverse * ((kJ2 + pJ) * d);
  }

 private:
  struct Slopes {
    T first, second;  ///< ψ₁, ψ₂
  };
  FASCIA_HD Slopes slopes(const At& at) const {
    const T x = at.x(at.a - T(1)), y = at.y(at.a - T(1));
    return {own[kC10] + T(2) * own[kC20] * x + own[kC11] * y, own[kC01] + own[kC11] * x + T(2) * own[kC02] * y};
  }
  FASCIA_HD static Mat3<T> deviator(const Mat3<T>& M) { return M - Mat3<T>::diagonal(trace(M) * T(1.0 / 3)); }
  /// ∂Ī₁/∂C, ∂Ī₂/∂C
  FASCIA_HD static Mat3<T> first_gradient(const At& at) { return at.C_inverse * deviator(at.E) * (T(2) * at.a); }
  FASCIA_HD static Mat3<T> second_gradient(const At& at) {
    const T t = trace(at.E);
    return at.C_inverse * deviator(at.E * (T(2) + T(4) * t) - at.E * at.E * T(4)) * (at.a * at.a);
  }
};

}  // namespace fascia
