#pragma once

#include "core/math/rotation.hpp"
#include "core/node/node_force.hpp"
#include "core/node/time_scheme.hpp"
#include "core/structure/inertia.hpp"
#include "core/structure/model.hpp"

/// An implicit step at one node, as functions of plain values: what the schemes of time_scheme.hpp predict, and the
/// inertia of the step. The end of a step is in node_finish.hpp.
namespace fascia {

/// A node in a step, whose unknown is the increment since the start: u = u₀ + du, Q = (I + Ds) Q₀, A = A₀ + Ds.
struct StepNode {
  FrameKind kind = FrameKind::vertex;
  FrameInertia inertia{};
  Mat3d D{};            ///< Q − I or A − I at the start
  PoseMotion v{};       ///< at the start
  Vec3d du{};           ///< [m]
  Mat3d Ds{};           ///< [-]
  PoseMotion q{}, w{};  ///< of the step's form

  FASCIA_HD bool rigid() const { return kind == FrameKind::rigid; }
};

/// D of an increment after D.
FASCIA_HD inline Mat3d incremented(FrameKind kind, const Mat3d& Ds, const Mat3d& D) {
  return kind == FrameKind::rigid ? compose_increments(Ds, D) : Ds + D;
}

/// x, the motion of the pose since the start of the step.
FASCIA_HD inline PoseMotion motion_of(FrameKind kind, const Vec3d& du, const Mat3d& Ds, const Mat3d& D) {
  return {du, kind == FrameKind::rigid ? Ds + Ds * D : Ds};
}
FASCIA_HD inline PoseMotion motion_of(const StepNode& node) { return motion_of(node.kind, node.du, node.Ds, node.D); }

/// Adds a multiple of a direction, d by degrees of freedom, to an increment.
FASCIA_HD inline void advance_increment(FrameKind kind, const double* d, double step, Vec3d& du, Mat3d& Ds) {
  du += Vec3d{{d[0], d[1], d[2]}} * step;
  if (kind == FrameKind::rigid)
    Ds = compose_increments(rotation_increment(Vec3d{{d[3], d[4], d[5]}} * step), Ds);
  else if (kind == FrameKind::affine)
    Ds += frame_variation(kind, d + 3, {}) * step;
}

/// Likewise to the rotations that a rigid frame has done about the axes of its constraint [rad].
FASCIA_HD inline void advance_turned(const FrameConstraint& c, const double* d, double step, double* turned) {
  for (int a = 0; a < c.rotations; ++a) turned[a] += step * dot(c.rotation_axes.row(a), Vec3d{{d[3], d[4], d[5]}});
}

/// Angle of a frame's increments d by degrees of freedom [rad]; of an affine one, the rotation that has an increment of
/// A of that size.
FASCIA_HD inline double rotation_in(FrameKind kind, const double* d) {
  double squared = 0;
  for (int k = 3; k < dof_count(kind); ++k) squared += d[k] * d[k];
  return std::sqrt(kind == FrameKind::rigid ? squared : 0.5 * squared);
}

/// Ds after a time at a constant velocity: rotations along arcs.
FASCIA_HD inline Mat3d increment_along(FrameKind kind, const Mat3d& D, const Mat3d& rate, double time) {
  if (kind != FrameKind::rigid) return rate * time;
  return rotation_increment(spin_of(rate, Mat3d::identity() + D) * time);
}

/// Where the velocity at the start leads: the displacement since then, in the midpoint rule of a frame's origin as its
/// q says, and D.
struct MovedNode {
  Vec3d du{};
  Mat3d D{};
};
FASCIA_HD inline MovedNode moved_by_velocity(const StepConstants& step, const StepNode& node, double time) {
  MovedNode moved{node.v.u * time, incremented(node.kind, increment_along(node.kind, node.D, node.v.Q, time), node.D)};
  if (step.scheme == TimeScheme::midpoint) moved.du -= node.q.u;
  return moved;
}

/// Motion and rates of the step before that a scheme keeps of a node; null where it has no use for them.
struct NodeMemory {
  const PoseMotion *motion = nullptr, *velocity = nullptr, *acceleration = nullptr;
};

/// Sets q and w of a node. A rotation moves along an arc: where the equations hold, its second derivative must be that
/// of the arc to second order also in directions in which a rotation cannot give way, since they feel the inertia too.
FASCIA_HD inline void predict(const StepConstants& step, const NodeMemory& memory, StepNode& node) {
  const double h = step.h;
  const PoseMotion& v = node.v;
  const Mat3d Q = Mat3d::identity() + node.D;
  node.q = {};
  node.w = v;
  switch (step.scheme) {
    case TimeScheme::implicit_euler:
      return;
    case TimeScheme::bdf2: {
      const double c = step.memory_factor();
      node.q = *memory.motion * c;
      node.w = v + (v - *memory.velocity) * c;
      return;
    }
    case TimeScheme::newmark: {
      const PoseMotion& a = *memory.acceleration;
      node.q = v * h;
      node.w = v + a * h;
      if (!node.rigid()) return;
      const Mat3d W = skew(spin_of(v.Q, Q)), W_dot = skew(spin_of(a.Q, Q));
      node.w.Q -= ((W_dot * W + W * W_dot) * Q) * (h * h);
      return;
    }
    case TimeScheme::midpoint:
      if (!node.rigid()) return;
      // The mass centre goes straight, and the frame's origin around it.
      const Mat3d W = skew(spin_of(v.Q, Q));
      node.q.Q = (W * W * Q) * (-0.5 * h * h);
      if (node.inertia.mass > 0) node.q.u = (node.q.Q * node.inertia.first) * (-1 / node.inertia.mass);
      return;
  }
}

/// Takes from q its part along the prescribed axes (midpoint rule): what is prescribed goes straight too.
FASCIA_HD inline void straighten_held(const FrameConstraint& c, Vec3d& q) {
  for (int a = 0; a < c.translations; ++a) q -= c.translation_axes.row(a) * dot(c.translation_axes.row(a), q);
}

/// Inertia of the step at a node, |x − q − h w|² / (2 h²) + α |x − q|² / (2 h) in the pose form of inertia.hpp.
struct StepInertia {
  Vec3d force{};               ///< gradient with respect to u [N]
  Mat3d moment{};              ///< with respect to A [N m]
  double energy = 0;           ///< of the first term [J]
  double damping_energy = 0;   ///< of the second [J]
  double cancelled_force = 0;  ///< size of what cancels in it: the motion and what the old velocity predicts of it [N]
};

/// @param damping  inertia weighted with α; null: none
/// @param length   of the connected part, which compares rotations with displacements [m]
FASCIA_HD inline StepInertia step_inertia(const StepConstants& step, const StepNode& node, const FrameInertia* damping,
                                          double length) {
  const double scale = 1 / (step.h * step.h), damping_scale = 1 / step.h;
  const PoseMotion x = motion_of(node), rest = step.deviation(x, node.q, node.w);
  StepInertia out;
  InertiaForce f = inertia_force(node.inertia, rest.u, rest.Q);
  out.energy = 0.5 * scale * inertia_product(node.inertia, rest.u, rest.Q);
  out.force = f.force * scale;
  out.moment = f.moment * scale;
  if (damping != nullptr) {
    const PoseMotion path = x - node.q;
    f = inertia_force(*damping, path.u, path.Q);
    out.damping_energy = 0.5 * damping_scale * inertia_product(*damping, path.u, path.Q);
    out.force += f.force * damping_scale;
    out.moment += f.moment * damping_scale;
  }
  const double cancelled = norm(x.u) + step.reach * norm(node.v.u) + length * (norm(x.Q) + step.reach * norm(node.v.Q));
  out.cancelled_force = scale * node.inertia.mass * cancelled;
  return out;
}

/// Inertia of the step at a node that is a point mass (no rotation).
/// @param damping  α m [kg/s]
FASCIA_HD inline StepInertia step_inertia(const StepConstants& step, double mass, double damping, const Vec3d& du,
                                          const Vec3d& q, const Vec3d& w, const Vec3d& v) {
  const double scale = mass / (step.h * step.h);
  const Vec3d path = du - q, rest = path - w * step.h;
  StepInertia out;
  out.force = rest * scale;
  out.energy = 0.5 * scale * squared_norm(rest);
  if (damping != 0) {
    const double damping_scale = damping / step.h;
    out.damping_energy = 0.5 * damping_scale * squared_norm(path);
    out.force += path * damping_scale;
  }
  out.cancelled_force = scale * (norm(du) + step.reach * norm(v));
  return out;
}

/// Adds the second derivative of the inertia of the step to the node's own block. Of a rigid frame the part that the
/// moment makes only where `full`.
/// @param Q  present I + D
FASCIA_HD inline void add_step_inertia_block(const StepConstants& step, const StepNode& node,
                                             const FrameInertia* damping, const Mat3d& Q, bool full, double* block) {
  const double scale = 1 / (step.h * step.h), damping_scale = 1 / step.h;
  FrameInertia total = node.inertia;
  total *= scale;
  if (damping != nullptr) {
    FrameInertia scaled = *damping;
    scaled *= damping_scale;
    total += scaled;
  }
  add_inertia_block(node.kind, total, Q, block);
  if (!full || !node.rigid()) return;
  const Mat3d moment = step_inertia(step, node, damping, 0).moment;
  add_rotation_block(block, rotation_tangent(times_transpose(moment, Q)));
}

}  // namespace fascia
