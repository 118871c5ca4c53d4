#pragma once

#include "core/executor/element_kernels.hpp"

namespace fascia::kernels {

/// The tangent of a batch of elements at a state, ready for directions.
template <Law L, int N>
class BatchTangent {
 public:
  static constexpr int kNodes = N, kPoints = BatchPoints<N>::kPoints;
  static constexpr bool kTurns = L == Law::corotational;

  BatchPoints<N> points;
  ElementSolid<L, Lanes> m;

  /// @param pressure  k θ averaged about the nodes; used where the block is averaged
  BatchTangent(const ElementBlock& block, int batch, int half, const Vec3<Lanes>* u, const BlockState& state,
               const Lanes& pressure)
      : points(block, batch, half, u),
        m(element_material<L>(block, batch, half, state)),
        full_(state.tangent == Tangent::full),
        k_(block.averaged ? Lanes(0) : m.law().volumetric_modulus()),
        element_(points.mean(points.H), points.safe_volume(), full_) {
    for (int q = 0; q < points.count(); ++q) {
      const Mat3<Lanes> old = old_strain(block, state.E, batch, q, half);
      if constexpr (kTurns) {
        sigma_[q] = element_.stress(element_.strain(points.H[q]), m, old, block.damped);
        if (!state.given.empty()) sigma_[q] += given_stress(block, state, batch, q, half);
        element_.add_point(points.H[q], sigma_[q], points.v(q));
      } else {
        const Lanes p = block.averaged ? pressure : k_ * SolidLaw<L, Lanes>::volumetric_strain(points.H[q]);
        point_[q] = ElasticPoint<L, Lanes>(points.H[q], m, p, old, block.damped);
        if (!state.given.empty()) point_[q].S += given_stress(block, state, batch, q, half);
        if (!state.kept.empty())
          point_[q].set_stress(symmetric_matrix(state.kept.data() + symmetric_row(block, batch, q), 0, half));
      }
    }
    if constexpr (kTurns) element_.close();
  }

  const ElasticPoint<L, Lanes>& point(int q) const { return point_[q]; }
  /// Second Piola-Kirchhoff stress, viscous too; of the co-rotational law in the element's axes.
  Mat3<Lanes> stress(int q) const {
    if constexpr (kTurns)
      return sigma_[q];
    else
      return point_[q].S + point_[q].S_viscous;
  }
  /// k of dp; it is 0 where p is an average.
  const Lanes& volumetric_modulus() const { return k_; }

  /// dP of each point for its dF; without what node averages and the penalty on volumes add.
  void differential(const Mat3<Lanes>* dF, Mat3<Lanes>* dP) {
    if constexpr (kTurns) {
      element_.begin_direction(points.mean(dF));
      Mat3<Lanes> dsigma[kPoints];
      for (int q = 0; q < points.count(); ++q) {
        const Mat3<Lanes> dA = element_.relative_differential(points.H[q], dF[q]);
        dsigma[q] = element_.stress_differential(dA, m);
        element_.add_direction(points.H[q], sigma_[q], dA, dsigma[q], points.v(q));
      }
      element_.close_direction();
      for (int q = 0; q < points.count(); ++q) dP[q] = element_.differential(sigma_[q], dsigma[q]);
    } else {
      for (int q = 0; q < points.count(); ++q) dP[q] = point_[q].differential(dF[q], m, k_, full_);
    }
  }

 private:
  struct Nothing {
    Nothing(const Mat3<Lanes>&, const Lanes&, bool) {}
  };

  bool full_;
  Lanes k_;
  std::conditional_t<kTurns, CorotationalElement<Lanes>, Nothing> element_;
  Mat3<Lanes> sigma_[kTurns ? kPoints : 1];
  ElasticPoint<L, Lanes> point_[kTurns ? 1 : kPoints];
};

/// Gives what the penalty on the cells' volumes adds to that, whatever the law: ψ = κ |s|³/3 by volume, with
/// s = (V − V₀)/V₀.
template <int N>
class PenaltyTangent {
 public:
  static constexpr int kNodes = N;
  BatchPoints<N> points;

  PenaltyTangent(const ElementBlock& block, int batch, int half, const Vec3<Lanes>* u, bool full)
      : points(block, batch, half, u),
        penalty_(row(block.material_of(batch), ElementBlock::kPenalty, half)),
        swelling_(swelling(points)),
        full_(full) {}

  void differential(const Mat3<Lanes>* dF, Mat3<Lanes>* dP) const {
    Lanes ds;
    for (int q = 0; q < points.count(); ++q)
      ds += points.v(q) * contract(cofactor(Mat3<Lanes>::identity() + points.H[q]), dF[q]);
    ds = ds / points.safe_volume();
    for (int q = 0; q < points.count(); ++q) {
      const Mat3<Lanes> F = Mat3<Lanes>::identity() + points.H[q];
      dP[q] = cofactor(F) * (Lanes(2) * penalty_ * abs(swelling_) * ds);
      if (full_) dP[q] += cofactor_differential(F, dF[q]) * (penalty_ * swelling_ * abs(swelling_));
    }
  }

 private:
  Lanes penalty_, swelling_;
  bool full_;
};

}  // namespace fascia::kernels
