#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/base/thread_pool.hpp"

#include <cstddef>
#include <vector>

namespace fascia::app {

/// Strains and stresses at the nodes of a body from those at its integration points. At a node X they are the value
/// there of the linear field that fits the points whose material the node moves best, of those of the nearest one's
/// material, in the least squares weighted with w v: a field that is linear in the rest position is recovered exactly,
/// also at the surface and, of a grid, at frames outside of it, where an average would lag behind by half an element
/// (the patches of Zienkiewicz and Zhu, 1992, with the points of all elements at a node). Where the points lie too
/// close together for the distance to X, the slope counts less, down to the average.
class NodalRecovery {
 public:
  /// What an integration point adds to a node.
  struct Share {
    int point = 0;
    double weight = 0;
  };

  explicit NodalRecovery(const SimulatedBody& body);
  /// @param points  one for each integration point
  std::vector<PointTensors> at_nodes(const std::vector<PointTensors>& points, ThreadPool& pool) const;

 private:
  void find_patches(const SimulatedBody& body);

  std::vector<Share> shares_;
  std::vector<std::size_t> begin_;  ///< of each node's shares, and the end
};

/// Adds a share of strain, stress and energy density.
inline void add_share(PointTensors& sum, const PointTensors& t, double share) {
  sum.strain += t.strain * share;
  sum.stress += t.stress * share;
  sum.energy_density += t.energy_density * share;
}

}  // namespace fascia::app
