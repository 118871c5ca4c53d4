#pragma once

#include "core/physics/corotational.hpp"
#include "gpu/elements/element_kernels.hpp"

#include <type_traits>

namespace fascia::gpu::kernels {

/// Mean displacement gradient of an element, and R − I of the nearest rotation; of the co-rotational law.
template <class T>
struct ElementTurn {
  Mat3<T> H, D;
};

template <int N, class T>
FASCIA_HD Mat3<T> mean_gradient(const ElementPoints<N, T>& x) {
  if constexpr (ElementPoints<N, T>::kOne) {
    return x.H(0);
  } else {
    Mat3<T> sum;
    T volume = 0;
    for (int q = x.begin(); q < x.end(); ++q) {
      sum += x.H(q) * x.v(q);
      volume += x.v(q);
    }
    return sum * (volume > 0 ? 1 / volume : T(1));
  }
}

/// An element at a state, ready for stresses and, after begin_direction(), for their differentials. Neither has what
/// averages about nodes add. Plain: known to have neither penalty nor damping nor memory, which spares registers.
template <Law L, int N, class T, bool Plain = false>
class ElementAt {
 public:
  using Points = ElementPoints<N, T>;
  static constexpr bool kTurns = L == Law::corotational;

  /// @param points  all of the element's, or any where its law is that of each point alone
  /// @param pressure  k θ averaged about the nodes; used where the block is averaged
  FASCIA_HD ElementAt(const Points& points, const ElementSolid<L, T>& material, const ElementTurn<T>& turn, T pressure,
                      bool full)
      : x_(points),
        block_(points.block),
        m_(material),
        pressure_(pressure),
        full_(full),
        volume_(total_volume()),
        element_(turn.H, turn.D, volume_, full) {
    if (penalised()) {
      for (int q = x_.begin(); q < x_.end(); ++q) swelling_ += x_.v(q) * volume_change(x_.H(q));
      swelling_ /= volume_;
    }
    if constexpr (kTurns) {
      // In one point alone only stress of the past has axes of its own.
      if (Points::kOne && !has_axes()) return;
      for (int q = x_.begin(); q < x_.end(); ++q) element_.add_point(x_.H(q), sigma(q), x_.v(q));
      element_.close();
    }
  }

  FASCIA_HD Mat3<T> first_piola(int q) const {
    Mat3<T> P;
    if constexpr (kTurns)
      P = element_.first_piola(sigma(q));
    else
      P = point(q).first_piola();
    if (penalised()) P += cofactor(Mat3<T>::identity() + x_.H(q)) * (m_.penalty * swelling_ * std::abs(swelling_));
    return P;
  }

  /// Elastic energy without the penalty's, viscous energy [J/m³].
  FASCIA_HD T elastic_density(int q) const { return elastic_density(q, m_); }
  /// The first, with other constants.
  FASCIA_HD T elastic_density(int q, const ElementSolid<L, T>& m) const {
    if constexpr (kTurns) {
      return StVenantKirchhoff<T>{m.lambda, m.mu}.energy_density(strain(q));
    } else {
      const T theta = block_.averaged ? T(0) : SolidLaw<L, T>::volumetric_strain(x_.H(q));
      return m.law().shear_energy(x_.H(q)) + T(0.5) * m.law().volumetric_modulus() * theta * theta;
    }
  }
  FASCIA_HD T viscous_density(int q) const {
    return m_.viscosity * StVenantKirchhoff<T>{m_.lambda, m_.mu}.energy_density(strain(q) - x_.old(q));
  }
  /// Energy of the penalty [J].
  FASCIA_HD T penalty_energy() const {
    return penalised() ? volume_ * m_.penalty * swelling_ * swelling_ * std::abs(swelling_) / 3 : T(0);
  }

  /// Total stress of a point after a step, to first order.
  FASCIA_HD Mat3<T> extrapolated_stress(int q, const Mat3<T>& dF) const { return point(q).extrapolated_stress(dF, m_); }

  /// Second Piola-Kirchhoff stress, viscous too; of the co-rotational law in the element's axes.
  FASCIA_HD Mat3<T> stress(int q) const {
    if constexpr (kTurns) {
      return sigma(q);
    } else {
      const ElasticPoint<L, T> at_point = point(q);
      return at_point.S + at_point.S_viscous;
    }
  }

