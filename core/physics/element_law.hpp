#pragma once

#include "core/physics/solid_law.hpp"

/// Stress and stiffness of finite elements. A block K_ab (3×3) is the second derivative of a point's energy density
/// with respect to the positions of nodes a and b, F = I + Σ u_a g_aᵀ; the co-rotational law, whose rotation belongs to
/// the whole element, is in corotational.hpp.
namespace fascia {

/// λ about a node: the harmonic mean by volume, which is exact where the pressure is the same on both sides of a change
/// of material; the arithmetic one where a λ is not positive.
struct LambdaMean {
  double volume = 0, sum = 0, inverse = 0;
  bool positive = true;

  FASCIA_HD void add(double lambda, double v) {
    volume += v;
    sum += lambda * v;
    positive = positive && lambda > 0;
    if (lambda > 0) inverse += v / lambda;
  }
  FASCIA_HD double value() const {
    if (volume <= 0) return 0;
    return positive ? volume / inverse : sum / volume;
  }
};

template <class T>
struct ElementMaterial {
  T lambda, mu;  ///< [Pa]
  T viscosity;   ///< κ = β/h [-]: viscous stress κ C : (E − E_old)
  T penalty;     ///< of the cell's volume [Pa]
};

/// Calls act.operator()<L, N>() for a law of elements and a number of nodes; N is 4 or, of others, 0.
template <class Act>
void with_element_kind(Law law, int nodes, const Act& act) {
  const auto with_law = [&]<Law L>() {
    if (nodes == 4)
      act.template operator()<L, 4>();
    else
      act.template operator()<L, 0>();
  };
  if (law == Law::corotational) return with_law.template operator()<Law::corotational>();
  if (law == Law::linear) return with_law.template operator()<Law::linear>();
  with_solid_law(law, with_law);
}

/// State of a point from which stress and stiffness follow.
template <Law L, class T>
struct ElasticPoint {
  using Solid = SolidLaw<L, T>;
  Mat3<T> H, F;
  Mat3<T> S;          ///< second Piola-Kirchhoff stress, elastic [Pa]
  Mat3<T> S_viscous;  ///< [Pa]
  typename Solid::At at;
  T p;  ///< λ θ, or its average about nodes [Pa]

  ElasticPoint() = default;
  FASCIA_HD ElasticPoint(const Mat3<T>& H_now, const ElementMaterial<T>& m, const T& pressure, const Mat3<T>& E_old,
                         bool damped)
      : H(H_now), F(Mat3<T>::identity() + H_now), at(H_now), p(pressure) {
    const Mat3<T> E = Solid::strain(H);
    S = Solid{m.lambda, m.mu}.second_piola(at, E, p);
    if (damped) S_viscous = StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(E - E_old) * m.viscosity;
  }

  FASCIA_HD Mat3<T> first_piola() const {
    const Mat3<T> total = S + S_viscous;
    if constexpr (Solid::kSmall)
      return total;
    else
      return total + H * total;
  }

  /// dS for dF, elastic and viscous; `lambda` 0 where p is an average.
  FASCIA_HD Mat3<T> stress_differential(const Mat3<T>& dF, const ElementMaterial<T>& m, const T& lambda,
                                        bool full) const {
    const Mat3<T> dE = Solid::kSmall ? sym(dF) : sym(transpose_times(F, dF));
    return StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(dE) * m.viscosity +
           Solid{lambda, m.mu}.second_piola_differential(at, p, dE, full);
  }

  /// dP for dF; `lambda` 0 where p is an average.
  FASCIA_HD Mat3<T> differential(const Mat3<T>& dF, const ElementMaterial<T>& m, const T& lambda, bool full) const {
    const Mat3<T> dS = stress_differential(dF, m, lambda, full);
    if constexpr (Solid::kSmall) {
      return dS;
    } else {
      Mat3<T> dP = F * dS;
      if (full) dP += dF * (S + S_viscous);
      return dP;
    }
  }

