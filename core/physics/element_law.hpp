#pragma once

#include "core/physics/element_kind.hpp"
#include "core/physics/neo_hookean.hpp"

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

/// Calls act.operator()<L, N>() for a law and a number of nodes; N is 4 or, of others, 0.
template <class Act>
void with_element_kind(ElementLaw law, int nodes, const Act& act) {
  const auto with_law = [&]<int N>() {
    switch (law) {
      case ElementLaw::linear:
        return act.template operator()<ElementLaw::linear, N>();
      case ElementLaw::corotational:
        return act.template operator()<ElementLaw::corotational, N>();
      case ElementLaw::st_venant_kirchhoff:
        return act.template operator()<ElementLaw::st_venant_kirchhoff, N>();
      case ElementLaw::neo_hookean:
        return act.template operator()<ElementLaw::neo_hookean, N>();
    }
  };
  if (nodes == 4)
    with_law.template operator()<4>();
  else
    with_law.template operator()<0>();
}

/// Strain that the law and its damping see: small strain, or Green-Lagrange.
template <ElementLaw L, class T>
FASCIA_HD Mat3<T> element_strain(const Mat3<T>& H) {
  if constexpr (L == ElementLaw::linear) return sym(H);
  return green_strain(H);
}

/// Volumetric strain θ, on which λ θ²/2 depends: tr ε, tr E or ln J.
template <ElementLaw L, class T>
FASCIA_HD T volumetric_strain(const Mat3<T>& H) {
  if constexpr (L == ElementLaw::neo_hookean) return NeoHookean<T>::log_volume(H);
  return trace(element_strain<L>(H));
}

/// ∂θ/∂F
template <ElementLaw L, class T>
FASCIA_HD Mat3<T> volumetric_gradient(const Mat3<T>& H) {
  if constexpr (L == ElementLaw::linear) return Mat3<T>::identity();
  const Mat3<T> F = Mat3<T>::identity() + H;
  if constexpr (L == ElementLaw::neo_hookean) return transpose(inverse(F));
  return F;
}

/// ψ without λ θ²/2 [J/m³].
template <ElementLaw L, class T>
FASCIA_HD T shear_energy(const Mat3<T>& H, const T& mu) {
  if constexpr (L == ElementLaw::neo_hookean) return mu * NeoHookean<T>::distortion(H);
  const Mat3<T> E = element_strain<L>(H);
  return mu * contract(E, E);
}

/// State of a point from which stress and stiffness follow.
template <ElementLaw L, class T>
struct ElasticPoint {
  Mat3<T> H, F;
  Mat3<T> S;          ///< second Piola-Kirchhoff stress, elastic [Pa]
  Mat3<T> S_viscous;  ///< [Pa]
  Mat3<T> F_inverse;  ///< neo-Hookean only
  T p;                ///< λ θ, or its average about nodes [Pa]

  ElasticPoint() = default;
  FASCIA_HD ElasticPoint(const Mat3<T>& H_now, const ElementMaterial<T>& m, const T& pressure, const Mat3<T>& E_old,
                         bool damped)
      : H(H_now), F(Mat3<T>::identity() + H_now), p(pressure) {
    const Mat3<T> E = element_strain<L>(H);
    if constexpr (L == ElementLaw::neo_hookean) {
      F_inverse = inverse(F);
      S = NeoHookean<T>{m.lambda, m.mu}.second_piola(E, times_transpose(F_inverse, F_inverse), p);
    } else {
      S = E * (T(2) * m.mu) + Mat3<T>::diagonal(p);
    }
    if (damped) S_viscous = StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(E - E_old) * m.viscosity;
  }

  FASCIA_HD Mat3<T> first_piola() const {
    const Mat3<T> total = S + S_viscous;
    if constexpr (L == ElementLaw::linear) return total;
    return total + H * total;
  }