  /// Strain that the law and its damping see.
  FASCIA_HD Mat3<T> strain(int q) const {
    if constexpr (kTurns)
      return element_.strain(x_.H(q));
    else
      return SolidLaw<L, T>::strain(x_.H(q));
  }

  /// @param dF  dF(q) of each point
  template <class Direction>
  FASCIA_HD void begin_direction(const Direction& dF) {
    if constexpr (kTurns) {
      Mat3<T> mean;
      for (int q = x_.begin(); q < x_.end(); ++q) mean += Points::kOne ? dF(q) : dF(q) * (x_.v(q) / volume_);
      element_.begin_direction(mean);
      if (full_ && !(Points::kOne && !has_axes())) {
        for (int q = x_.begin(); q < x_.end(); ++q) {
          const Mat3<T> dA = element_.relative_differential(x_.H(q), dF(q));
          element_.add_direction(x_.H(q), sigma(q), dA, element_.stress_differential(dA, m_), x_.v(q));
        }
        element_.close_direction();
      }
    }
    if (penalised()) {
      d_swelling_ = 0;
      for (int q = x_.begin(); q < x_.end(); ++q)
        d_swelling_ += x_.v(q) * contract(cofactor(Mat3<T>::identity() + x_.H(q)), dF(q));
      d_swelling_ /= volume_;
    }
  }

  /// dP of a point for its dF.
  FASCIA_HD Mat3<T> differential(int q, const Mat3<T>& dF) const {
    Mat3<T> dP;
    if constexpr (kTurns) {
      const Mat3<T> dA = element_.relative_differential(x_.H(q), dF);
      dP = element_.differential(sigma(q), element_.stress_differential(dA, m_));
    } else {
      dP = point(q).differential(dF, m_, block_.averaged ? T(0) : m_.law().volumetric_modulus(), full_);
    }
    if (penalised()) {
      const Mat3<T> F = Mat3<T>::identity() + x_.H(q);
      dP += cofactor(F) * (2 * m_.penalty * std::abs(swelling_) * d_swelling_);
      if (full_) dP += cofactor_differential(F, dF) * (m_.penalty * swelling_ * std::abs(swelling_));
    }
    return dP;
  }

 private:
  struct Nothing {
    FASCIA_HD Nothing(const Mat3<T>&, const Mat3<T>&, T, bool) {}
  };

  FASCIA_HD bool penalised() const { return !Plain && block_.penalised; }
  FASCIA_HD bool damped() const { return !Plain && block_.damped; }
  FASCIA_HD bool remembers() const { return !Plain && x_.history.given != nullptr; }
  /// The stress has axes other than the strain's.
  FASCIA_HD bool has_axes() const { return damped() || remembers(); }
  /// Not 0 in lanes that are not used.
  FASCIA_HD T total_volume() const {
    T sum = 0;
    for (int q = x_.begin(); q < x_.end(); ++q) sum += x_.v(q);
    return sum > 0 ? sum : T(1);
  }
  FASCIA_HD Mat3<T> old(int q) const { return damped() ? x_.old(q) : Mat3<T>{}; }
  FASCIA_HD Mat3<T> sigma(int q) const {
    const Mat3<T> stress = element_.stress(strain(q), m_, old(q), damped());
    return remembers() ? stress + x_.given(q) : stress;
  }
  FASCIA_HD ElasticPoint<L, T> point(int q) const {
    const Mat3<T> H = x_.H(q);
    ElasticPoint<L, T> p(
        H, m_, block_.averaged ? pressure_ : m_.law().volumetric_modulus() * SolidLaw<L, T>::volumetric_strain(H),
        old(q), damped());
    if (remembers()) p.S += x_.given(q);
    if (x_.history.S != nullptr) p.set_stress(x_.stress(q));
    return p;
  }

  const Points& x_;
  const ElementBlockOf<T>& block_;
  ElementSolid<L, T> m_;
  T pressure_;
  bool full_;
  T volume_, swelling_ = 0, d_swelling_ = 0;
  std::conditional_t<kTurns, CorotationalElement<T>, Nothing> element_;
};

}  // namespace fascia::gpu::kernels
