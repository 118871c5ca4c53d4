#pragma once

#include "core/node/node_finish.hpp"
#include "core/node/node_load.hpp"
#include "core/node/positive_inverse.hpp"
#include "core/node/small_factor.hpp"
#include "core/solver/boundary_motion.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/space/space.hpp"
#include "gpu/system/model_data.hpp"

/// Loops over nodes of a step. Each is the counterpart of a member function of MechanicalSystem, and calls the same
/// formulas of one node.
namespace fascia::gpu::kernels {

/// Where a step starts, and how far it has gone.
struct StepView {
  ModelView model;
  StepConstants step;
  const Vec3d *u0 = nullptr, *v0 = nullptr;
  const Mat3d *D0 = nullptr, *rate0 = nullptr;
  Vec3d *du = nullptr, *u = nullptr;
  Mat3d *Ds = nullptr, *D = nullptr;
  PoseMotion *q = nullptr, *w = nullptr;
  double* turned = nullptr;  ///< (constraints × 3)
  bool turning = false;      ///< any node is a frame: there are D, Ds and rates

  FASCIA_HD Mat3d D_at_start(int i) const { return turning ? D0[i] : Mat3d{}; }
  FASCIA_HD Mat3d D_now(int i) const { return turning ? D[i] : Mat3d{}; }
  FASCIA_HD StepNode node(int i) const {
    StepNode n;
    n.kind = model.nodes.kind[i];
    n.inertia = model.inertia[i];
    n.v.u = v0[i];
    n.du = du[i];
    n.q = q[i];
    n.w = w[i];
    if (turning) {
      n.D = D0[i];
      n.v.Q = rate0[i];
      n.Ds = Ds[i];
    }
    return n;
  }
};

/// u and D of the present increments.
struct RebuildState {
  StepView s;
  FASCIA_HD void operator()(int i) const {
    s.u[i] = s.u0[i] + s.du[i];
    if (s.turning) s.D[i] = incremented(s.model.nodes.kind[i], s.Ds[i], s.D0[i]);
  }
};

/// q and w of the scheme.
struct Predict {
  StepView s;
  const PoseMotion *motion, *velocity, *acceleration;
  FASCIA_HD void operator()(int i) const {
    StepNode n = s.node(i);
    predict(s.step, {motion + i, velocity + i, acceleration + i}, n);
    const FrameConstraint* held = s.model.held(i);
    if (s.step.scheme == TimeScheme::midpoint && held != nullptr) straighten_held(*held, n.q.u);
    s.q[i] = n.q;
    s.w[i] = n.w;
  }
};

/// Increments along the old velocities, of nodes that nothing holds.
struct PredictIncrement {
  StepView s;
  FASCIA_HD void operator()(int i) const {
    if (s.model.constraint[i] >= 0) return;
    s.du[i] = s.v0[i] * s.step.reach;
    if (s.turning) s.Ds[i] = increment_along(s.model.nodes.kind[i], s.D0[i], s.rate0[i], s.step.reach);
  }
};

/// Where the old velocities lead after a time.
struct MoveByVelocity {
  StepView s;
  double time;
  Vec3d* u;
  Mat3d* D;
  FASCIA_HD void operator()(int i) const {
    const MovedNode moved = moved_by_velocity(s.step, s.node(i), time);
    u[i] = s.u0[i] + moved.du;
    if (s.turning) D[i] = moved.D;
  }
};

/// Vectors of an evaluation, by degrees of freedom.
struct ForceView {
  double *gradient = nullptr, *load = nullptr, *inertia = nullptr;
  double* node_energy = nullptr;  ///< (nodes × 3): of loads, of inertia [J], square of the inertia that cancels [N²]
  Mat3d *L = nullptr, *tether_L = nullptr;  ///< N Qᵀ of frames, springs apart; of tethers alone, where there are any
};

/// Internal forces, dead loads and inertia of a node.
struct NodeForces {
  StepView s;
  BlocksView blocks;
  ForceView f;

  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const FrameKind kind = m.nodes.kind[i];
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    const Mat3d D = s.D_now(i), Q = Mat3d::identity() + D;
    NodeSums sums;
    blocks.add_sums(i, sums);
    if (s.turning) f.L[i] = sums.N + times_transpose(sums.N, D);
    if (blocks.has_springs) blocks.springs.add_sums(i, sums);
    double g[kMostDofs] = {}, load[kMostDofs] = {}, inertia[kMostDofs] = {};
    for (int k = 0; k < 3; ++k) g[k] = sums.force[k];
    add_moment(kind, sums.N, Q, g + 3);
    if (kind == FrameKind::rigid)
      for (int k = 0; k < 3; ++k) g[3 + k] += sums.torque[k];
    if (f.tether_L != nullptr) {
      NodeSums pull;
      blocks.points.add_tether_sums(i, pull);
      f.tether_L[i] = pull.N + times_transpose(pull.N, D);
    }
    double work = 0, energy = 0, cancelled = 0;
    for (int k = m.load_begin[i]; k < m.load_begin[i + 1]; ++k) {
      const double factor = m.factors[m.loads[k].schedule];
      add_dead_load(kind, m.loads[k].load, factor, D, load);
      work += factor * dead_load_work(m.loads[k].load, s.u[i], D);
    }
    if (s.step.h > 0) {
      const StepInertia in = step_inertia(s.step, s.node(i), m.damping_of(i), m.nodes.part_length[m.nodes.part[i]]);
      add_node_force(kind, D, in.force, in.moment, {}, inertia);
      energy = in.energy + in.damping_energy;
      cancelled = in.cancelled_force;
    }
    for (int k = 0; k < n; ++k) {
      f.gradient[first + k] = g[k];
      f.load[first + k] = load[k];
      f.inertia[first + k] = inertia[k];
    }
    f.node_energy[3 * i] = -work;
    f.node_energy[3 * i + 1] = energy;
    f.node_energy[3 * i + 2] = cancelled * cancelled;
  }
};

