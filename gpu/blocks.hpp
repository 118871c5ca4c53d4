#pragma once

#include "gpu/part_sums.hpp"
#include "gpu/points.hpp"

#include <memory>
#include <vector>

namespace fascia::gpu {

/// What a node gathers from all blocks.
struct BlocksView {
  PointsView points;
  bool has_points = false;

  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    if (has_points) points.add_sums(node, sums);
  }
};

/// Everything elastic of a model: blocks of one interface, each with its own strains in one array.
template <class Space>
class Blocks {
 public:
  explicit Blocks(const PointSet& set);

  BlocksView view() const;
  Points<Space>& points() { return points_; }
  std::size_t strain_size() const { return points_.strain_size(); }
  /// Numbers that sum_quantities() writes.
  std::size_t report_size() const { return reports_ * at(parts_) * kQuantities; }

  void forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history, const double* part_motion);
  void linearize(const NodesView& nodes, const PoseView& pose, const HistoryView& history, Tangent tangent,
                 double* node_blocks);
  void product(const DirectionView& direction);
  void add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks);
  void store_strain(const PoseView& pose, double* E);

  /// Quantities of each part (blocks × parts × kQuantities) of the last forces with them.
  void sum_quantities(double* out);

 private:
  Points<Space> points_;
  PartSums<Space> point_parts_;
  int parts_;
  std::size_t reports_ = 1;
};

}  // namespace fascia::gpu
