#include "core/executor/point_executor.hpp"
#include "core/executor/point_kernels.hpp"

#include <algorithm>
#include <array>

/// The tangent of points: what is kept of a state, and products.
namespace fascia {

using namespace kernels;

template <Stabilization Tie>
void PointExecutor::linearize_group(const BlockState& now, int group, Rows rows, std::span<double> kept) const {
  for (int b = 0; b < kBatches; ++b) {
    const PointMotion<Lanes> x = frames_.motion<true>(group, b, rows);
    TangentStress<Lanes> stress;
    with_point_law(rule_of(group).law, [&]<Law L>() {
      const auto m = material<L>(set_, group, b, now, targets_);
      if (!is_tether(m)) stress = tangent_stress<Tie>(x, m, old_strain(now, group, b));
    });
    if (!now.given.empty()) stress.S += given_stress(now, group, b);
    keep<Tie>(x, stress, kept.data() + kept_begin_[at(group)], b);
  }
}

/// @param rows  of the state, of where a step to it started, and of the step
template <Stabilization Tie>
void PointExecutor::extrapolate_group(const BlockState& now, int group, const std::array<Rows, 3>& rows,
                                      std::span<double> kept) {
  GroupStress sums;
  for (int b = 0; b < kBatches; ++b) {
    const PointMotion<Lanes> x = frames_.motion<true>(group, b, rows[0]),
                             start = frames_.motion<true>(group, b, rows[1]),
                             step = frames_.motion<true>(group, b, rows[2]);
    with_point_law(rule_of(group).law, [&]<Law L>() {
      const Mat3<Lanes> E_old = old_strain(now, group, b);
      const auto m = material<L>(set_, group, b, now, targets_);
      TangentStress<Lanes> stress;
      if (!is_tether(m)) stress = extrapolated_stress<Tie>(start, step, m, E_old);
      if (!now.given.empty()) stress.S += given_stress(now, group, b);
      keep<Tie>(x, stress, kept.data() + kept_begin_[at(group)], b);
      const PointStress<Lanes> p = is_tether(m) ? point_stress<Tie>(x, m, E_old) : point_stress<Tie>(x, m, stress);
      sums.P[b].set(p.P * m.volume);
      sums.Y[b].set(p.Y * m.volume);
    });
  }
  frames_.put<Tie != Stabilization::none>(group, sums);
}

void PointExecutor::linearize(const BlockState& now, const BlockState* start, const BlockDirection* step,
                              std::span<double> kept) {
  if (empty()) return;
  const Rows rows = frames_.rows_of(now, now_);
  if (start == nullptr) {
    frames_.for_each_group(std::array{rows}, false, [&](int group, const auto& near) {
      with_stabilization(rule_of(group).stabilization,
                         [&]<Stabilization Tie>() { linearize_group<Tie>(now, group, near[0], kept); });
    });
    return;
  }
  const std::array<Rows, 3> all{rows, frames_.rows_of(*start, start_), step->motions.data()};
  frames_.for_each_group(all, true, [&](int group, const auto& near) {
    with_stabilization(rule_of(group).stabilization,
                       [&]<Stabilization Tie>() { extrapolate_group<Tie>(now, group, near, kept); });
  });
}

/// By law too: conjugate gradients ask for little else.
template <PointKind Kind>
[[gnu::flatten]] void PointExecutor::product_of_group(const BlockState& state, int group, Rows rows) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const double* kept = kept_of(state, group);
  GroupStress sums;
  for (int b = 0; b < kBatches; ++b) {
    const auto m = material<Kind.law>(set_, group, b, state, targets_);
    const auto r = point_stress_differential<Kind.stabilization>(kept_motion<Kind.stabilization>(kept, b),
                                                                 kept_stress<Kind.stabilization>(kept, b), m,
                                                                 state.tangent, frames_.motion<kBlend>(group, b, rows));
    sums.P[b].set(r.dP * m.volume);
    if constexpr (kBlend) sums.Y[b].set(r.dY * m.volume);
  }
  frames_.put<kBlend>(group, sums);
}

void PointExecutor::compute_product(const BlockState& state, const BlockDirection& direction) {
  if (empty()) return;
  frames_.for_each_group(std::array{direction.motions.data()}, true, [&](int group, const auto& rows) {
    with_kind(rule_of(group), [&]<PointKind Kind>() { product_of_group<Kind>(state, group, rows[0]); });
  });
}

}  // namespace fascia
