#pragma once

#include "core/base/errors.hpp"
#include "core/base/incidence.hpp"
#include "gpu/blocks/shell_kernels.hpp"

#include <limits>

/// The bodies of Shells, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
Shells<Space>::Shells(const PointSet& set, Precision precision)
    : nodes_(set.node_count()), is_narrow_(precision != Precision::full) {
  std::size_t lanes = 0;
  for (const ShellBlock& shell : set.shells) {
    Block block;
    block.constants.upload(shell.constants);
    block.node.upload(shell.node);
    block.view = {shell.count, shell.batch_count(), shell.damped, block.constants.data(), block.node.data()};
    block.narrow = {shell.count, shell.batch_count(), shell.damped, block.constants.data(), block.node.data()};
    block.strain_begin = strain_size_;
    block.memory_begin = set.memory.begin[1 + set.blocks.size() + blocks_.size()];
    block.remembers = !shell.viscosity.empty();
    strain_size_ += at(shell.batch_count()) * 12 * kElementLanes;
    lanes += at(shell.batch_count()) * kElementLanes;
    blocks_.push_back(std::move(block));
  }
  if (lanes * 18 > at(std::numeric_limits<int>::max()))
    throw InputError("the model has more triangles than the GPU backend can number; use fewer, or --backend cpu");
  quantities_.resize(lanes * kQuantities);
  quantities_.set_zero();
  double* quantity = quantities_.data();
  for (Block& block : blocks_) {
    block.view.quantities = quantity;
    quantity += at(block.view.batches) * kElementLanes * kQuantities;
  }
  place_rows(lanes, !is_narrow_, wide_, &Block::view);
  if (is_narrow_) place_rows(lanes, true, narrow_, &Block::narrow);
  std::vector<int> dof;
  dof.reserve(at(nodes_));
  for (int node = 0; node < nodes_; ++node) dof.push_back(set.dofs.begin(node));
  dof_.upload(dof);
  find_corners(set);
}

/// @param products  what a linearisation keeps is there too
template <class Space>
template <class T>
void Shells<Space>::place_rows(std::size_t lanes, bool products, Rows<T>& rows, ShellBlockOf<T> Block::*view) {
  rows.corners.resize(lanes * 18);
  if (products) rows.stiffness.resize(lanes * kShellStiffness);
  T *corner = rows.corners.data(), *stiffness = rows.stiffness.data();
  for (Block& block : blocks_) {
    (block.*view).corners = corner;
    corner += at(block.view.batches) * kElementLanes * 18;
    if (!products) continue;
    (block.*view).stiffness = stiffness;
    stiffness += at(block.view.batches) * kElementLanes * kShellStiffness;
  }
}

/// Places of the forces about each node, of all blocks.
template <class Space>
void Shells<Space>::find_corners(const PointSet& set) {
  std::vector<int> begin, corner;
  const auto for_each_corner = [&](const auto& act) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const auto first = static_cast<int>(blocks_[b].view.corners - wide_.corners.data());
      for (int e = 0; e < set.shells[b].count; ++e)
        for (int a = 0; a < 3; ++a)
          act(set.shells[b].element(e)[at(a)],
              first + (e / kElementLanes * 3 + a) * 6 * kElementLanes + e % kElementLanes);
    }
  };
  list_by_node(nodes_, for_each_corner, begin, corner);
  node_begin_.upload(begin);
  node_corner_.upload(corner);
  wide_.view = {node_begin_.data(), node_corner_.data(), wide_.corners.data(), wide_.stiffness.data()};
  narrow_.view = {node_begin_.data(), node_corner_.data(), narrow_.corners.data(), narrow_.stiffness.data()};
}

template <class Space>
std::vector<int> Shells<Space>::item_parts(const PointSet& set) const {
  std::vector<int> parts;
  for (const ShellBlock& shell : set.shells) {
    const std::size_t first = parts.size();
    for (int e = 0; e < shell.count; ++e) parts.push_back(set.node_part[at(shell.element(e)[0])]);
    parts.resize(first + at(shell.batch_count()) * kElementLanes, -1);
  }
  return parts;
}

template <class Space>
void Shells<Space>::forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history,
                           const double* part_motion) {
  for (const Block& block : blocks_)
    Space::for_each(block.view.batches * kElementLanes,
                    kernels::ShellForces{block.view, history_of(block, history), nodes, pose, part_motion});
}

template <class Space>
void Shells<Space>::linearize(const PoseView& pose, const HistoryView& history, Tangent tangent,
                              const TakenStepView& taken) {
  is_narrow_ ? linearize_as<float>(pose, history, tangent, taken) : linearize_as<double>(pose, history, tangent, taken);
}

template <class Space>
template <class T>
void Shells<Space>::linearize_as(const PoseView& pose, const HistoryView& history, Tangent tangent,
                                 const TakenStepView& taken) {
  for (const Block& block : blocks_)
    Space::for_each(3 * block.view.batches * kElementLanes,
                    kernels::ShellStiffness<T>{block.template view_of<T>(), history_of(block, history), pose, taken,
                                               dof_.data(), tangent == Tangent::full});
}

template <class Space>
template <class T, class V>
void Shells<Space>::product(const DirectionOf<T, V>& direction) {
  for (const Block& block : blocks_)
    Space::for_each(block.view.batches * kElementLanes,
                    kernels::ShellProduct<T, V>{block.template view_of<T>(), direction.d, dof_.data()});
}

template <class Space>
void Shells<Space>::add_diagonal(const NodesView& nodes, const Mat3d*, double* blocks) {
  if (empty()) return;
  if (is_narrow_)
    Space::for_each(6 * nodes_, kernels::ShellDiagonal<float>{view_of<float>(), nodes, blocks});
  else
    Space::for_each(6 * nodes_, kernels::ShellDiagonal<double>{view(), nodes, blocks});
}

/// The strains of shells fade.
template <class Space>
void Shells<Space>::store_stress(const PoseView& pose, const double*, double* out) {
  for (const Block& block : blocks_)
    if (block.remembers)
      Space::for_each(block.view.batches * kElementLanes,
                      kernels::ShellStrains{block.view, pose, out + block.memory_begin * 6});
}

template <class Space>
void Shells<Space>::store_strain(const PoseView& pose, double* E) {
  for (const Block& block : blocks_)
    Space::for_each(block.view.batches * kElementLanes,
                    kernels::ShellStrains{block.view, pose, E + block.strain_begin});
}

}  // namespace fascia::gpu
