#pragma once

#include "core/math/polar.hpp"
#include "core/physics/element_law.hpp"

#include <span>

namespace fascia {

/// The co-rotational law: linear elasticity in axes that turn with the element, R the rotation of its mean F,
///
///   ψ = μ ε:ε + λ/2 (tr ε)²,   ε = sym(Rᵀ F) − I.
///
/// R depends on the positions. Where its points strain alike, as in a linear tetrahedron, that adds nothing to the
/// forces; otherwise −R [c]× / V does, c = G⁻¹ Σ v axl(A σ) with A = Rᵀ F and G = tr(S̄) I − S̄ of the mean S̄ = Rᵀ F̄.
template <class T>
class CorotationalElement {
 public:
  /// @param H_mean  mean displacement gradient, volume the element's [m³]
  FASCIA_HD CorotationalElement(const Mat3<T>& H_mean, const T& volume, bool full)
      : CorotationalElement(H_mean, nearest_rotation_increment(H_mean), volume, full) {}
  /// Makes the element where R − I of the mean is known. @param D  R − I
  FASCIA_HD CorotationalElement(const Mat3<T>& H_mean, const Mat3<T>& D, const T& volume, bool full)
      : full_(full), volume_(volume), D_(D) {
    R_ = Mat3<T>::identity() + D_;
    stretch_ = sym(relative(H_mean)) + Mat3<T>::identity();
    const Mat3<T> G = Mat3<T>::diagonal(trace(stretch_)) - stretch_;
    // Pairs of principal stretches that nearly cancel leave the rotation undetermined: it is then held.
    constexpr double kDetermined = 0.05;
    const T determined = determinant(G) - T(8 * kDetermined);
    const Mat3<T> G_inverse = inverse(G);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) G_inverse_(i, j) = where_positive(determined, G_inverse(i, j), T(0));
  }

  /// Rᵀ F − I
  FASCIA_HD Mat3<T> relative(const Mat3<T>& H) const { return transpose(D_) + H + transpose_times(D_, H); }
  FASCIA_HD Mat3<T> strain(const Mat3<T>& H) const { return sym(relative(H)); }

  /// Stress in the element's axes, elastic and viscous.
  FASCIA_HD static Mat3<T> stress(const Mat3<T>& strain, const ElementMaterial<T>& m, const Mat3<T>& old, bool damped) {
    const StVenantKirchhoff<T> law{m.lambda, m.mu};
    Mat3<T> sigma = law.second_piola(strain);
    if (damped) sigma += law.second_piola(strain - old) * m.viscosity;
    return sigma;
  }

  /// First pass over the points: Σ v axl(A σ).
  FASCIA_HD void add_point(const Mat3<T>& H, const Mat3<T>& sigma, const T& v) {
    t_ += axl((Mat3<T>::identity() + relative(H)) * sigma) * v;
  }
  FASCIA_HD void close() { c_ = G_inverse_ * t_; }

  FASCIA_HD Mat3<T> first_piola(const Mat3<T>& sigma) const { return R_ * (sigma - skew(c_) * (T(1) / volume_)); }

  /// A direction: first the mean of dF, then each point, then close_direction(), then differential() of each point.
  FASCIA_HD void begin_direction(const Mat3<T>& dF_mean) {
    const Mat3<T> Z = transpose_times(R_, dF_mean);
    w_ = G_inverse_ * axl(Z) * T(-1);
    if (!full_) w_ = {};
    d_stretch_ = sym(Z - skew(w_) * stretch_);
    dt_ = {};
  }
  FASCIA_HD Mat3<T> relative_differential(const Mat3<T>& H, const Mat3<T>& dF) const {
    return transpose_times(R_, dF) - skew(w_) * (Mat3<T>::identity() + relative(H));
  }
  FASCIA_HD static Mat3<T> stress_differential(const Mat3<T>& dA, const ElementMaterial<T>& m) {
    return StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(sym(dA)) * (T(1) + m.viscosity);
  }
  FASCIA_HD void add_direction(const Mat3<T>& H, const Mat3<T>& sigma, const Mat3<T>& dA, const Mat3<T>& dsigma,
                               const T& v) {
    dt_ += axl(dA * sigma + (Mat3<T>::identity() + relative(H)) * dsigma) * v;
  }
  FASCIA_HD void close_direction() {
    const Mat3<T> dG = Mat3<T>::diagonal(trace(d_stretch_)) - d_stretch_;
    dc_ = G_inverse_ * (dt_ - dG * c_);
  }
  FASCIA_HD Mat3<T> differential(const Mat3<T>& sigma, const Mat3<T>& dsigma) const {
    if (!full_) return R_ * dsigma;
    return R_ * (skew(w_) * sigma + dsigma - (skew(w_) * skew(c_) + skew(dc_)) * (T(1) / volume_));
  }

 private:
  bool full_;
  T volume_;
  Mat3<T> D_, R_, stretch_, G_inverse_, d_stretch_;
  Vec3<T> t_{}, c_{}, w_{}, dt_{}, dc_{};
};

}  // namespace fascia
