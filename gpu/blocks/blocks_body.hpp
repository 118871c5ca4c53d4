#pragma once

#include "gpu/blocks/blocks.hpp"

/// The bodies of Blocks, for the files that instantiate it. A kind that the model does not have costs nothing.
namespace fascia::gpu {

template <class Space>
Blocks<Space>::Blocks(const PointSet& set, Precision precision)
    : points_(set, precision),
      elements_(set, precision),
      shells_(set, precision),
      springs_(set),
      parts_(set.part_count()) {
  sum_kind(points_, set);
  sum_kind(elements_, set);
  sum_kind(shells_, set);
  sum_kind(springs_, set);
}

template <class Space>
template <class Kind>
void Blocks<Space>::sum_kind(const Kind& kind, const PointSet& set) {
  if (!kind.empty()) sums_.push_back({PartSums<Space>(kind.item_parts(set), parts_), kind.quantities()});
}

template <class Space>
template <class T>
BlocksOf<T> Blocks<Space>::view_of() const {
  return {points_.template view_of<T>(),
          elements_.template view_of<T>(),
          shells_.template view_of<T>(),
          springs_.view(),
          !points_.empty(),
          !elements_.empty(),
          !shells_.empty(),
          !springs_.empty()};
}

template <class Space>
void Blocks<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                           const double* part_motion) {
  if (!points_.empty()) points_.forces(nodes, pose, history, part_motion);
  if (!elements_.empty()) elements_.forces(nodes, pose, part_of(history, elements_begin()), part_motion);
  if (!shells_.empty()) shells_.forces(nodes, pose, part_of(history, shells_begin()), part_motion);
  if (!springs_.empty()) springs_.forces(nodes, pose, part_motion);
}

template <class Space>
void Blocks<Space>::linearize(const PoseView& pose, const HistoryView& history, Tangent tangent,
                              const TakenStepView& taken) {
  if (!points_.empty()) points_.linearize(pose, history, tangent, taken);
  if (!elements_.empty()) elements_.linearize(pose, part_of(history, elements_begin()), tangent, taken);
  if (!shells_.empty()) shells_.linearize(pose, part_of(history, shells_begin()), tangent, taken);
}

template <class Space>
template <class T, class V>
void Blocks<Space>::product(const DirectionOf<T, V>& direction) {
  if (!points_.empty()) points_.product(direction);
  if (!elements_.empty()) elements_.product(direction);
  if (!shells_.empty()) shells_.product(direction);
}

template <class Space>
void Blocks<Space>::add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks) {
  if (!points_.empty()) points_.add_diagonal(nodes, Q, blocks);
  if (!elements_.empty()) elements_.add_diagonal(nodes, Q, blocks);
  if (!shells_.empty()) shells_.add_diagonal(nodes, Q, blocks);
}

template <class Space>
void Blocks<Space>::store_strain(const PoseView& pose, double* E) {
  if (!points_.empty()) points_.store_strain(pose, E);
  if (!elements_.empty()) elements_.store_strain(pose, E + elements_begin());
  if (!shells_.empty()) shells_.store_strain(pose, E + shells_begin());
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
  for (Summed& sum : sums_) {
    sum.by_part.template sum<kQuantities>(kernels::TakeQuantities{sum.quantities}, out);
    out += at(parts_) * kQuantities;
  }
}

}  // namespace fascia::gpu
