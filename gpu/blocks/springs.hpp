#pragma once

#include "core/physics/point_physics.hpp"
#include "core/space/array.hpp"
#include "core/structure/point_set.hpp"
#include "gpu/space/views.hpp"

#include <vector>

namespace fascia::gpu {

/// The springs of a model, in the order of PointSet::springs.
struct SpringsView {
  int count = 0;
  const Spring* spring = nullptr;
  const int *node_begin = nullptr, *node_spring = nullptr;  ///< springs of each node, ascending
  Vec3d* force = nullptr;                                   ///< gradient of the energy at the end of each [N]
  double* quantities = nullptr;                             ///< (springs × kQuantities)

  /// Adds what the last pass gave a node.
  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    for (int k = node_begin[node]; k < node_begin[node + 1]; ++k) {
      const Vec3d& g = force[node_spring[k]];
      sums.force += g;
      sums.N += outer(g, spring[node_spring[k]].arm);
    }
  }
};

/// The springs of a model on the device. A spring acts on one node: its tangent goes into the node's own block.
template <class Space>
class Springs {
 public:
  explicit Springs(const PointSet& set);

  bool empty() const { return view_.count == 0; }
  const SpringsView& view() const { return view_; }

  /// Connected part of each item of quantities(): one item a spring.
  std::vector<int> item_parts(const PointSet& set) const;
  /// (items × kQuantities), of the last forces with them
  const double* quantities() const { return quantities_.data(); }

  /// The gradient of the energy at a pose, for add_sums(). @param part_motion  largest motion of each part (parts) [m];
  /// quantities only where it is given
  void forces(const NodesView& nodes, const PoseView& pose, const double* part_motion);
  /// Adds the tangent at a pose to the own block of each node, by rows; what an arm turns is in it.
  void add_blocks(const NodesView& nodes, const PoseView& pose, Tangent tangent, double* node_blocks) const;

 private:
  Array<Space, Spring> spring_;
  Array<Space, int> node_begin_, node_spring_;
  Array<Space, Vec3d> force_;
  Array<Space, double> quantities_;
  SpringsView view_;
};

}  // namespace fascia::gpu
