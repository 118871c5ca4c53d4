#pragma once

#include "core/node/node_step.hpp"
#include "core/step/model_view.hpp"

/// An implicit step at the nodes of a model, as loops see it.
namespace fascia {

/// Where a step starts, and how far it has gone.
struct StepView {
  ModelView model;
  StepConstants step;
  const Vec3d *u0 = nullptr, *v0 = nullptr;
  const Mat3d *D0 = nullptr, *rate0 = nullptr;
  Vec3d *du = nullptr, *u = nullptr;
  Mat3d *Ds = nullptr, *D = nullptr;
  PoseMotion *q = nullptr, *w = nullptr;  ///< not of implicit Euler's rule, in which they are 0 and v
  double* turned = nullptr;               ///< (constraints × 3)
  bool turning = false;                   ///< any node is a frame: there are D, Ds and rates

  FASCIA_HD Mat3d D_at_start(int i) const { return turning ? D0[i] : Mat3d{}; }
  FASCIA_HD Mat3d D_now(int i) const { return turning ? D[i] : Mat3d{}; }
  FASCIA_HD Mat3d rate_at_start(int i) const { return turning ? rate0[i] : Mat3d{}; }
  FASCIA_HD StepNode node(int i) const {
    StepNode n;
    n.kind = model.nodes.kind[i];
    n.inertia = model.inertia[i];
    n.v.u = v0[i];
    n.du = du[i];
    if (turning) {
      n.D = D0[i];
      n.v.Q = rate0[i];
      n.Ds = Ds[i];
    }
    if (step.scheme == TimeScheme::implicit_euler) {
      n.w = n.v;
    } else {
      n.q = q[i];
      n.w = w[i];
    }
    return n;
  }
  /// Inertia of the step at a vertex: a point mass asks for less than a frame.
  FASCIA_HD StepInertia vertex_inertia(int i) const {
    const FrameInertia* damping = model.damping_of(i);
    const bool euler = step.scheme == TimeScheme::implicit_euler;
    return step_inertia(step, model.inertia[i].mass, damping != nullptr ? damping->mass : 0, du[i],
                        euler ? Vec3d{} : q[i].u, euler ? v0[i] : w[i].u, v0[i]);
  }
};

/// Vectors of an evaluation, by degrees of freedom.
struct ForceView {
  double *gradient = nullptr, *load = nullptr, *inertia = nullptr;
  double* node_energy = nullptr;  ///< (nodes × 3): of loads, of inertia [J], square of the inertia that cancels [N²]
};

/// Stores what acts on a node beside its blocks: dead loads and the step's inertia.
FASCIA_HD inline void store_loads_and_inertia(const StepView& s, const ForceView& f, int i) {
  const ModelView& m = s.model;
  const FrameKind kind = m.nodes.kind[i];
  double potential = 0, energy = 0, cancelled = 0;
  double *load = f.load + m.nodes.dof[i], *inertia = f.inertia + m.nodes.dof[i];
  if (kind == FrameKind::vertex) {
    const Vec3d acting = m.vertex_load(i);
    potential = -dot(acting, s.u[i]);
    StepInertia in;
    if (s.step.h > 0) in = s.vertex_inertia(i);
    energy = in.energy + in.damping_energy;
    cancelled = in.cancelled_force;
    for (int k = 0; k < 3; ++k) {
      load[k] = acting[k];
      inertia[k] = in.force[k];
    }
  } else {
    const Mat3d D = s.D_now(i);
    double acting[kMostDofs] = {}, slowing[kMostDofs] = {};
    m.add_dead_loads(kind, i, D, acting);
    for (int k = m.load_begin[i]; k < m.load_begin[i + 1]; ++k)
      potential -= m.factors[m.loads[k].schedule] * dead_load_work(m.loads[k].load, s.u[i], D);
    if (s.step.h > 0) {
      const StepInertia in = step_inertia(s.step, s.node(i), m.damping_of(i), m.nodes.part_length[m.nodes.part[i]]);
      add_node_force(kind, D, in.force, in.moment, {}, slowing);
      energy = in.energy + in.damping_energy;
      cancelled = in.cancelled_force;
    }
    for (int k = 0; k < dof_count(kind); ++k) {
      load[k] = acting[k];
      inertia[k] = slowing[k];
    }
  }
  f.node_energy[3 * i] = potential;
  f.node_energy[3 * i + 1] = energy;
  f.node_energy[3 * i + 2] = cancelled * cancelled;
}

/// Adds what dead loads and the step's inertia are in the tangent of a node. @param Q  its present I + D
FASCIA_HD inline void add_loads_and_inertia_block(const StepView& s, int i, const Mat3d& Q, bool full, double* block) {
  const ModelView& m = s.model;
  if (full && m.nodes.kind[i] == FrameKind::rigid)
    for (int k = m.load_begin[i]; k < m.load_begin[i + 1]; ++k)
      add_dead_load_block(m.loads[k].load, m.factors[m.loads[k].schedule], Q, block);
  if (s.step.h > 0) add_step_inertia_block(s.step, s.node(i), m.damping_of(i), Q, full, block);
}

/// Squares that a residual is judged by, torques divided by the part's length, and energies [J].
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

}  // namespace fascia
