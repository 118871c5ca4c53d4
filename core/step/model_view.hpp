#pragma once

#include "core/node/dof_turn.hpp"
#include "core/node/node_load.hpp"
#include "core/structure/model.hpp"

#include <cstddef>

/// Loops over the nodes of a model see these: pointers into a space (core/space/space.hpp) and values, copied into each
/// loop.
namespace fascia {

/// Nodes of a model.
struct NodesView {
  int count = 0;
  const FrameKind* kind = nullptr;
  const int* dof = nullptr;             ///< first degree of freedom; (nodes + 1)
  const std::size_t* block = nullptr;   ///< where the node's own square block starts among all of them
  const int* part = nullptr;            ///< connected part
  const double* part_length = nullptr;  ///< of each part [m]

  FASCIA_HD int size(int node) const { return dof[node + 1] - dof[node]; }
};

/// The nodes of a set in the memory of the host.
inline NodesView nodes_of(const PointSet& set) {
  return {set.node_count(),     set.dofs.kinds().data(), set.dofs.begins().data(), set.dofs.block_begins().data(),
          set.node_part.data(), set.part_length.data()};
}

/// Displacement and Q − I or A − I of each node. Where no node turns there is no D.
struct PoseView {
  const Vec3d* u = nullptr;
  const Mat3d* D = nullptr;

  FASCIA_HD Mat3d D_of(int node) const { return D == nullptr ? Mat3d{} : D[node]; }
};

/// A dead load on a node, with the number of its schedule.
struct ScheduledLoad {
  int schedule = 0;
  NodeLoad load;
};

/// All that a model says of its nodes.
struct ModelView {
  NodesView nodes;
  const FrameInertia *inertia = nullptr, *damping = nullptr;  ///< damping: none where nothing is damped
  const unsigned* fixed = nullptr;                            ///< bit k: the degree of freedom k of the node is fixed
  const unsigned* carried = nullptr;                          ///< and a constraint holds it
  const int *turn = nullptr, *constraint = nullptr;           ///< of each node, −1: none
  const DofTurn* turns = nullptr;
  const FrameConstraint* constraints = nullptr;
  const PrescribedMotion* motions = nullptr;
  const Vec3d* rest_position = nullptr;
  const int* load_begin = nullptr;  ///< (nodes + 1)
  const ScheduledLoad* loads = nullptr;
  const double* factors = nullptr;  ///< of schedules

  FASCIA_HD void to_local(int node, double* v) const { turn_axes(node, false, v); }
  FASCIA_HD void to_global(int node, double* v) const { turn_axes(node, true, v); }
  FASCIA_HD bool is_fixed(int node, int k) const { return (fixed[node] >> k & 1U) != 0; }
  FASCIA_HD const FrameConstraint* held(int node) const {
    return constraint[node] < 0 ? nullptr : constraints + constraint[node];
  }
  FASCIA_HD const FrameInertia* damping_of(int node) const { return damping == nullptr ? nullptr : damping + node; }
  FASCIA_HD const DofTurn* turn_of(int node) const { return turn[node] < 0 ? nullptr : turns + turn[node]; }
  /// Sum of the dead loads on a vertex.
  FASCIA_HD Vec3d vertex_load(int node) const {
    Vec3d sum;
    for (int k = load_begin[node]; k < load_begin[node + 1]; ++k)
      sum += loads[k].load.force * factors[loads[k].schedule];
    return sum;
  }
  /// Adds dead loads to the entries of a node. @param D  its present A − I
  FASCIA_HD void add_dead_loads(FrameKind kind, int node, const Mat3d& D, double* entries) const {
    for (int k = load_begin[node]; k < load_begin[node + 1]; ++k)
      add_dead_load(kind, loads[k].load, factors[loads[k].schedule], D, entries);
  }

 private:
  FASCIA_HD void turn_axes(int node, bool back, double* v) const {
    if (const DofTurn* axes = turn_of(node); axes != nullptr)
      turn_dofs(nodes.kind[node], axes->translation, axes->rotation, back, v);
  }
};

}  // namespace fascia
