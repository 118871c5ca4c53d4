#pragma once

#include "gpu/elements/element_average.hpp"
#include "gpu/elements/element_passes.hpp"
#include "gpu/elements/elements_setup.hpp"

/// The bodies of Elements, for the files that instantiate it.
namespace fascia::gpu {

namespace kernels {

struct KeepLargest {
  double* out;
  FASCIA_HD void operator()(const Sums<0, 1>& total) const {
    if (!(total.largest[0] <= *out)) *out = total.largest[0];
  }
};

}  // namespace kernels

/// Runs a pass that knows how long it is.
template <class Space, class Pass>
void run(const Pass& pass) {
  Space::for_each(pass.count(), pass);
}

template <class Space>
HistoryView Elements<Space>::history_of(const Block& block, const HistoryView& all) {
  return {.E = all.E == nullptr || !block.view().damped ? nullptr : all.E + block.strain_begin,
          .inverse_step = all.inverse_step,
          .given = block.remembers && all.given != nullptr ? all.given + block.memory_begin * kGivenRows : nullptr};
}

template <class Space>
template <class T, class V>
void Elements<Space>::average(const ElementBlockOf<T>& view, const HistoryView& history, const Vec3d* u,
                              const Vec3<V>* dx) {
  with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
    if constexpr (N == 4 && L != Law::corotational)
      Space::for_each(view.lanes(), kernels::ThetaPass<L, T, V>{view, u, dx});
  });
  Space::for_each(nodes_, kernels::NodeAveragePass<T>{view, history.given});
}

template <class Space>
void Elements<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                             const double* part_motion) {
  for (Block& block : blocks_) {
    const ElementBlockView& view = block.view();
    const HistoryView past = history_of(block, history);
    if (view.averaged) average<double, double>(view, past, pose.u, nullptr);
    if (!view.one_point()) run<Space>(kernels::GradientPass<double, double>{view, pose.u, view.points_buffer});
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      run<Space>(kernels::ForcesPass<L, N>{{view, past, part_motion != nullptr}, nodes, pose.u, part_motion});
    });
    if (!view.one_point()) run<Space>(kernels::CornerPass<double>{view});
  }
}

template <class Space>
void Elements<Space>::linearize(const PoseView& pose, const HistoryView& history, Tangent tangent,
                                const TakenStepView& taken) {
  if (empty()) return;
  inverse_step_ = history.inverse_step;
  given_ = history.given;
  tangent_ = tangent;
  u_.resize(at(nodes_));
  Space::copy(u_.data(), pose.u, u_.size() * sizeof(Vec3d));
  E_.resize(history.E == nullptr ? 0 : strain_size_);
  if (history.E != nullptr) Space::copy(E_.data(), history.E, E_.size() * sizeof(double));
  extrapolated_ = taken.known();
  if (extrapolated_) extrapolate(taken);
  is_narrow_ ? linearize_as<float>() : linearize_as<double>();
}

template <class Space>
void Elements<Space>::extrapolate(const TakenStepView& taken) {
  if (S_.empty()) S_.resize(strain_size_);
  for (Block& block : blocks_) {
    if (!block.extrapolates) continue;
    const ElementBlockView& view = block.view();
    if (!view.one_point()) run<Space>(kernels::GradientPass<double, double>{view, taken.start.u, view.points_buffer});
    const HistoryView past = history_of(block, linearized_history());
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      if constexpr (is_of_points(L))
        run<Space>(kernels::ExtrapolationPass<L, N>{{view, past, false}, taken, S_.data() + block.strain_begin});
    });
  }
}

template <class Space>
void Elements<Space>::largest_spin(const Vec3d* dx, double* out) const {
  Space::set_zero(out, sizeof(double));
  for (const Block& block : blocks_) {
    if (block.view().law == Law::linear) continue;
    const kernels::SpinPass pass{block.view(), dx};
    Space::template sum<0, 1>(pass.count(), pass, kernels::KeepLargest{out});
  }
}

