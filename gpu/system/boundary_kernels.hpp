#pragma once

#include "gpu/system/step_kernels.hpp"

/// Loops over constraints, and over nodes at the end of a step.
namespace fascia::gpu::kernels {

/// What the prescribed degrees of freedom still lack, in constraint axes. Of other nodes it stays zero.
struct FindPrescribed {
  StepView s;
  double* local;
  FASCIA_HD void operator()(int k) const {
    const ModelView& m = s.model;
    const FrameConstraint& c = m.constraints[k];
    prescribed_increment(m.nodes.kind[c.node], c, m.fixed[c.node], m.motions, m.factors, m.rest_position[c.node],
                         s.u[c.node], s.D_now(c.node), s.turned + 3 * k, local + m.nodes.dof[c.node]);
  }
};

/// Largest displacement now and at the start, and largest entry that is left of places and of rotations.
struct PrescribedLeft {
  StepView s;
  const double* local;
  FASCIA_HD void operator()(int i, Sums<0, 3>& sums) const {
    sums.note(0, norm(s.u[i]));
    sums.note(0, norm(s.u0[i]));
    if (s.model.constraint[i] < 0) return;
    const int first = s.model.nodes.dof[i];
    for (int k = 0; k < s.model.nodes.size(i); ++k) sums.note(k < 3 ? 1 : 2, fabs(local[first + k]));
  }
};

/// Adds a multiple of a direction in world axes to the increments, and places the node.
struct Advance {
  StepView s;
  const double* direction;
  double step;
  FASCIA_HD void operator()(int i) const {
    const FrameKind kind = s.model.nodes.kind[i];
    const double* d = direction + s.model.nodes.dof[i];
    Mat3d Ds = s.turning ? s.Ds[i] : Mat3d{};
    advance_increment(kind, d, step, s.du[i], Ds);
    if (s.turning) s.Ds[i] = Ds;
    const int c = s.model.constraint[i];
    if (c >= 0 && kind == FrameKind::rigid) advance_turned(s.model.constraints[c], d, step, s.turned + 3 * c);
    RebuildState{s}(i);
  }
};

/// The solution of a solve with what is prescribed, in world axes. Sums: its slope along the gradient; the largest
/// rotation of a frame and the largest entry.
template <class V>
struct TakeDirection {
  ModelView m;
  const V* x;
  const double *prescribed, *gradient;
  double* direction;
  FASCIA_HD void operator()(int i, Sums<1, 2>& sums) const {
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    double d[kMostDofs];
    for (int k = 0; k < n; ++k)
      d[k] = prescribed != nullptr && m.is_fixed(i, k) ? prescribed[first + k] : static_cast<double>(x[first + k]);
    m.to_global(i, d);
    for (int k = 0; k < n; ++k) {
      direction[first + k] = d[k];
      sums.v[0] += gradient[first + k] * d[k];
      sums.note(1, fabs(d[k]));
    }
    sums.note(0, rotation_in(m.nodes.kind[i], d));
  }
};

/// Poses and velocities at the end of a step, and what the scheme keeps of it.
struct FinishStep {
  StepView s;
  Vec3d *u, *v;
  Mat3d *D, *Q_dot;
  PoseMotion *motion, *velocity, *acceleration;
  const PoseMotion* before;  ///< motion in a step before of the same length, or none
  bool remembers;

