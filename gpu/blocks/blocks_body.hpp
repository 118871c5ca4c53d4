#pragma once

#include "gpu/blocks/blocks.hpp"

/// The bodies of Blocks, for the files that instantiate it. A kind that the model does not have costs nothing.
namespace fascia::gpu {

template <class Space>
Blocks<Space>::Blocks(const PointSet& set, Precision precision)
    : kinds_(Points<Space>(set, precision), Elements<Space>(set, precision), Shells<Space>(set, precision)),
      springs_(set),
      parts_(set.part_count()) {
  for_each_kind([&](const auto& kind, std::size_t begin) {
    sum_kind(kind, set);
    strain_size_ = begin + kind.strain_size();
  });
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
  const auto& [points, elements, shells] = kinds_;
  return {points.template view_of<T>(),
          elements.template view_of<T>(),
          shells.template view_of<T>(),
          springs_.view(),
          !points.empty(),
          !elements.empty(),
          !shells.empty(),
          !springs_.empty()};
}

template <class Space>
void Blocks<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                           const double* part_motion) {
  for_each_kind([&](auto& kind, std::size_t begin) { kind.forces(nodes, pose, part_of(history, begin), part_motion); });
  if (!springs_.empty()) springs_.forces(nodes, pose, part_motion);
}

template <class Space>
void Blocks<Space>::linearize(const PoseView& pose, const HistoryView& history, Tangent tangent,
                              const TakenStepView& taken) {
  for_each_kind([&](auto& kind, std::size_t begin) { kind.linearize(pose, part_of(history, begin), tangent, taken); });
}

template <class Space>
template <class T, class V>
void Blocks<Space>::product(const DirectionOf<T, V>& direction) {
  for_each_kind([&](auto& kind, std::size_t) { kind.product(direction); });
}

template <class Space>
void Blocks<Space>::add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks) {
  for_each_kind([&](auto& kind, std::size_t) { kind.add_diagonal(nodes, Q, blocks); });
}

template <class Space>
void Blocks<Space>::store_strain(const PoseView& pose, double* E) {
  for_each_kind([&](auto& kind, std::size_t begin) { kind.store_strain(pose, E + begin); });
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
