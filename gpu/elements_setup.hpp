#pragma once

#include "core/math/index.hpp"
#include "core/model/errors.hpp"
#include "core/physics/element_law.hpp"
#include "gpu/elements.hpp"
#include "gpu/incidence.hpp"

#include <limits>

/// How Elements copies the blocks of a PointSet, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
Elements<Space>::Elements(const PointSet& set) : nodes_(set.node_count()) {
  std::size_t corners = 0, lanes = 0;
  for (const ElementBlock& block : set.blocks) {
    blocks_.push_back(make_block(block, nodes_));
    blocks_.back().strain_begin = strain_size_;
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
  corners_.resize(corners);
  quantities_.resize(lanes * kQuantities);
  quantities_.set_zero();
  double *corner = corners_.data(), *quantity = quantities_.data();
  for (Block& block : blocks_) {
    block.view.corners = corner;
    block.view.quantities = quantity;
    corner += at(block.view.lanes()) * at(block.view.nodes) * 3;
    quantity += at(block.view.lanes()) * kQuantities;
  }
  find_corners(set);
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
auto Elements<Space>::make_block(const ElementBlock& block, int nodes_of_model) -> Block {
  Block out;
  const auto lanes = at(block.batch_count()) * kElementLanes;
  out.gradient.upload(block.gradient);
  out.volume.upload(block.volume);
  out.material.upload(block.material);
  out.node.upload(nodes_of_lanes(block));
  ElementBlockView& view = out.view;
  view.law = block.law;
  view.averaged = block.averaged;
  view.penalised = block.penalised;
  view.damped = block.damped;
  view.nodes = block.nodes;
  view.points = block.points;
  view.count = block.count;
  view.batches = block.batch_count();
  view.gradient = out.gradient.data();
  view.volume = out.volume.data();
  view.material = out.material.data();
  view.node = out.node.data();
  if (!view.one_point()) {
    out.squared_gradient.upload(squared_gradients(block));
    out.points_buffer.resize(block.volume.size() * 9);
    out.H.resize(block.volume.size() * 9);
    view.squared_gradient = out.squared_gradient.data();
    view.points_buffer = out.points_buffer.data();
    view.H = out.H.data();
  }
  if (block.law == ElementLaw::corotational) {
    out.turn.resize(lanes * 6);
    view.turn = out.turn.data();
  }
  if (block.averaged) prepare_average(block, nodes_of_model, out);
  return out;
}

template <class Space>
void Elements<Space>::prepare_average(const ElementBlock& block, int nodes_of_model, Block& out) {
  std::vector<int> begin, around;
  const auto for_each_corner = [&](const auto& act) {
    int corner = 0;
    block.for_each_element([&](std::span<const int> element) {
      for (const int node : element) act(node, corner++);
    });
  };
  list_by_node(nodes_of_model, for_each_corner, begin, around);
  std::vector<double> node_volume(at(nodes_of_model)), node_lambda(at(nodes_of_model));
  for (std::size_t node = 0; node < node_volume.size(); ++node) {
    LambdaMean mean;
    for (int k = begin[node]; k < begin[node + 1]; ++k) {
      const int e = around[at(k)] / 4;
      const double v = block.volume_of(e / kElementLanes, 0)[e % kElementLanes] / 4;
      node_volume[node] += v;
      mean.add(block.material_of(e / kElementLanes)[e % kElementLanes], v);
    }
    node_lambda[node] = mean.value();
  }
  out.around_begin.upload(begin);
  out.around.upload(around);
  out.node_volume.upload(node_volume);
  out.node_lambda.upload(node_lambda);
  const auto lanes = at(block.batch_count()) * kElementLanes;
  out.pressure.resize(lanes);
  out.theta.resize(lanes);
  out.node_pressure.resize(at(nodes_of_model));
  ElementBlockView& view = out.view;
  view.around_begin = out.around_begin.data();
  view.around = out.around.data();
  view.node_volume = out.node_volume.data();
  view.node_lambda = out.node_lambda.data();
  view.pressure = out.pressure.data();
  view.theta = out.theta.data();
  view.node_pressure = out.node_pressure.data();
}

/// Places of the forces about each node, of all blocks.
template <class Space>
void Elements<Space>::find_corners(const PointSet& set) {
  std::vector<int> begin, corner;
  const auto for_each_corner = [&](const auto& act) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const auto first = static_cast<int>(blocks_[b].view.corners - corners_.data());
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
