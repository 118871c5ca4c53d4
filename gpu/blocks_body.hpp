#pragma once

#include "gpu/blocks.hpp"

/// The bodies of Blocks, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
Blocks<Space>::Blocks(const PointSet& set)
    : points_(set), point_parts_(points_.item_parts(set), set.part_count()), parts_(set.part_count()) {}

template <class Space>
BlocksView Blocks<Space>::view() const {
  return {points_.view(), !points_.empty()};
}

template <class Space>
void Blocks<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                           const double* part_motion) {
  points_.forces(nodes, pose, history, part_motion);
}

template <class Space>
void Blocks<Space>::linearize(const NodesView&, const PoseView& pose, const HistoryView& history, Tangent tangent,
                              double*) {
  points_.linearize(pose, history, tangent);
}

template <class Space>
void Blocks<Space>::product(const DirectionView& direction) {
  points_.product(direction);
}

template <class Space>
void Blocks<Space>::add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks) {
  if (!points_.empty()) points_.add_diagonal(nodes, Q, blocks);
}

template <class Space>
void Blocks<Space>::store_strain(const PoseView& pose, double* E) {
  points_.store_strain(pose, E);
}

namespace kernels {

struct TakeQuantities {
  const double* quantities;
  FASCIA_HD void operator()(int item, Sums<kQuantities>& sums) const {
    for (int k = 0; k < kQuantities; ++k) sums.v[k] += quantities[static_cast<std::size_t>(item) * kQuantities + k];
  }
};

}  // namespace kernels

template <class Space>
void Blocks<Space>::sum_quantities(double* out) {
  point_parts_.template sum<kQuantities>(kernels::TakeQuantities{points_.quantities()}, out);
}

}  // namespace fascia::gpu
