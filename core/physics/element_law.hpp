#pragma once

#include "core/physics/solid_law.hpp"

/// Stress and stiffness of finite elements. A block K_ab (3×3) is the second derivative of a point's energy density
/// with respect to the positions of nodes a and b, F = I + Σ u_a g_aᵀ; the co-rotational law, whose rotation belongs to
/// the whole element, is in corotational.hpp.
namespace fascia {

/// A law's volumetric modulus k about a node: the harmonic mean by volume, which is exact where the pressure is the
/// same on both sides of a change of material; the arithmetic one where a k is not positive.
struct VolumetricMean {
  double volume = 0, sum = 0, inverse = 0;
  bool positive = true;

  FASCIA_HD void add(double k, double v) {
    volume += v;
    sum += k * v;
    positive = positive && k > 0;
    if (k > 0) inverse += v / k;
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

/// With what the law has of its own.
template <Law L, class T>
struct ElementSolid : ElementMaterial<T>, OwnConstants<SolidLaw<L, T>::kOwn, T> {
  FASCIA_HD SolidLaw<L, T> law() const { return make_law<SolidLaw<L, T>>(*this); }
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

/// k of a law with these constants [Pa]
inline double volumetric_modulus(Law law, const LawConstants& constants) {
  double k = 0;
  with_element_kind(law, 0, [&]<Law L, int N>() { k = make_law<SolidLaw<L, double>>(constants).volumetric_modulus(); });
  return k;
}

/// State of a point from which stress and stiffness follow.
template <Law L, class T>
struct ElasticPoint {
  using Solid = SolidLaw<L, T>;
  Mat3<T> H, F;
  Mat3<T> S;          ///< second Piola-Kirchhoff stress, elastic [Pa]
  Mat3<T> S_viscous;  ///< [Pa]
  typename Solid::At at;
  T p;  ///< k θ, or its average about nodes [Pa]

  ElasticPoint() = default;
  FASCIA_HD ElasticPoint(const Mat3<T>& H_now, const ElementSolid<L, T>& m, const T& pressure, const Mat3<T>& E_old,
                         bool damped)
      : H(H_now), F(Mat3<T>::identity() + H_now), at(H_now), p(pressure) {
    const Mat3<T> E = Solid::strain(H);
    S = m.law().second_piola(at, E, p);
    if (damped) S_viscous = StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(E - E_old) * m.viscosity;
  }

  FASCIA_HD Mat3<T> first_piola() const {
    const Mat3<T> total = S + S_viscous;
    if constexpr (Solid::kSmall)
      return total;
    else
      return total + H * total;
  }

  /// dS for dF, elastic and viscous. @param k  of dp; 0 where p is an average
  FASCIA_HD Mat3<T> stress_differential(const Mat3<T>& dF, const ElementSolid<L, T>& m, const T& k, bool full) const {
    const Mat3<T> dE = Solid::kSmall ? sym(dF) : sym(transpose_times(F, dF));
    return StVenantKirchhoff<T>{m.lambda, m.mu}.second_piola(dE) * m.viscosity +
           m.law().second_piola_differential(at, p, k, dE, full);
  }

  /// dP for dF. @param k  of dp; 0 where p is an average
  FASCIA_HD Mat3<T> differential(const Mat3<T>& dF, const ElementSolid<L, T>& m, const T& k, bool full) const {
    const Mat3<T> dS = stress_differential(dF, m, k, full);
    if constexpr (Solid::kSmall) {
      return dS;
    } else {
      Mat3<T> dP = F * dS;
      if (full) dP += dF * (S + S_viscous);
      return dP;
    }
  }

  /// Total stress after a step dF, to first order: of the geometric part of the next tangent (point_physics.hpp).
  FASCIA_HD Mat3<T> extrapolated_stress(const Mat3<T>& dF, const ElementSolid<L, T>& m) const {
    return S + S_viscous + stress_differential(dF, m, m.law().volumetric_modulus(), true);
  }
  /// Takes such a stress for what products need of one.
  FASCIA_HD void set_stress(const Mat3<T>& total) {
    S = total;
    S_viscous = {};
  }
};

/// Components of a symmetric matrix, where each entry is among them, and the matrix that has a one in one of them.
inline constexpr int kSymmetricPlaces[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
inline constexpr int kSymmetricPlaceOf[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
template <class T>
FASCIA_HD Mat3<T> symmetric_unit(int component) {
  Mat3<T> m;
  const int i = kSymmetricPlaces[component][0], j = kSymmetricPlaces[component][1];
  m(i, j) = m(j, i) = T(1);
  return m;
}

/// Stiffness blocks of a point: what of them depends on one node only is computed once a node. Of any law, by its dS of
/// the six unit strains; laws whose blocks have a closed form say so below.
template <Law L, class T>
class ElementStiffness {
 public:
  static constexpr bool kOfPoints = true;
  struct Node {
    Vec3<T> g;      ///< gradient of its shape function
    Mat3<T> dS[3];  ///< for its unit motions
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<L, T>& point, const ElementSolid<L, T>& m, const T& k, bool full,
                             bool /*damped*/)
      : F_(point.F) {
    static_assert(!SolidLaw<L, T>::kSmall);
    const SolidLaw<L, T> law = m.law();
    const StVenantKirchhoff<T> viscous{m.lambda * m.viscosity, m.mu * m.viscosity};
    for (int c = 0; c < 6; ++c) {
      const Mat3<T> dE = symmetric_unit<T>(c);
      dS_[c] = law.second_piola_differential(point.at, point.p, k, dE, full) + viscous.second_piola(dE);
    }
    if (full) S_ = point.S + point.S_viscous;
  }
  FASCIA_HD Node node(const Vec3<T>& g) const {
    Node n{g, {}};
    for (int i = 0; i < 3; ++i) {
      const Mat3<T> dE = sym(outer(F_.row(i), g));
      for (int c = 0; c < 6; ++c) n.dS[i] += dS_[c] * dE(kSymmetricPlaces[c][0], kSymmetricPlaces[c][1]);
    }
    return n;
  }
  FASCIA_HD Mat3<T> block(const Node& a, const Node& b) const {
    const Mat3<T> forces = Mat3<T>::from_columns(b.dS[0] * a.g, b.dS[1] * a.g, b.dS[2] * a.g);
    return F_ * forces + Mat3<T>::diagonal(dot(a.g, S_ * b.g));
  }

 private:
  Mat3<T> F_, S_, dS_[6];
};

/// The rotation is the whole element's: its blocks come from unit motions of nodes.
template <class T>
class ElementStiffness<Law::corotational, T> {
 public:
  static constexpr bool kOfPoints = false;
};

template <class T>
class ElementStiffness<Law::linear, T> {
 public:
  static constexpr bool kOfPoints = true;
  struct Node {
    Vec3<T> g;  ///< gradient of its shape function
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<Law::linear, T>&, const ElementSolid<Law::linear, T>& m,
                             const T& lambda, bool /*full*/, bool /*damped*/)
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
  static constexpr bool kOfPoints = true;
  struct Node {
    Vec3<T> g, f;  ///< f = F g
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<Law::st_venant_kirchhoff, T>& point,
                             const ElementSolid<Law::st_venant_kirchhoff, T>& m, const T& lambda, bool full,
                             bool /*damped*/)
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
  static constexpr bool kOfPoints = true;
  struct Node {
    Vec3<T> g, f, h;  ///< f = F g, h = F⁻ᵀ g
  };
  FASCIA_HD ElementStiffness(const ElasticPoint<Law::neo_hookean, T>& point, const ElementSolid<Law::neo_hookean, T>& m,
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