  FASCIA_HD void operator()(int i) const {
    const StepNode n = s.node(i);
    const PoseMotion x = motion_of(n);
    const bool has_before = before != nullptr;
    const Vec3d last = has_before ? before[i].u : x.u;
    u[i] = s.u[i];
    Mat3d D_end = s.D_now(i);
    if (n.rigid()) D_end = orthonormalized_increment(D_end);
    EndRates rates;
    if (s.step.h > 0) rates = rates_at_end(s.step, n, D_end);
    const FrameConstraint* held = s.model.held(i);
    if (s.step.h > 0 && held != nullptr && s.step.scheme == TimeScheme::newmark)
      follow_boundary(s.step, n.kind, *held, x, last, D_end, rates);
    v[i] = rates.v.u;
    if (s.turning) {
      D[i] = D_end;
      Q_dot[i] = rates.v.Q;
    }
    if (!remembers) return;
    motion[i] = x;
    velocity[i] = n.v;
    if (acceleration != nullptr) acceleration[i] = rates.a;
  }
};

/// The same of the midpoint rule, without what is prescribed.
struct FinishMiddle {
  StepView s;
  Vec3d *u, *v;
  Mat3d *D, *Q_dot;
  PoseMotion *motion, *velocity;
  double* turned;

  FASCIA_HD void operator()(int i) const {
    const StepNode n = s.node(i);
    const int c = s.model.constraint[i];
    const MiddleEnd end = finish_middle(s.step, n, s.model.held(i), s.D_now(i));
    motion[i] = end.motion;
    velocity[i] = n.v;
    u[i] = s.u0[i] + end.motion.u;
    v[i] = end.v.u;
    if (s.turning) {
      D[i] = n.D + end.motion.Q;
      Q_dot[i] = end.v.Q;
    }
    for (int a = 0; c >= 0 && a < 3; ++a) turned[3 * c + a] = 2 * s.turned[3 * c + a] - turned[3 * c + a];
  }
};

/// Moves what is prescribed onto its target at the end of a midpoint step, makes rotations orthogonal, and gives what
/// is prescribed the velocity of its motion.
struct FinishHeld {
  StepView s;
  Vec3d *u, *v;
  Mat3d *D, *Q_dot;
  PoseMotion* motion;
  const PoseMotion* before;
  double* turned;

  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const FrameKind kind = m.nodes.kind[i];
    const int k = m.constraint[i];
    Mat3d D_end = s.turning ? D[i] : Mat3d{};
    if (k >= 0) {
      const FrameConstraint& c = m.constraints[k];
      double d[kMostDofs] = {};
      prescribed_increment(kind, c, m.fixed[i], m.motions, m.factors, m.rest_position[i], u[i], D_end, turned + 3 * k,
                           d);
      m.to_global(i, d);
      Mat3d Ds;
      advance_increment(kind, d, 1, u[i], Ds);
      D_end = incremented(kind, Ds, D_end);
      if (kind == FrameKind::rigid) advance_turned(c, d, 1, turned + 3 * k);
      motion[i] = {u[i] - s.u0[i], D_end - s.D_at_start(i)};
    }
    if (kind == FrameKind::rigid) D_end = orthonormalized_increment(D_end);
    if (k >= 0) {
      const Vec3d last = before != nullptr ? before[i].u : motion[i].u;
      EndRates rates{{v[i], s.turning ? Q_dot[i] : Mat3d{}}, {}};
      follow_boundary(s.step, kind, m.constraints[k], motion[i], last, D_end, rates);
      v[i] = rates.v.u;
      if (s.turning) Q_dot[i] = rates.v.Q;
    }
    if (s.turning) D[i] = D_end;
  }
};

/// Newmark's first acceleration of a node, from the gradient of the internal energy and the loads.
struct StartAcceleration {
  StepView s;
  const double* force;  ///< loads minus gradient, with what dependent nodes hand on
  PoseMotion* acceleration;

  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const FrameKind kind = m.nodes.kind[i];
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    const Mat3d D = s.D_now(i);
    double a[kMostDofs];
    for (int k = 0; k < n; ++k) a[k] = force[first + k];
    m.to_local(i, a);
    for (int k = 0; k < n; ++k)
      if (m.is_fixed(i, k)) a[k] = 0;
    double block[kMostDofs * kMostDofs];
    free_mass_block(kind, m.inertia[i], Mat3d::identity() + D, m.turn[i] < 0 ? nullptr : m.turns + m.turn[i],
                    m.fixed[i], block);
    SmallFactor factor;
    if (factor.factorize(block, n))
      factor.solve(a);
    else
      for (int k = 0; k < n; ++k) a[k] = 0;
    m.to_global(i, a);
    acceleration[i] = acceleration_of(kind, a, D, s.turning ? s.rate0[i] : Mat3d{});
  }
};