template <class Space>
template <class T>
void Elements<Space>::linearize_as() {
  for (Block& block : blocks_) {
    const ElementBlockOf<T>& view = block.template view_of<T>();
    if (view.averaged) average<T, double>(view, history_of(block, linearized_history()), u_.data(), nullptr);
    if (!view.one_point()) run<Space>(kernels::GradientPass<T, double>{view, u_.data(), view.H});
    if (!view.averaged && view.law != Law::corotational) continue;
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      run<Space>(kernels::LinearizePass<L, N, T>{{view, {}, true}, u_.data()});
    });
  }
}

template <class Space>
template <class T, class V>
void Elements<Space>::product(const DirectionOf<T, V>& direction) {
  for (Block& block : blocks_) {
    const ElementBlockOf<T>& view = block.template view_of<T>();
    const HistoryView kept = kept_history(block);
    if (view.averaged) average<T, V>(view, kept, u_.data(), direction.dx);
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      const kernels::ElementPass<L, N, T> pass(view, kept, false);
      if (N == 0 && !pass.split) run<Space>(kernels::GradientPass<T, V>{view, direction.dx, view.points_buffer});
      const bool full = tangent_ == Tangent::full;
      if (view.penalised || view.damped || kept.given != nullptr)
        run<Space>(kernels::ProductPass<L, N, T, V, false>{pass, u_.data(), direction.dx, full});
      else
        run<Space>(kernels::ProductPass<L, N, T, V, true>{pass, u_.data(), direction.dx, full});
    });
    if (!view.one_point()) run<Space>(kernels::CornerPass<T>{view});
  }
}

template <class Space>
void Elements<Space>::add_diagonal(const NodesView& nodes, const Mat3d*, double* blocks) {
  if (empty()) return;
  is_narrow_ ? add_diagonal_as<float>(nodes, blocks) : add_diagonal_as<double>(nodes, blocks);
}

template <class Space>
template <class T>
void Elements<Space>::add_diagonal_as(const NodesView& nodes, double* blocks) {
  for (int axis = 0; axis < 3; ++axis) {
    for (Block& block : blocks_)
      with_element_kind(block.view().law, block.view().nodes, [&]<Law L, int N>() {
        run<Space>(kernels::DiagonalPass<L, N, T>{
            {block.template view_of<T>(), kept_history(block), true}, u_.data(), tangent_ == Tangent::full, axis});
      });
    Space::for_each(nodes_, kernels::DiagonalColumn<T>{view_of<T>(), nodes, blocks, axis});
  }
  for (Block& block : blocks_) {
    const ElementBlockOf<T>& view = block.template view_of<T>();
    if (!view.averaged) continue;
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      if constexpr (N == 4 && L != Law::corotational)
        Space::for_each(view.lanes(), kernels::ThetaGradientPass<L, T>{view, u_.data()});
    });
    Space::for_each(nodes_, kernels::AverageDiagonalPass<T>{view, nodes, blocks, kept_history(block).given});
  }
}

template <class Space>
void Elements<Space>::store_stress(const PoseView& pose, const double* given, double* out) {
  for (Block& block : blocks_) {
    if (!block.remembers) continue;
    const ElementBlockView& view = block.view();
    const HistoryView past = history_of(block, {.given = given});
    if (view.averaged) average<double, double>(view, past, pose.u, nullptr);
    if (!view.one_point()) run<Space>(kernels::GradientPass<double, double>{view, pose.u, view.points_buffer});
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      run<Space>(kernels::FadingPass<L, N>{{view, past, false}, pose.u, out + block.memory_begin * 6});
    });
  }
}

template <class Space>
void Elements<Space>::store_strain(const PoseView& pose, double* E) {
  for (Block& block : blocks_) {
    const ElementBlockView& view = block.view();
    if (!view.one_point()) run<Space>(kernels::GradientPass<double, double>{view, pose.u, view.points_buffer});
    with_element_kind(view.law, view.nodes, [&]<Law L, int N>() {
      run<Space>(kernels::StrainPass<L, N>{{view, {}, false}, pose.u, E + block.strain_begin});
    });
  }
}

}  // namespace fascia::gpu