/// gradient += inertia − load, once all loads are there.
struct AddInertiaAndLoads {
  ForceView f;
  FASCIA_HD void operator()(int i) const { f.gradient[i] += f.inertia[i] - f.load[i]; }
};

/// Squares that a residual is judged by, torques divided by the part's length.
enum NodeQuantity {
  kLoad,
  kInertia,
  kResidual,
  kReaction,
  kLoadEnergy,
  kInertiaEnergy,
  kCancelled,
  kTurnedLoad,  ///< that constraints with axes of their own carry
  kNodeQuantities
};

struct NodeReport {
  ModelView m;
  ForceView f;
  FASCIA_HD void operator()(int i, Sums<kNodeQuantities>& sums) const {
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    const double length = m.nodes.part_length[m.nodes.part[i]];
    double load[kMostDofs], inertia[kMostDofs], gradient[kMostDofs];
    for (int k = 0; k < n; ++k) {
      load[k] = f.load[first + k];
      inertia[k] = f.inertia[first + k];
      gradient[k] = f.gradient[first + k];
    }
    m.to_local(i, load);
    m.to_local(i, inertia);
    m.to_local(i, gradient);
    for (int k = 0; k < n; ++k) {
      const double scale = k < 3 ? 1 : 1 / (length * length);
      const bool fixed = m.is_fixed(i, k), carried = (m.carried[i] >> k & 1U) != 0;
      const double left = carried ? gradient[k] + load[k] : gradient[k];
      if (!carried || m.turn[i] >= 0) sums.v[carried ? kTurnedLoad : kLoad] += load[k] * load[k] * scale;
      if (!fixed) sums.v[kInertia] += inertia[k] * inertia[k] * scale;
      sums.v[fixed ? kReaction : kResidual] += left * left * scale;
    }
    sums.v[kLoadEnergy] += f.node_energy[3 * i];
    sums.v[kInertiaEnergy] += f.node_energy[3 * i + 1];
    sums.v[kCancelled] += f.node_energy[3 * i + 2];
  }
};

/// Displacement of a node, or its rotation over the part's length, whichever is larger.
struct NodeMotion {
  StepView s;
  FASCIA_HD void operator()(int i, Sums<0, 1>& sums) const {
    sums.note(0, norm(s.u[i]));
    if (s.turning && s.model.nodes.kind[i] != FrameKind::vertex)
      sums.note(0, s.model.nodes.part_length[s.model.nodes.part[i]] * norm(s.D[i]));
  }
};

/// The larger of two, and at least what was at the start.
struct AtLeast {
  const double* least;
  double* value;
  FASCIA_HD void operator()(int p) const {
    if (least[p] > value[p]) value[p] = least[p];
  }
};

/// Ends a sum by writing it.
template <int K, int M>
struct StoreSums {
  double* out;
  FASCIA_HD void operator()(const Sums<K, M>& total) const {
    for (int k = 0; k < K; ++k) out[k] = total.v[k];
    for (int k = 0; k < M; ++k) out[K + k] = total.largest[k];
  }
};

/// E + c (E − E₋)
struct Extrapolate {
  double* E;
  const double* before;
  double c;
  FASCIA_HD void operator()(int k) const { E[k] += c * (E[k] - before[k]); }
};

/// E + h dE/dt, or E − ½ h² d²E/dt², from strains ahead and behind along the velocity.
struct StrainAlongVelocity {
  double* E;
  const double *ahead, *behind;
  bool rate;
  FASCIA_HD void operator()(int k) const {
    E[k] += rate ? 0.5 * (ahead[k] - behind[k]) : -0.5 * (ahead[k] - 2 * E[k] + behind[k]);
  }
};

/// E − dt dE/dt at the end of a step, from the strains at its start and a step before; null: none.
struct StrainFromSteps {
  double* E;
  const double *before, *earlier;
  FASCIA_HD void operator()(int k) const {
    const double increment = E[k] - before[k];
    E[k] -= earlier == nullptr ? increment : end_increment(increment, before[k] - earlier[k]);
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
    const FrameKind kind = m.nodes.kind[i];
    const int n = m.nodes.size(i);
    double* block = blocks + m.nodes.block[i];
    for (int k = 0; k < n * n; ++k) block[k] = 0;
    Q[i] = Mat3d::identity() + s.D_now(i);
    if (full && kind == FrameKind::rigid) {
      add_rotation_block(block, rotation_tangent(tether_L == nullptr ? L[i] : L[i] - tether_L[i]));
      for (int k = m.load_begin[i]; k < m.load_begin[i + 1]; ++k)
        add_dead_load_block(m.loads[k].load, m.factors[m.loads[k].schedule], Q[i], block);
    }
    if (s.step.h > 0) add_step_inertia_block(s.step, s.node(i), m.damping_of(i), Q[i], full, block);
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
    const DofTurn* turn = m.turn[i] < 0 ? nullptr : m.turns + m.turn[i];
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
