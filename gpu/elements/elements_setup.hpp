#pragma once

#include "core/base/errors.hpp"
#include "core/base/incidence.hpp"
#include "core/base/index.hpp"
#include "core/physics/element_law.hpp"
#include "gpu/elements/elements.hpp"

#include <limits>

/// How Elements copies the blocks of a PointSet, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
Elements<Space>::Elements(const PointSet& set, Precision precision)
    : nodes_(set.node_count()), is_narrow_(precision != Precision::full) {
  std::size_t corners = 0, lanes = 0;
  for (const ElementBlock& block : set.blocks) {
    blocks_.push_back(make_block(block, nodes_, is_narrow_));
    blocks_.back().strain_begin = strain_size_;
    blocks_.back().memory_begin = set.memory.begin[blocks_.size()];
    blocks_.back().remembers = !block.beside.empty();
    const auto count = at(block.batch_count()) * kElementLanes;
    strain_size_ += count * at(block.points) * 6;
    corners += count * at(block.nodes) * 3;
    lanes += count;
    if (count * at(block.points) * 9 > at(std::numeric_limits<int>::max()))
      throw InputError(
          "a body has more elements than the GPU backend can number; use several bodies or fewer elements");
  }
  if (corners > at(std::numeric_limits<int>::max()))
    throw InputError("the model has more elements than the GPU backend can number; use fewer, or --backend cpu");
  quantities_.resize(lanes * kQuantities);
  quantities_.set_zero();
  double* quantity = quantities_.data();
  for (Block& block : blocks_) {
    block.wide.view.quantities = quantity;
    quantity += at(block.view().lanes()) * kQuantities;
  }
  place_corners(corners_, corners, &Block::wide);
  if (is_narrow_) place_corners(narrow_corners_, corners, &Block::narrow);
  find_corners(set);
}

/// Gives each block its part of the forces on corners.
template <class Space>
template <class T>
void Elements<Space>::place_corners(Array<Space, T>& corners, std::size_t size, Rows<T> Block::*rows) {
  corners.resize(size);
  T* corner = corners.data();
  for (Block& block : blocks_) {
    (block.*rows).view.corners = corner;
    corner += at(block.view().lanes()) * at(block.view().nodes) * 3;
  }
}

/// Nodes of the model (batches × nodes × 8).
inline std::vector<int> nodes_of_lanes(const ElementBlock& block) {
  std::vector<int> nodes(block.local.size());
  for (int patch = 0; patch < block.patch_count(); ++patch)
    for (int batch = block.patch_batch[at(patch)]; batch < block.patch_batch[at(patch) + 1]; ++batch)
      for (int k = 0; k < block.nodes * kElementLanes; ++k)
        nodes[at(batch * block.nodes * kElementLanes + k)] = block.nodes_of_patch(patch)[block.local_of(batch)[k]];
  return nodes;
}

/// Σ |g|² over the nodes (batches × points × 8).
inline std::vector<double> squared_gradients(const ElementBlock& block) {
  std::vector<double> sums(block.volume.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double* g = block.gradient.data() + i / kElementLanes * at(block.nodes) * 3 * kElementLanes;
    for (int k = 0; k < 3 * block.nodes; ++k) {
      const double value = g[at(k) * kElementLanes + i % kElementLanes];
      sums[i] += value * value;
    }
  }
  return sums;
}

template <class Space>
auto Elements<Space>::make_block(const ElementBlock& block, int nodes_of_model, bool narrow) -> Block {
  Block out;
  out.extrapolates = block.extrapolates();
  out.node.upload(nodes_of_lanes(block));
  if (block.nodes != 4) out.squared_gradient.upload(squared_gradients(block));
  fill_rows(block, !narrow, out, out.wide);
  if (narrow) fill_rows(block, true, out, out.narrow);
  if (block.averaged) prepare_average(block, nodes_of_model, narrow, out);
  return out;
}