  /// dS for dF, elastic and viscous; `lambda` 0 where p is an average.
  FASCIA_HD Mat3<T> stress_differential(const Mat3<T>& dF, const ElementMaterial<T>& m, const T& lambda,
                                        bool full) const {
    const Mat3<T> dE = L == ElementLaw::linear ? sym(dF) : sym(transpose_times(F, dF));
    const Mat3<T> viscous = StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(dE) * m.viscosity;
    if constexpr (L == ElementLaw::neo_hookean) {
      const Mat3<T> C_inverse = times_transpose(F_inverse, F_inverse);
      return viscous + C_inverse * dE * C_inverse * (T(2) * shear(m, full)) +
             C_inverse * (lambda * contract(C_inverse, dE));
    } else {
      return viscous + StVenantKirchhoff<T>{lambda, m.mu}.second_piola(dE);
    }
  }

  /// dP for dF; `lambda` 0 where p is an average.
  FASCIA_HD Mat3<T> differential(const Mat3<T>& dF, const ElementMaterial<T>& m, const T& lambda, bool full) const {
    const Mat3<T> dS = stress_differential(dF, m, lambda, full);
    if constexpr (L == ElementLaw::linear) return dS;
    Mat3<T> dP = F * dS;
    if (full) dP += dF * (S + S_viscous);
    return dP;
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

  /// μ − p of the neo-Hookean law; its material tangent takes no negative one.
  FASCIA_HD T shear(const ElementMaterial<T>& m, bool full) const {
    const T value = m.mu - p;
    return full ? value : where_positive(value, value, T(0));
  }
};

/// Stiffness blocks of a point: what of them depends on one node only is computed once a node.
template <ElementLaw L, class T>
class ElementStiffness {
 public:
  FASCIA_HD ElementStiffness(const ElasticPoint<L, T>& point, const ElementMaterial<T>& m, const T& lambda, bool full)
      : m_(m), full_(full) {
    const T one(1);
    if constexpr (L == ElementLaw::neo_hookean) {
      first_ = lambda;
      shear_ = point.shear(m, full);
      viscous_lambda_ = m.lambda * m.viscosity;
      viscous_mu_ = m.mu * m.viscosity;
    } else {
      first_ = lambda + m.lambda * m.viscosity;
      shear_ = m.mu * (one + m.viscosity);
    }
    if (full) S_ = point.S + point.S_viscous;
    if constexpr (L != ElementLaw::linear) left_ = times_transpose(point.F, point.F);
  }

  /// K_ab of gradients g and their images F g; for the neo-Hookean law h = F⁻ᵀ g too.
  FASCIA_HD Mat3<T> block(const Vec3<T>& ga, const Vec3<T>& gb, const Vec3<T>& fa, const Vec3<T>& fb, const Vec3<T>& ha,
                          const Vec3<T>& hb, bool damped) const {
    const T geometric = dot(ga, S_ * gb), gg = dot(ga, gb);
    Mat3<T> K;
    if constexpr (L == ElementLaw::linear) {
      K = outer(ga, gb) * first_ + outer(gb, ga) * shear_ + Mat3<T>::diagonal(gg * shear_);
    } else if constexpr (L == ElementLaw::neo_hookean) {
      K = outer(ha, hb) * first_ + outer(hb, ha) * shear_ + Mat3<T>::diagonal(geometric + dot(ha, hb) * shear_);
      if (damped) K += outer(fa, fb) * viscous_lambda_ + outer(fb, fa) * viscous_mu_ + left_ * (gg * viscous_mu_);
    } else {
      K = outer(fa, fb) * first_ + outer(fb, fa) * shear_ + left_ * (gg * shear_) + Mat3<T>::diagonal(geometric);
    }
    return K;
  }

 private:
  ElementMaterial<T> m_;
  bool full_;
  T first_{}, shear_{}, viscous_lambda_{}, viscous_mu_{};
  Mat3<T> S_, left_;
};

}  // namespace fascia
