#pragma once

#include "core/base/errors.hpp"
#include "gpu/blocks/blocks.hpp"

/// The bodies of Blocks, for the files that instantiate it. A kind that the model does not have costs nothing.
namespace fascia::gpu {

/// Refuses what has no kind here, before anything is made.
inline const PointSet& known_blocks(const PointSet& set) {
  if (!set.user_blocks.empty()) throw InputError("user blocks are computed on processors alone; run this model there");
  return set;
}

template <class Space>
Blocks<Space>::Blocks(const PointSet& set, Precision precision)
    : kinds_(Points<Space>(known_blocks(set), precision), Elements<Space>(set, precision),
             Shells<Space>(set, precision)),
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

template <class Space>
void Blocks<Space>::store_stress(const PoseView& pose, const double* given, double* out) {
  for_each_kind([&](auto& kind, std::size_t) { kind.store_stress(pose, given, out); });
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

template <class Space>
BlockEnergies Blocks<Space>::energies(const PointSet& set) const {
  // Calls add(block, its quantities) for each used item of a kind.
  const auto each = [&](const auto& kind, std::size_t blocks, const auto& items_of, const auto& add) {
    if (kind.empty()) return;
    const std::vector<int> parts = kind.item_parts(set);
    std::vector<double> q(parts.size() * kQuantities);
    Space::copy_out(q.data(), kind.quantities(), q.size() * sizeof(double));
    std::size_t item = 0;
    for (std::size_t b = 0; b < blocks; ++b)
      for (const std::size_t end = item + at(items_of(b)); item < end; ++item)
        if (parts[item] >= 0) add(b, q.data() + item * kQuantities);
  };
  const auto& [points, elements, shells] = kinds_;
  BlockEnergies out;
  out.groups.resize(at(set.group_count()));
  out.stabilization.resize(out.groups.size());
  out.blocks.resize(set.blocks.size());
  out.shells.resize(set.shells.size());
  out.springs.resize(set.springs.size());
  each(
      points, out.groups.size(), [](std::size_t) { return kGroupSize; },
      [&](std::size_t group, const double* q) {
        out.groups[group] += q[kElastic];
        out.stabilization[group] += q[kStabilizing];
      });
  each(
      elements, out.blocks.size(), [&](std::size_t b) { return set.blocks[b].batch_count() * kElementLanes; },
      [&](std::size_t b, const double* q) { out.blocks[b] += q[kElastic]; });
  each(
      shells, out.shells.size(), [&](std::size_t b) { return set.shells[b].batch_count() * kElementLanes; },
      [&](std::size_t b, const double* q) { out.shells[b] += q[kElastic]; });
  each(
      springs_, out.springs.size(), [](std::size_t) { return 1; },
      [&](std::size_t k, const double* q) { out.springs[k] += q[kElastic]; });
  return out;
}

}  // namespace fascia::gpu
