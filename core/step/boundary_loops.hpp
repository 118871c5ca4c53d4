#pragma once

#include "core/node/node_finish.hpp"
#include "core/node/prescribed.hpp"
#include "core/node/small_factor.hpp"
#include "core/space/array.hpp"
#include "core/step/step_loops.hpp"

#include <array>
#include <vector>

/// Loops over constraints, and over nodes at the start and the end of a step.
namespace fascia::loops {

/// State::turned as loops see it, of the host or of another space: three numbers a constraint, or null.
inline double* flat(std::vector<std::array<double, 3>>& turned) { return turned.empty() ? nullptr : turned[0].data(); }
inline const double* flat(const std::vector<std::array<double, 3>>& turned) {
  return turned.empty() ? nullptr : turned[0].data();
}
template <class Space>
double* flat(Array<Space, double>& turned) {
  return turned.data();
}

/// Finds what the prescribed degrees of freedom still lack, in constraint axes. Goes over constraints; of other nodes
/// it stays zero.
struct FindPrescribed {
  ModelView m;
  PoseView pose;
  const double *turned, *factors;  ///< (constraints × 3); where the boundary goes
  double* local;
  FASCIA_HD void operator()(int k) const {
    const FrameConstraint& c = m.constraints[k];
    prescribed_increment(m.nodes.kind[c.node], c, m.fixed[c.node], m.motions, factors, m.rest_position[c.node],
                         pose.u[c.node], pose.D_of(c.node), turned + 3 * k, local + m.nodes.dof[c.node]);
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

/// Where a step ends, and what its scheme keeps of it.
struct StepEnd {
  Vec3d *u = nullptr, *v = nullptr;
  Mat3d *D = nullptr, *Q_dot = nullptr;
  double* turned = nullptr;  ///< as the step has it; of a midpoint step as its start has it
  PoseMotion *motion = nullptr, *velocity = nullptr, *acceleration = nullptr;  ///< none where they are not kept
  const PoseMotion* before = nullptr;  ///< motion in a step before of the same length, or none
};

/// Ends a step of a scheme that solves for the end.
struct FinishStep {
  StepView s;
  StepEnd end;

  FASCIA_HD void operator()(int i) const {
    const StepNode n = s.node(i);
    const PoseMotion x = motion_of(n);
    end.u[i] = s.u[i];
    Mat3d D = s.D_now(i);
    if (n.rigid()) D = orthonormalized_increment(D);
    EndRates rates;
    if (s.step.h > 0) rates = rates_at_end(s.step, n, D);
    const FrameConstraint* held = s.model.held(i);
    if (s.step.h > 0 && held != nullptr && s.step.scheme == TimeScheme::newmark)
      follow_boundary(s.step, n.kind, *held, n.inertia, x, end.before != nullptr ? end.before[i] : x, D, rates);
    end.v[i] = rates.v.u;
    if (s.turning) {
      end.D[i] = D;
      end.Q_dot[i] = rates.v.Q;
    }
    if (end.motion != nullptr) end.motion[i] = x;
    if (end.velocity != nullptr) end.velocity[i] = n.v;
    if (end.acceleration != nullptr) end.acceleration[i] = rates.a;
  }
};

/// Ends a midpoint step, without what is prescribed.
struct FinishMiddle {
  StepView s;
  StepEnd end;

  FASCIA_HD void operator()(int i) const {
    const StepNode n = s.node(i);
    const int c = s.model.constraint[i];
    const MiddleEnd middle = finish_middle(s.step, n, s.model.held(i), s.D_now(i));
    end.motion[i] = middle.motion;
    end.velocity[i] = n.v;
    end.u[i] = s.u0[i] + middle.motion.u;
    end.v[i] = middle.v.u;
    if (s.turning) {
      end.D[i] = n.D + middle.motion.Q;
      end.Q_dot[i] = middle.v.Q;
    }
    for (int a = 0; c >= 0 && a < 3; ++a) end.turned[3 * c + a] = 2 * s.turned[3 * c + a] - end.turned[3 * c + a];
  }
};

/// Moves what is prescribed onto its target at the end of a midpoint step, makes rotations orthogonal, and gives what
/// is prescribed the velocity of its motion.
struct FinishHeld {
  StepView s;
  StepEnd end;

  FASCIA_HD void operator()(int i) const {
    const ModelView& m = s.model;
    const FrameKind kind = m.nodes.kind[i];
    const int k = m.constraint[i];
    Mat3d D = s.turning ? end.D[i] : Mat3d{};
    if (k >= 0) {
      const FrameConstraint& c = m.constraints[k];
      double d[kMostDofs] = {};
      double* turned = end.turned + 3 * k;
      prescribed_increment(kind, c, m.fixed[i], m.motions, m.factors, m.rest_position[i], end.u[i], D, turned, d);
      m.to_global(i, d);
      Mat3d Ds;
      advance_increment(kind, d, 1, end.u[i], Ds);
      D = incremented(kind, Ds, D);
      if (kind == FrameKind::rigid) advance_turned(c, d, 1, turned);
      end.motion[i] = {end.u[i] - s.u0[i], D - s.D_at_start(i)};
    }
    if (kind == FrameKind::rigid) D = orthonormalized_increment(D);
    if (k >= 0) {
      const PoseMotion last = end.before != nullptr ? end.before[i] : end.motion[i];
      EndRates rates{{end.v[i], s.turning ? end.Q_dot[i] : Mat3d{}}, {}};
      follow_boundary(s.step, kind, m.constraints[k], m.inertia[i], end.motion[i], last, D, rates);
      end.v[i] = rates.v.u;
      if (s.turning) end.Q_dot[i] = rates.v.Q;
    }
    if (s.turning) end.D[i] = D;
  }
};

/// The end of a step. A midpoint step needs the factors of its end, and keeps motions and velocities.
template <class Space>
void finish_step(const Space& space, const StepView& s, const StepEnd& end) {
  const int n = s.model.nodes.count;
  if (s.step.h > 0 && s.step.scheme == TimeScheme::midpoint) {
    space.for_each(n, FinishMiddle{s, end});
    space.for_each(n, FinishHeld{s, end});
  } else {
    space.for_each(n, FinishStep{s, end});
  }
}

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
    free_mass_block(kind, m.inertia[i], Mat3d::identity() + D, m.turn_of(i), m.fixed[i], block);
    SmallFactor factor;
    if (factor.factorize(block, n))
      factor.solve(a);
    else
      for (int k = 0; k < n; ++k) a[k] = 0;
    m.to_global(i, a);
    acceleration[i] = acceleration_of(kind, a, D, s.rate_at_start(i));
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
    const PoseMotion v{s.v0[i], s.rate_at_start(i)};
    const InertiaForce in = inertia_of_velocity(kind, m.inertia[i], m.damping_of(i), s.D_now(i), v);
    add_node_force(kind, s.D_now(i), -in.force, in.moment * -1.0, {}, g);
    for (int k = 0; k < n; ++k) force[first + k] = g[k];
  }
};

/// Adds what accelerated supports carry of their own mass, and its damping.
struct SupportInertia {
  StepView s;  ///< of no length, which starts at the state
  const Vec3d* v_before;
  const Mat3d* rate_before;
  double inverse_dt;  ///< from those velocities to the present ones
  double* gradient;
  FASCIA_HD void operator()(int k) const {
    const ModelView& m = s.model;
    const int i = m.constraints[k].node;
    const Mat3d rate = s.rate_at_start(i);
    const Mat3d rate_change = s.turning ? (rate - rate_before[i]) * inverse_dt : Mat3d{};
    InertiaForce f = inertia_force(m.inertia[i], (s.v0[i] - v_before[i]) * inverse_dt, rate_change);
    if (const FrameInertia* damping = m.damping_of(i); damping != nullptr) {
      const InertiaForce drag = inertia_force(*damping, s.v0[i], rate);
      f.force += drag.force;
      f.moment += drag.moment;
    }
    add_node_force(m.nodes.kind[i], s.D_now(i), f.force, f.moment, {}, gradient + m.nodes.dof[i]);
  }
};

/// Adds what supports carry of their own mass that the accelerations of their nodes ask for. Goes over constraints.
struct HeldInertia {
  StepView s;
  const PoseMotion* acceleration;  ///< of each constraint: of its node's origin and Q or A
  double* gradient;
  FASCIA_HD void operator()(int k) const {
    const ModelView& m = s.model;
    const int i = m.constraints[k].node;
    const InertiaForce f = inertia_force(m.inertia[i], acceleration[k].u, acceleration[k].Q);
    add_node_force(m.nodes.kind[i], s.D_now(i), f.force, f.moment, {}, gradient + m.nodes.dof[i]);
  }
};

}  // namespace fascia::loops
