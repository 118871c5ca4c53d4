#pragma once

#include "core/node/positive_inverse.hpp"
#include "core/step/step_loops.hpp"
#include "gpu/blocks/blocks.hpp"

/// Loops over nodes of a step that gather what blocks left.
namespace fascia::gpu::kernels {

/// Internal forces, dead loads and inertia of a node.
struct NodeForces {
  StepView s;
  BlocksView blocks;
  ForceView f;
  Mat3d *L, *tether_L;  ///< N Qᵀ of frames, springs apart; of tethers alone, where there are any

  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const FrameKind kind = m.nodes.kind[i];
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    const Mat3d D = s.D_now(i), Q = Mat3d::identity() + D;
    NodeSums sums;
    blocks.add_sums(i, sums);
    if (s.turning) L[i] = sums.N + times_transpose(sums.N, D);
    if (blocks.has_springs) blocks.springs.add_sums(i, sums);
    double g[kMostDofs] = {};
    for (int k = 0; k < 3; ++k) g[k] = sums.force[k];
    add_moment(kind, sums.N, Q, g + 3);
    if (kind == FrameKind::rigid)
      for (int k = 0; k < 3; ++k) g[3 + k] += sums.torque[k];
    if (tether_L != nullptr) {
      NodeSums pull;
      blocks.points.add_tether_sums(i, pull);
      tether_L[i] = pull.N + times_transpose(pull.N, D);
    }
    for (int k = 0; k < n; ++k) f.gradient[first + k] = g[k];
    store_loads_and_inertia(s, f, i);
  }
};

/// N Qᵀ of frames, of what points pull with extrapolated stresses.
struct ExtrapolatedMoments {
  StepView s;
  PointsView points;
  Mat3d* L;
  FASCIA_HD void operator()(int i) const {
    NodeSums sums;
    points.add_sums(i, sums);
    L[i] = sums.N + times_transpose(sums.N, s.D_now(i));
  }
};

/// The tangent's terms of one node alone.
struct NodeBlocks {
  StepView s;
  const Mat3d *L, *tether_L;  ///< the second is taken off where it is given
  Mat3d* Q;
  double* blocks;
  bool full;

  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const int n = m.nodes.size(i);
    double* block = blocks + m.nodes.block[i];
    for (int k = 0; k < n * n; ++k) block[k] = 0;
    Q[i] = Mat3d::identity() + s.D_now(i);
    if (full && m.nodes.kind[i] == FrameKind::rigid)
      add_rotation_block(block, rotation_tangent(tether_L == nullptr ? L[i] : L[i] - tether_L[i]));
    add_loads_and_inertia_block(s, i, Q[i], full, block);
  }
};

/// The inverse of a node's own block in constraint axes.
struct InvertBlocks {
  ModelView m;
  double* blocks;
  bool diagonal, identity;  ///< Jacobi; no preconditioner
  FASCIA_HD void operator()(int i) const {
    const int n = m.nodes.size(i);
    double* block = blocks + m.nodes.block[i];
    double local[kMostDofs * kMostDofs];
    const DofTurn* turn = m.turn_of(i);
    turn_block(m.nodes.kind[i], turn, m.nodes.kind[i], turn, block, local);
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c) {
        const bool held = m.is_fixed(i, r) || m.is_fixed(i, c);
        block[n * r + c] = held || identity || (diagonal && r != c) ? (r == c ? 1 : 0) : local[n * r + c];
      }
    if (!identity) positive_inverse(block, n);
  }
};

}  // namespace fascia::gpu::kernels