/// Minus the gradient, which has no inertia, minus what velocities ask for.
struct ForceOfAcceleration {
  StepView s;
  ForceView f;
  double* force;
  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const FrameKind kind = m.nodes.kind[i];
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    double g[kMostDofs];
    for (int k = 0; k < n; ++k) g[k] = -f.gradient[first + k];
    const PoseMotion v{s.v0[i], s.turning ? s.rate0[i] : Mat3d{}};
    const InertiaForce in = inertia_of_velocity(kind, m.inertia[i], m.damping_of(i), s.D_now(i), v);
    add_node_force(kind, s.D_now(i), -in.force, in.moment * -1.0, {}, g);
    for (int k = 0; k < n; ++k) force[first + k] = g[k];
  }
};

/// From the place that a tether holds to its target, as CpuExecutor::tether_stretch().
FASCIA_HD inline Vec3d tether_stretch(const PointsView& points, const PoseView& pose, const Tether& t,
                                      const double* targets) {
  Vec3d stretch;
  for (int k = 0; k < 3; ++k) stretch[k] = targets[at(points.rule[t.group].axes * 3 + k) * kGroupSize + at(t.lane)];
  for (int slot = points.slot_begin[t.group]; slot < points.slot_begin[t.group + 1]; ++slot) {
    const double* shape = points.shape + at(slot) * 13 * kGroupSize + t.lane;
    const Vec3d lever{{shape[4 * kGroupSize], shape[7 * kGroupSize], shape[10 * kGroupSize]}};
    stretch -= pose.u[points.slot_node[slot]] * shape[kGroupSize] + pose.D_of(points.slot_node[slot]) * lever;
  }
  return stretch;
}

/// That of all.
struct NoteStretches {
  const Tether* tethers;
  PointsView points;
  PoseView pose;
  const double* targets;
  Vec3d* stretch;
  FASCIA_HD void operator()(int i) const { stretch[i] = tether_stretch(points, pose, tethers[i], targets); }
};

/// Moves targets so that tethers are stretched as a sum of what they were in the middles of steps.
struct StretchTethers {
  const Tether* tethers;
  PointsView points;
  PoseView pose;
  const Vec3d* stretch[3];
  double weight[3];
  double* targets;
  FASCIA_HD void operator()(int i) const {
    const Tether& t = tethers[i];
    Vec3d more = tether_stretch(points, pose, t, targets) * -1.0;
    for (int k = 0; k < 3; ++k)
      if (weight[k] != 0) more += stretch[k][i] * weight[k];
    move_target(t, points.rule[t.group].axes, more, targets);
  }
};

/// Adds what accelerated supports carry of their own mass, and its damping.
struct SupportInertia {
  StepView s;
  const Vec3d *v, *v_before;
  const Mat3d *rate, *rate_before;
  double inverse_dt;
  double* gradient;
  FASCIA_HD void operator()(int k) const {
    const ModelView& m = s.model;
    const int i = m.constraints[k].node;
    const Mat3d rate_change = s.turning ? (rate[i] - rate_before[i]) * inverse_dt : Mat3d{};
    InertiaForce f = inertia_force(m.inertia[i], (v[i] - v_before[i]) * inverse_dt, rate_change);
    if (const FrameInertia* damping = m.damping_of(i); damping != nullptr) {
      const InertiaForce drag = inertia_force(*damping, v[i], s.turning ? rate[i] : Mat3d{});
      f.force += drag.force;
      f.moment += drag.moment;
    }
    add_node_force(m.nodes.kind[i], s.D_now(i), f.force, f.moment, {}, gradient + m.nodes.dof[i]);
  }
};

}  // namespace fascia::gpu::kernels
