#pragma once

#include "core/base/incidence.hpp"
#include "core/node/node_force.hpp"
#include "core/physics/spring_law.hpp"
#include "gpu/blocks/springs.hpp"

/// The bodies of Springs, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
Springs<Space>::Springs(const PointSet& set) {
  spring_.upload(set.springs);
  std::vector<int> begin, spring;
  list_by_node(
      set.node_count(),
      [&](const auto& act) {
        for (std::size_t k = 0; k < set.springs.size(); ++k) act(set.springs[k].node, static_cast<int>(k));
      },
      begin, spring);
  node_begin_.upload(begin);
  node_spring_.upload(spring);
  force_.resize(set.springs.size());
  force_.set_zero();
  quantities_.resize(set.springs.size() * kQuantities);
  quantities_.set_zero();
  view_ = {static_cast<int>(set.springs.size()),
           spring_.data(),
           node_begin_.data(),
           node_spring_.data(),
           force_.data(),
           quantities_.data()};
}

template <class Space>
std::vector<int> Springs<Space>::item_parts(const PointSet& set) const {
  std::vector<int> parts;
  for (const Spring& spring : set.springs) parts.push_back(set.node_part[at(spring.node)]);
  return parts;
}

namespace kernels {

/// Displacement of the place that a spring is attached to.
FASCIA_HD inline Vec3d end_of(const Spring& spring, const PoseView& pose) {
  return pose.u[spring.node] + pose.D_of(spring.node) * spring.arm;
}

struct SpringForces {
  SpringsView set;
  NodesView nodes;
  PoseView pose;
  const double* part_motion;

  FASCIA_HD void operator()(int k) const {
    const Spring& spring = set.spring[k];
    const Vec3d u = end_of(spring, pose);
    set.force[k] = spring_gradient(spring, u);
    if (part_motion == nullptr) return;
    const double rounding = spring.stiffness * part_motion[nodes.part[spring.node]];
    set.quantities[k * kQuantities + kElastic] = spring_energy(spring, u);
    set.quantities[k * kQuantities + kRounding] = rounding * rounding;
  }
};

/// Those of one node, one after the other.
struct SpringBlocks {
  SpringsView set;
  NodesView nodes;
  PoseView pose;
  bool full;
  double* node_blocks;

  FASCIA_HD void operator()(int node) const {
    double* block = node_blocks + nodes.block[node];
    const int n = nodes.size(node);
    for (int k = set.node_begin[node]; k < set.node_begin[node + 1]; ++k) {
      const Spring& spring = set.spring[set.node_spring[k]];
      const Vec3d u = end_of(spring, pose);
      const Mat3d K = spring_tangent(spring, u, full);
      add(block, n, 0, 0, K);
      if (squared_norm(spring.arm) == 0) continue;
      const Vec3d arm = spring.arm + pose.D_of(node) * spring.arm;
      const Mat3d W = skew(arm) * -1.0;  // du of the end for a small rotation
      add(block, n, 0, 3, K * W);
      add(block, n, 3, 0, transpose(W) * K);
      add(block, n, 3, 3, transpose(W) * K * W);
      if (full) add_rotation_block(block, rotation_tangent(outer(spring_gradient(spring, u), arm)));
    }
  }

 private:
  FASCIA_HD static void add(double* block, int n, int row, int column, const Mat3d& part) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) block[n * (row + i) + column + j] += part(i, j);
  }
};

}  // namespace kernels

template <class Space>
void Springs<Space>::forces(const NodesView& nodes, const PoseView& pose, const double* part_motion) {
  Space::for_each(view_.count, kernels::SpringForces{view_, nodes, pose, part_motion});
}

template <class Space>
void Springs<Space>::add_blocks(const NodesView& nodes, const PoseView& pose, Tangent tangent,
                                double* node_blocks) const {
  if (empty()) return;
  Space::for_each(nodes.count, kernels::SpringBlocks{view_, nodes, pose, tangent == Tangent::full, node_blocks});
}

}  // namespace fascia::gpu
