#pragma once

#include "gpu/element_average.hpp"
#include "gpu/element_passes.hpp"
#include "gpu/elements_setup.hpp"

/// The bodies of Elements, for the files that instantiate it.
namespace fascia::gpu {

/// Runs a pass that knows how long it is.
template <class Space, class Pass>
void run(const Pass& pass) {
  Space::for_each(pass.count(), pass);
}

template <class Space>
HistoryView Elements<Space>::history_of(const Block& block, const double* E, double inverse_step) {
  return {E == nullptr || !block.view.damped ? nullptr : E + block.strain_begin, inverse_step};
}

template <class Space>
void Elements<Space>::average(Block& block, const Vec3d* u, const Vec3d* dx) {
  const ElementBlockView& view = block.view;
  kernels::with_kind(view, [&]<ElementLaw L, int N>() {
    if constexpr (N == 4 && L != ElementLaw::corotational)
      Space::for_each(view.lanes(), kernels::ThetaPass<L>{view, u, dx});
  });
  Space::for_each(nodes_, kernels::NodeAveragePass{view});
}

template <class Space>
void Elements<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                             const double* part_motion) {
  for (Block& block : blocks_) {
    const ElementBlockView& view = block.view;
    if (view.averaged) average(block, pose.u, nullptr);
    if (!view.one_point()) run<Space>(kernels::GradientPass{view, pose.u, view.points_buffer});
    kernels::with_kind(view, [&]<ElementLaw L, int N>() {
      run<Space>(
          kernels::ForcesPass<L, N>{{view, history_of(block, history.E, history.inverse_step), part_motion != nullptr},
                                    nodes,
                                    pose.u,
                                    part_motion});
    });
    if (!view.one_point()) run<Space>(kernels::CornerPass{view});
  }
}

template <class Space>
void Elements<Space>::linearize(const PoseView& pose, const HistoryView& history, Tangent tangent) {
  if (empty()) return;
  inverse_step_ = history.inverse_step;
  tangent_ = tangent;
  u_.resize(at(nodes_));
  Space::copy(u_.data(), pose.u, u_.size() * sizeof(Vec3d));
  E_.resize(history.E == nullptr ? 0 : strain_size_);
  if (history.E != nullptr) Space::copy(E_.data(), history.E, E_.size() * sizeof(double));
  for (Block& block : blocks_) {
    const ElementBlockView& view = block.view;
    if (view.averaged) average(block, u_.data(), nullptr);
    if (!view.one_point()) run<Space>(kernels::GradientPass{view, u_.data(), view.H});
    if (!view.averaged && view.law != ElementLaw::corotational) continue;
    kernels::with_kind(view, [&]<ElementLaw L, int N>() {
      run<Space>(kernels::LinearizePass<L, N>{{view, {}, true}, u_.data()});
    });
  }
}

template <class Space>
void Elements<Space>::product(const DirectionView& direction) {
  for (Block& block : blocks_) {
    const ElementBlockView& view = block.view;
    if (view.averaged) average(block, u_.data(), direction.dx);
    kernels::with_kind(view, [&]<ElementLaw L, int N>() {
      const kernels::ElementPass<L, N> pass(view, kept_history(block), false);
      if (N == 0 && !pass.split) run<Space>(kernels::GradientPass{view, direction.dx, view.points_buffer});
      const bool full = tangent_ == Tangent::full;
      if (view.penalised || view.damped)
        run<Space>(kernels::ProductPass<L, N, false>{pass, u_.data(), direction.dx, full});
      else
        run<Space>(kernels::ProductPass<L, N, true>{pass, u_.data(), direction.dx, full});
    });
    if (!view.one_point()) run<Space>(kernels::CornerPass{view});
  }
}

template <class Space>
void Elements<Space>::add_diagonal(const NodesView& nodes, const Mat3d*, double* blocks) {
  if (empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    for (Block& block : blocks_)
      kernels::with_kind(block.view, [&]<ElementLaw L, int N>() {
        run<Space>(kernels::DiagonalPass<L, N>{
            {block.view, kept_history(block), true}, u_.data(), tangent_ == Tangent::full, axis});
      });
    Space::for_each(nodes_, kernels::DiagonalColumn{view_, nodes, blocks, axis});
  }
  for (Block& block : blocks_) {
    if (!block.view.averaged) continue;
    kernels::with_kind(block.view, [&]<ElementLaw L, int N>() {
      if constexpr (N == 4 && L != ElementLaw::corotational)
        Space::for_each(block.view.lanes(), kernels::ThetaGradientPass<L>{block.view, u_.data()});
    });
    Space::for_each(nodes_, kernels::AverageDiagonalPass{block.view, nodes, blocks});
  }
}

template <class Space>
void Elements<Space>::store_strain(const PoseView& pose, double* E) {
  for (Block& block : blocks_) {
    const ElementBlockView& view = block.view;
    if (!view.one_point()) run<Space>(kernels::GradientPass{view, pose.u, view.points_buffer});
    kernels::with_kind(view, [&]<ElementLaw L, int N>() {
      run<Space>(kernels::StrainPass<L, N>{{view, {}, false}, pose.u, E + block.strain_begin});
    });
  }
}

}  // namespace fascia::gpu