  /// Total stress after a step dF, to first order: of the geometric part of the next tangent (point_physics.hpp).
  FASCIA_HD Mat3<T> extrapolated_stress(const Mat3<T>& dF, const ElementMaterial<T>& m) const {
    return S + S_viscous + stress_differential(dF, m, m.lambda, true);
  }
  /// Takes such a stress for what products need of one.
  FASCIA_HD void set_stress(const Mat3<T>& total) {
    S = total;
    S_viscous = {};
  }
};

/// Stiffness blocks of a point in closed form: what of them depends on one node only is computed once a node. A law may
/// do without; its blocks are then made from unit motions.
template <Law L, class T>
struct ElementStiffness {
  static constexpr bool kClosed = false;
};

template <class T>
class ElementStiffness<Law::linear, T> {
 public:
  static constexpr bool kClosed = true;
  struct Node {
    Vec3<T> g;  ///< gradient of its shape function
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<Law::linear, T>&, const ElementMaterial<T>& m, const T& lambda,
                             bool /*full*/, bool /*damped*/)
      : lambda_(lambda + m.lambda * m.viscosity), mu_(m.mu * (T(1) + m.viscosity)) {}
  FASCIA_HD Node node(const Vec3<T>& g) const { return {g}; }
  FASCIA_HD Mat3<T> block(const Node& a, const Node& b) const {
    return outer(a.g, b.g) * lambda_ + outer(b.g, a.g) * mu_ + Mat3<T>::diagonal(dot(a.g, b.g) * mu_);
  }

 private:
  T lambda_, mu_;
};

template <class T>
class ElementStiffness<Law::st_venant_kirchhoff, T> {
 public:
  static constexpr bool kClosed = true;
  struct Node {
    Vec3<T> g, f;  ///< f = F g
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<Law::st_venant_kirchhoff, T>& point, const ElementMaterial<T>& m,
                             const T& lambda, bool full, bool /*damped*/)
      : lambda_(lambda + m.lambda * m.viscosity),
        mu_(m.mu * (T(1) + m.viscosity)),
        F_(point.F),
        left_(times_transpose(point.F, point.F)) {
    if (full) S_ = point.S + point.S_viscous;
  }
  FASCIA_HD Node node(const Vec3<T>& g) const { return {g, F_ * g}; }
  FASCIA_HD Mat3<T> block(const Node& a, const Node& b) const {
    const T geometric = dot(a.g, S_ * b.g), gg = dot(a.g, b.g);
    return outer(a.f, b.f) * lambda_ + outer(b.f, a.f) * mu_ + left_ * (gg * mu_) + Mat3<T>::diagonal(geometric);
  }

 private:
  T lambda_, mu_;
  Mat3<T> F_, left_, S_;
};

template <class T>
class ElementStiffness<Law::neo_hookean, T> {
 public:
  static constexpr bool kClosed = true;
  struct Node {
    Vec3<T> g, f, h;  ///< f = F g, h = F⁻ᵀ g
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<Law::neo_hookean, T>& point, const ElementMaterial<T>& m,
                             const T& lambda, bool full, bool damped)
      : lambda_(lambda),
        shear_(NeoHookean<T>{lambda, m.mu}.shear(point.p, full)),
        viscous_lambda_(m.lambda * m.viscosity),
        viscous_mu_(m.mu * m.viscosity),
        damped_(damped),
        F_(point.F),
        F_inverse_transposed_(transpose(point.at.F_inverse)),
        left_(times_transpose(point.F, point.F)) {
    if (full) S_ = point.S + point.S_viscous;
  }
  FASCIA_HD Node node(const Vec3<T>& g) const { return {g, F_ * g, F_inverse_transposed_ * g}; }
  FASCIA_HD Mat3<T> block(const Node& a, const Node& b) const {
    const T geometric = dot(a.g, S_ * b.g), gg = dot(a.g, b.g);
    Mat3<T> K =
        outer(a.h, b.h) * lambda_ + outer(b.h, a.h) * shear_ + Mat3<T>::diagonal(geometric + dot(a.h, b.h) * shear_);
    if (damped_) K += outer(a.f, b.f) * viscous_lambda_ + outer(b.f, a.f) * viscous_mu_ + left_ * (gg * viscous_mu_);
    return K;
  }

 private:
  T lambda_, shear_, viscous_lambda_, viscous_mu_;
  bool damped_;
  Mat3<T> F_, F_inverse_transposed_, left_, S_;
};

}  // namespace fascia
