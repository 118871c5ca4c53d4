#pragma once

#include "core/math/rotation.hpp"
#include "core/node/node_force.hpp"
#include "core/node/node_inertia.hpp"
#include "core/node/small_factor.hpp"
#include "core/node/time_scheme.hpp"

/// Velocities of central differences at one node from one half step to the next, as functions of plain values
/// (explicit_dynamics.hpp has the scheme). How a node moves on with them is in node_drift.hpp.
namespace fascia {

/// Velocities at a half step. Rigid: of the mass centre and the momentum about it; where a constraint holds the frame,
/// of its origin and ω. Affine: of the origin and dA/dt.
struct HalfStepVelocity {
  Vec3d v{}, spin{};
  Mat3d rate{};

  friend FASCIA_HD HalfStepVelocity operator+(const HalfStepVelocity& a, const HalfStepVelocity& b) {
    return {a.v + b.v, a.spin + b.spin, a.rate + b.rate};
  }
  friend FASCIA_HD HalfStepVelocity operator-(const HalfStepVelocity& a, const HalfStepVelocity& b) {
    return {a.v - b.v, a.spin - b.spin, a.rate - b.rate};
  }
  friend FASCIA_HD HalfStepVelocity operator*(const HalfStepVelocity& a, double s) {
    return {a.v * s, a.spin * s, a.rate * s};
  }
};

/// Times about a whole step: from the half step before to the one after, and to the next whole step [s]. They differ
/// where steps are of unequal length.
struct LeapTimes {
  double kick = 0, drift = 0;

  FASCIA_HD static LeapTimes between(double before, double after) { return {0.5 * (before + after), after}; }
  /// How much of the velocity half a step later, of both, is in the velocity at the whole step.
  FASCIA_HD double share_of_later() const { return 1 - 0.5 * drift / kick; }
};

/// A node at a whole step.
struct ExplicitNode {
  FrameKind kind = FrameKind::vertex;
  double damping = 0;  ///< α / 2 times the kick
  const FrameInertia* inertia = nullptr;
  const SpinInertia* turning = nullptr;   ///< of free rigid frames
  const double* inverse_mass = nullptr;   ///< of free affine frames: (origin, axes)², by rows
  Vec3d center{};                         ///< c / m of free rigid frames [m]
  Mat3d D{};                              ///< Q − I or A − I
  const FrameConstraint* held = nullptr;  ///< null: free; the rest is of those that are held
  const DofTurn* turn = nullptr;          ///< null: the axes of the world
  unsigned fixed = 0;                     ///< bit k: the degree of freedom k is prescribed
  const double* increments = nullptr;     ///< prescribed ones of the next step, in constraint axes