/// @param products  what a linearisation keeps is there too
template <class Space>
template <class T>
void Elements<Space>::fill_rows(const ElementBlock& block, bool products, const Block& out, Rows<T>& rows) {
  const auto lanes = at(block.batch_count()) * kElementLanes;
  rows.gradient.upload_rounded(std::span<const double>(block.gradient));
  rows.volume.upload_rounded(std::span<const double>(block.volume));
  rows.material.upload_rounded(std::span<const double>(block.material));
  ElementBlockOf<T>& view = rows.view;
  view.law = block.law;
  view.averaged = block.averaged;
  view.penalised = block.penalised;
  view.damped = block.damped;
  view.nodes = block.nodes;
  view.points = block.points;
  view.count = block.count;
  view.batches = block.batch_count();
  view.gradient = rows.gradient.data();
  view.volume = rows.volume.data();
  view.material = rows.material.data();
  view.node = out.node.data();
  if (!view.one_point()) {
    rows.points_buffer.resize(block.volume.size() * 9);
    if (products) rows.H.resize(block.volume.size() * 9);
    view.squared_gradient = out.squared_gradient.data();
    view.points_buffer = rows.points_buffer.data();
    view.H = rows.H.data();
  }
  if (products && block.law == Law::corotational) {
    rows.turn.resize(lanes * 6);
    view.turn = rows.turn.data();
  }
}

template <class Space>
void Elements<Space>::prepare_average(const ElementBlock& block, int nodes_of_model, bool narrow, Block& out) {
  std::vector<int> begin, around;
  const auto for_each_corner = [&](const auto& act) {
    int corner = 0;
    block.for_each_element([&](std::span<const int> element) {
      for (const int node : element) act(node, corner++);
    });
  };
  list_by_node(nodes_of_model, for_each_corner, begin, around);
  std::vector<double> node_volume(at(nodes_of_model)), node_modulus(at(nodes_of_model));
  for (std::size_t node = 0; node < node_volume.size(); ++node) {
    VolumetricMean mean;
    for (int k = begin[node]; k < begin[node + 1]; ++k) {
      const int e = around[at(k)] / 4;
      const double v = block.volume_of(e / kElementLanes, 0)[e % kElementLanes] / 4;
      node_volume[node] += v;
      mean.add(volumetric_modulus(block.law, block.constants_of(e)), v);
    }
    node_modulus[node] = mean.value();
  }
  out.around_begin.upload(begin);
  out.around.upload(around);
  const auto lanes = at(block.batch_count()) * kElementLanes;
  const auto fill = [&](auto& rows) {
    rows.node_volume.upload_rounded(std::span<const double>(node_volume));
    rows.node_modulus.upload_rounded(std::span<const double>(node_modulus));
    rows.pressure.resize(lanes);
    rows.theta.resize(lanes);
    rows.node_pressure.resize(at(nodes_of_model));
    rows.view.around_begin = out.around_begin.data();
    rows.view.around = out.around.data();
    rows.view.node_volume = rows.node_volume.data();
    rows.view.node_modulus = rows.node_modulus.data();
    rows.view.pressure = rows.pressure.data();
    rows.view.theta = rows.theta.data();
    rows.view.node_pressure = rows.node_pressure.data();
  };
  fill(out.wide);
  if (narrow) fill(out.narrow);
}

/// Places of the forces about each node, of all blocks.
template <class Space>
void Elements<Space>::find_corners(const PointSet& set) {
  std::vector<int> begin, corner;
  const auto for_each_corner = [&](const auto& act) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const auto first = static_cast<int>(blocks_[b].view().corners - corners_.data());
      int e = 0;
      set.blocks[b].for_each_element([&](std::span<const int> element) {
        const int batch = e / kElementLanes * set.blocks[b].nodes;
        for (int a = 0; a < set.blocks[b].nodes; ++a)
          act(element[at(a)], first + (batch + a) * 3 * kElementLanes + e % kElementLanes);
        ++e;
      });
    }
  };
  list_by_node(nodes_, for_each_corner, begin, corner);
  node_begin_.upload(begin);
  node_corner_.upload(corner);
  view_ = {node_begin_.data(), node_corner_.data(), corners_.data()};
  narrow_view_ = {node_begin_.data(), node_corner_.data(), narrow_corners_.data()};
}

template <class Space>
std::vector<int> Elements<Space>::item_parts(const PointSet& set) const {
  std::vector<int> parts;
  for (const ElementBlock& block : set.blocks) {
    const std::size_t first = parts.size();
    block.for_each_element([&](std::span<const int> element) { parts.push_back(set.node_part[at(element[0])]); });
    parts.resize(first + at(block.batch_count()) * kElementLanes, -1);
  }
  return parts;
}

}  // namespace fascia::gpu
