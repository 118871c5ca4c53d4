#pragma once

#include "core/node/node_kick.hpp"

#include <cmath>

/// How one node moves on in a step of central differences, and what that gives to the run's energies.
namespace fascia {

/// Energies that a step gathers from the nodes that it moves.
struct ExplicitSums {
  double kinetic = 0;  ///< of those that nothing holds, at the half step [J]
  double work = 0;     ///< of loads and boundaries in the step [J]
};

/// Moves u and D by a step of the velocity w. @param node  with D before; @param load  by degrees of freedom
/// @param turned  of the constraint that holds the node
FASCIA_HD inline void drift(const ExplicitNode& node, const HalfStepVelocity& w, double dt, const double* load,
                            Vec3d& u, Mat3d& D, double* turned, ExplicitSums& sums) {
  const FrameInertia& inertia = *node.inertia;
  const bool held = node.held != nullptr;
  Vec3d du = w.v * dt, rotation;
  double work = 0;
  switch (node.kind) {
    case FrameKind::vertex:
      if (!held) sums.kinetic += 0.5 * inertia.mass * squared_norm(w.v);
      break;
    case FrameKind::rigid: {
      Vec3d spin = w.spin;
      if (!held) {
        const Mat3d Q = Mat3d::identity() + node.D;
        const Vec3d first = node.turning->spin(Q, w.spin);
        spin = node.turning->spin(Q + rotation_increment(first * (0.5 * dt)) * Q, w.spin);
        sums.kinetic += 0.5 * (inertia.mass * squared_norm(w.v) + dot(w.spin, spin));
      }
      rotation = spin * dt;
      D = orthonormalized_increment(compose_increments(rotation_increment(rotation), node.D));
      if (!held) du -= (D - node.D) * node.center;
      for (int k = 0; k < 3; ++k) work += load[3 + k] * rotation[k];
      break;
    }
    case FrameKind::affine:
      if (!held) sums.kinetic += 0.5 * inertia_product(inertia, w.v, w.rate);
      D = node.D + w.rate * dt;
      for (int k = 0; k < 9; ++k) work += load[3 + k] * w.rate(k % 3, k / 3) * dt;
      break;
  }
  u += du;
  for (int k = 0; k < 3; ++k) work += load[k] * du[k];
  sums.work += work;
  if (!held || node.kind != FrameKind::rigid) return;
  for (int k = 0; k < node.held->rotations; ++k) turned[k] += dot(node.held->rotation_axes.row(k), rotation);
}

/// The boundary overcomes the force on what it moves, in the mean of both ends of a step.
/// @param force            all that acts on the node; turned into constraint axes
/// @param last_increments  prescribed in the step before; takes those of this one
FASCIA_HD inline void add_boundary_work(const ExplicitNode& node, double* force, double* last_increments,
                                        ExplicitSums& sums) {
  turn_dofs(node.kind, node.held->translation_axes, node.held->rotation_axes, false, force);
  for (int k = 0; k < dof_count(node.kind); ++k) {
    sums.work -= 0.5 * force[k] * (last_increments[k] + node.increments[k]);
    last_increments[k] = node.increments[k];
  }
}

/// The whole step of a vertex that nothing holds. @param force  all that acts on it
FASCIA_HD inline void step_free_vertex(double damping, double mass, const Vec3d& load, const Vec3d& force,
                                       const LeapTimes& times, Vec3d& u, Vec3d& v, ExplicitSums& sums) {
  const Vec3d next = kicked_vertex(damping, mass, v, force, times.kick);  // read back from v, it would wait for it
  v = next;
  u += next * times.drift;
  sums.kinetic += 0.5 * mass * squared_norm(next);
  sums.work += dot(load, next) * times.drift;
}

/// dx/dt and dQ/dt of a node from its velocity, and back.
FASCIA_HD inline PoseMotion pose_velocity(const ExplicitNode& node, const HalfStepVelocity& w) {
  if (node.kind != FrameKind::rigid) return {w.v, w.rate};
  const Mat3d Q = Mat3d::identity() + node.D;
  if (node.held != nullptr) return {w.v, skew(w.spin) * Q};
  const Mat3d Q_dot = skew(node.turning->spin(Q, w.spin)) * Q;
  return {w.v - Q_dot * node.center, Q_dot};
}
FASCIA_HD inline HalfStepVelocity velocity_of(const ExplicitNode& node, const PoseMotion& motion) {
  if (node.kind != FrameKind::rigid) return {motion.u, {}, motion.Q};
  const Mat3d Q = Mat3d::identity() + node.D;
  const Vec3d spin = spin_of(motion.Q, Q);
  if (node.held != nullptr) return {motion.u, spin, {}};
  return {motion.u + motion.Q * node.center, node.turning->momentum(Q, spin), {}};
}

/// Takes off the mass damping of a host beyond α times its inertia. @param uneven  that damping
FASCIA_HD inline void add_uneven_damping(const ExplicitNode& node, const FrameInertia& uneven,
                                         const HalfStepVelocity& w, double* force) {
  const PoseMotion v = pose_velocity(node, w);
  const InertiaForce drag = inertia_force(uneven, v.u, v.Q);
  add_node_force(node.kind, node.D, -drag.force, drag.moment * -1.0, {}, force);
}

/// The kinetic energy is finite and within what was given [J], with room for rounding and for coarse steps.
FASCIA_HD inline bool is_sound_energy(double kinetic, double given) {
  constexpr double kRoom = 10;
  return std::isfinite(kinetic) && kinetic <= kRoom * given;
}

}  // namespace fascia
