#pragma once

#include "core/node/node_inertia.hpp"
#include "core/node/node_step.hpp"

/// From the solved equations of a step to the end of it, at one node; and the acceleration that Newmark starts from.
namespace fascia {

/// Velocity at the end of a step, and Newmark's acceleration.
struct EndRates {
  PoseMotion v{}, a{};
};

/// Rates of a node at the end of a step, by a scheme that solves for the end. @param D  at the end
FASCIA_HD inline EndRates rates_at_end(const StepConstants& step, const StepNode& node, const Mat3d& D) {
  const PoseMotion x = motion_of(node);
  EndRates out;
  out.v = (x - node.q) * (1 / step.h);
  if (step.scheme != TimeScheme::newmark) return out;
  out.a = step.deviation(x, node.q, node.w) * (1 / (step.h * step.h));
  if (!node.rigid()) return out;
  const Mat3d Q = Mat3d::identity() + D, W = skew(spin_of(out.v.Q, Q));
  out.v.Q = W * Q;
  out.a.Q = (skew(spin_of(out.a.Q, Q)) + W * W) * Q;
  return out;
}

/// True where inertia couples the rotations that a constraint leads with nothing that is free: they are about
/// principal axes through the mass centre.
FASCIA_HD inline bool leads_principal_axes(const FrameConstraint& c, const FrameInertia& inertia, const Mat3d& Q) {
  constexpr double kNone = 1e-9;
  const double size = trace(inertia.second);
  if (squared_norm(inertia.first) > kNone * kNone * inertia.mass * size) return false;
  const Mat3d S = Q * times_transpose(inertia.second, Q);
  for (int a = 0; a < c.rotations; ++a)
    for (int b = c.rotations; b < 3 && c.rotation_motion[at(a)] >= 0; ++b)
      if (!(fabs(dot(c.rotation_axes.row(a), S * c.rotation_axes.row(b))) <= kNone * size)) return false;
  return true;
}

/// Replaces velocity and acceleration of what a constraint prescribes by differences of its motion: those that the
/// scheme would keep ring for ever after a boundary that starts at once. Rotations about one or two axes do so only
/// where that takes nothing from what is free; else they keep the scheme's, whose momentum about the free axes is
/// right.
/// @param x     motion of the node in the step, last that in the step before, of the same length
/// @param D     at the end
FASCIA_HD inline void follow_boundary(const StepConstants& step, FrameKind kind, const FrameConstraint& c,
                                      const FrameInertia& inertia, const PoseMotion& x, const PoseMotion& last,
                                      const Mat3d& D, EndRates& rates) {
  const double dt = step.step;
  const PoseMotion v = (x * 1.5 - last * 0.5) * (1 / dt), a = (x - last) * (1 / (dt * dt));
  for (int k = 0; k < c.translations; ++k) {
    const Vec3d axis = c.translation_axes.row(k);
    rates.v.u += axis * dot(axis, v.u - rates.v.u);
    rates.a.u += axis * dot(axis, a.u - rates.a.u);
  }
  if (kind == FrameKind::affine && c.whole) {
    rates.v.Q = v.Q;
    rates.a.Q = a.Q;
  }
  if (kind != FrameKind::rigid || c.rotations == 0) return;
  const Mat3d Q = Mat3d::identity() + D;
  if (c.rotations < 3 && !leads_principal_axes(c, inertia, Q)) return;
  const Vec3d spin = spin_of(x.Q * (1 / dt), Q), spin_before = spin_of(last.Q * (1 / dt), Q - x.Q);  // means
  Vec3d w = spin * 1.5 - spin_before * 0.5, alpha = (spin - spin_before) * (1 / dt);
  if (c.rotations < 3) {
    const Vec3d own = spin_of(rates.v.Q, Q), own_rate = spin_of(rates.a.Q, Q);
    Vec3d led = own, led_rate = own_rate;
    for (int k = 0; k < c.rotations; ++k) {
      if (c.rotation_motion[at(k)] < 0) continue;
      const Vec3d axis = c.rotation_axes.row(k);
      led += axis * dot(axis, w - own);
      led_rate += axis * dot(axis, alpha - own_rate);
    }
    w = led;
    alpha = led_rate;
  }
  const Mat3d W = skew(w);
  rates.v.Q = W * Q;
  rates.a.Q = (skew(alpha) + W * W) * Q;
}

/// Motion in a whole midpoint step and velocity at its end.
struct MiddleEnd {
  PoseMotion motion{}, v{};
};

/// Finishes a midpoint step of a rigid frame: Q turns by the same rotation again, and the mass centre goes on straight.
/// The momentum is kept exactly, L₊ = L + dt τ with the torque in the middle of the step: about the mass centre, or of
/// a held frame about its origin and its free axes.
/// @param end  of a node whose motion and velocity go on straight
FASCIA_HD inline void finish_middle_of_frame(const StepConstants& step, const StepNode& node,
                                             const FrameConstraint* held, const Mat3d& D_middle, MiddleEnd& end) {
  const double h = step.h;
  const FrameInertia& inertia = node.inertia;
  const PoseMotion x = motion_of(node);
  const Mat3d twice = compose_increments(node.Ds, node.Ds), Q = Mat3d::identity() + node.D;
  end.motion.Q = twice + twice * node.D;
  const Mat3d Q_middle = Mat3d::identity() + D_middle, Q_end = Q + end.motion.Q;
  const PoseMotion rest = step.deviation(x, node.q, node.w) * (1 / (h * h));
  const Vec3d spin = spin_of(node.v.Q, Q);
  const Vec3d center = inertia.mass > 0 ? inertia.first * (1 / inertia.mass) : Vec3d{};
  const InertiaForce f = inertia_force(inertia, rest.u, rest.Q);
  Vec3d spin_end = rotation_vector(node.Ds) * (2 / h) - spin;
  if (held == nullptr) {
    const SpinInertia turning(inertia);
    const Vec3d torque = axl(Q_middle * transpose(f.moment)) - cross(Q_middle * center, f.force);
    if (turning.regular) spin_end = turning.spin(Q_end, turning.momentum(Q, spin) + torque * step.step);
  } else if (const SpinInertia turning(inertia.second); turning.regular) {
    const Mat3d& R = held->rotation_axes;
    const Vec3d torque = axl(Q_middle * transpose(rest.Q * inertia.second));
    Vec3d momentum = R * (turning.momentum(Q, spin) + torque * step.step);
    Mat3d local = times_transpose(R * times_transpose(Q_end * turning.rest, Q_end), R);
    for (int a = 0; a < held->rotations; ++a) {
      momentum[a] = dot(R.row(a), spin_end);
      for (int k = 0; k < 3; ++k) local(a, k) = a == k ? 1 : 0;
    }
    spin_end = transpose(R) * (inverse(local) * momentum);
  }
  end.v.Q = skew(spin_end) * Q_end;
  if (!(inertia.mass > 0)) return;
  const Vec3d kept = end.v.u;
  end.motion.u = (x.u + x.Q * center) * 2 - end.motion.Q * center;
  end.v.u = node.v.u + node.v.Q * center + f.force * (step.step / inertia.mass) - end.v.Q * center;
  for (int a = 0; held != nullptr && a < held->translations; ++a) {
    const Vec3d axis = held->translation_axes.row(a);
    end.v.u += axis * dot(axis, kept - end.v.u);
  }
}

/// From the middle of the step to its end.
/// @param held      null: nothing holds the node
/// @param D_middle  present D
FASCIA_HD inline MiddleEnd finish_middle(const StepConstants& step, const StepNode& node, const FrameConstraint* held,
                                         const Mat3d& D_middle) {
  const PoseMotion x = motion_of(node);
  MiddleEnd end{x * 2, x * (2 / step.h) - node.v};
  if (node.rigid()) finish_middle_of_frame(step, node, held, D_middle, end);
  return end;
}

/// Force that a node's velocity asks for before any acceleration: turning of rigid frames, mass damping.
/// @param D  Q − I or A − I, v its velocity
/// @param damping  inertia weighted with α; null: none
FASCIA_HD inline InertiaForce inertia_of_velocity(FrameKind kind, const FrameInertia& inertia,
                                                  const FrameInertia* damping, const Mat3d& D, const PoseMotion& v) {
  InertiaForce f;
  if (kind == FrameKind::rigid) {
    const Mat3d Q = Mat3d::identity() + D, W = skew(spin_of(v.Q, Q));
    f = inertia_force(inertia, {}, W * W * Q);
  }
  if (damping != nullptr) {
    const InertiaForce more = inertia_force(*damping, v.u, v.Q);
    f.force += more.force;
    f.moment += more.moment;
  }
  return f;
}

/// Acceleration of the pose of accelerations by degrees of freedom. @param rate  dQ/dt or dA/dt
FASCIA_HD inline PoseMotion acceleration_of(FrameKind kind, const double* a, const Mat3d& D, const Mat3d& rate) {
  const Mat3d Q = Mat3d::identity() + D;
  PoseMotion out{Vec3d{{a[0], a[1], a[2]}}, frame_variation(kind, a + 3, Q)};
  if (kind == FrameKind::rigid) {
    const Mat3d W = skew(spin_of(rate, Q));
    out.Q += W * W * Q;
  }
  return out;
}

}  // namespace fascia