  FASCIA_HD bool is_fixed(int k) const { return (fixed >> k & 1U) != 0; }
};

/// v₊ of a free vertex.
FASCIA_HD inline Vec3d kicked_vertex(double damping, double mass, const Vec3d& v, const Vec3d& force, double dt) {
  const double a = damping;
  return v * ((1 - a) / (1 + a)) + force * (dt / (1 + a) / mass);
}

FASCIA_HD inline HalfStepVelocity kicked_held_vertex(const ExplicitNode& node, const HalfStepVelocity& old,
                                                     const double* f, const LeapTimes& times) {
  const Mat3d& T = node.held->translation_axes;
  Vec3d next = T * kicked_vertex(node.damping, node.inertia->mass, old.v, Vec3d{{f[0], f[1], f[2]}}, times.kick);
  for (int k = 0; k < 3; ++k)
    if (node.is_fixed(k)) next[k] = node.increments[k] / times.drift;
  return {transpose(T) * next, {}, {}};
}

/// By degrees of freedom in constraint axes.
FASCIA_HD inline void held_entries(const ExplicitNode& node, const HalfStepVelocity& w, double* d) {
  for (int k = 0; k < 3; ++k) {
    d[k] = w.v[k];
    if (node.kind == FrameKind::rigid) d[3 + k] = w.spin[k];
  }
  for (int k = 0; k < 9 && node.kind == FrameKind::affine; ++k) d[3 + k] = w.rate(k % 3, k / 3);
  turn_dofs(node.kind, node.held->translation_axes, node.held->rotation_axes, false, d);
}

/// Solves M z = dt f of what is free, where z is known in what is not. Zero where M is singular.
/// @param mass   in constraint axes, n × n by rows
/// @param f, z   in constraint axes
FASCIA_HD inline void solve_free(const ExplicitNode& node, const SmallFactor& factor, bool regular, const double* mass,
                                 const double* f, double dt, double* z) {
  const int n = dof_count(node.kind);
  for (int k = 0; k < n; ++k) {
    if (node.is_fixed(k)) continue;
    double sum = dt * f[k];
    for (int j = 0; j < n; ++j)
      if (node.is_fixed(j)) sum -= mass[n * k + j] * z[j];
    z[k] = regular ? sum : 0.0;
  }
  if (regular) factor.solve(z);
}

/// In constraint axes: what is prescribed goes where it must, the rest follows M dw/dt + α M w = f − what turning
/// takes.
FASCIA_HD inline HalfStepVelocity kicked_held(const ExplicitNode& node, const HalfStepVelocity& velocity,
                                              const double* f, const LeapTimes& times) {
  const FrameKind kind = node.kind;
  if (kind == FrameKind::vertex) return kicked_held_vertex(node, velocity, f, times);
  const FrameConstraint& c = *node.held;
  const int n = dof_count(kind);
  const double a = node.damping;
  const Mat3d Q = Mat3d::identity() + node.D;
  double old[kMostDofs] = {}, local_f[kMostDofs] = {}, next[kMostDofs] = {};
  double block[kMostDofs * kMostDofs] = {}, local[kMostDofs * kMostDofs] = {};
  held_entries(node, velocity, old);
  free_mass_block(kind, *node.inertia, Q, node.turn, node.fixed, block);
  SmallFactor factor;
  const bool regular = factor.factorize(block, n);
  for (double& entry : block) entry = 0;
  add_inertia_block(kind, *node.inertia, Q, block);
  turn_block(kind, node.turn, kind, node.turn, block, local);
  HalfStepVelocity result;
  Vec3d spin = velocity.spin;
  for (int round = 0; round < (kind == FrameKind::rigid ? 2 : 1); ++round) {
    for (int k = 0; k < n; ++k) local_f[k] = f[k];
    if (kind == FrameKind::rigid) {
      const Mat3d W = skew(spin);
      const InertiaForce turning = inertia_force(*node.inertia, {}, W * W * Q);
      add_node_force(kind, node.D, -turning.force, turning.moment * -1.0, {}, local_f);
    }
    turn_dofs(kind, c.translation_axes, c.rotation_axes, false, local_f);
    // z = (1 + a) w₊ − (1 − a) w₋
    double z[kMostDofs] = {};
    for (int k = 0; k < n; ++k)
      if (node.is_fixed(k)) z[k] = (1 + a) * node.increments[k] / times.drift - (1 - a) * old[k];
    solve_free(node, factor, regular, local, local_f, times.kick, z);
    for (int k = 0; k < n; ++k)
      next[k] = node.is_fixed(k) ? node.increments[k] / times.drift : (z[k] + (1 - a) * old[k]) / (1 + a);
    turn_dofs(kind, c.translation_axes, c.rotation_axes, true, next);
    result.v = Vec3d{{next[0], next[1], next[2]}};
    if (kind == FrameKind::rigid) result.spin = Vec3d{{next[3], next[4], next[5]}};
    if (kind == FrameKind::affine) result.rate = frame_variation(kind, next + 3, {});
    spin = (velocity.spin + result.spin) * 0.5;
  }
  return result;
}

/// The velocity half a step later than the node. @param f  all that acts on it, by degrees of freedom
FASCIA_HD inline HalfStepVelocity kicked(const ExplicitNode& node, const HalfStepVelocity& old, const double* f,
                                         const LeapTimes& times) {
  if (node.held != nullptr) return kicked_held(node, old, f, times);
  const double a = node.damping, keep = (1 - a) / (1 + a), kick = times.kick / (1 + a), mass = node.inertia->mass;
  const Vec3d force{{f[0], f[1], f[2]}};
  HalfStepVelocity next;
  switch (node.kind) {
    case FrameKind::vertex:
      next.v = old.v * keep + force * (kick / mass);
      break;
    case FrameKind::rigid: {
      const Vec3d arm = node.center + node.D * node.center;
      if (mass > 0) next.v = old.v * keep + force * (kick / mass);
      next.spin = old.spin * keep + (Vec3d{{f[3], f[4], f[5]}} - cross(arm, force)) * kick;
      break;
    }
    case FrameKind::affine:
      next.v = old.v * keep;
      next.rate = old.rate * keep;
      for (int k = 0; k < 3; ++k) {
        const double row[4] = {f[k], f[3 + k], f[6 + k], f[9 + k]};
        for (int p = 0; p < 4; ++p) {
          double sum = 0;
          for (int q = 0; q < 4; ++q) sum += node.inverse_mass[4 * p + q] * row[q];
          (p == 0 ? next.v[k] : next.rate(k, p - 1)) += kick * sum;
        }
      }
      break;
  }
  return next;
}

/// The velocity half a step before the node that has the velocity `now`, at steps of equal length.
/// @param f  as above
FASCIA_HD inline HalfStepVelocity kicked_back(const ExplicitNode& node, const HalfStepVelocity& now, const double* f,
                                              double dt) {
  // Kicked from `now`: ((1 − a) v + dt f/m) / (1 + a), of which the half step back is (1 + a) v − dt f/(2 m).
  const double a = node.damping;
  return now * (1 + a) - (kicked(node, now, f, {dt, dt}) * (1 + a) - now * (1 - a)) * 0.5;
}

}  // namespace fascia
