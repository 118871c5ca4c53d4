#pragma once

#include "core/structure/model.hpp"

/// Boundary motions at one node or tether, as functions of plain values.
namespace fascia {

/// The prescribed entries of A − I of an affine frame, in constraint axes. @param local  (9), by columns
FASCIA_HD inline void prescribed_affine(const FrameConstraint& c, const PrescribedMotion* motions,
                                        const double* factors, const Mat3d& D, double* local) {
  const int motion = c.turning_motion();
  Mat3d target;
  if (motion >= 0) target = motions[motion].turn(factors[motions[motion].schedule]);
  const Mat3d missing = times_transpose(c.rotation_axes * (target - D), c.rotation_axes);
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) local[3 * q + i] = missing(i, q);
}

/// Finds what the prescribed degrees of freedom of a node still lack to where boundary motions take them, in constraint
/// axes.
/// @param fixed   bit k: the degree of freedom k is fixed
/// @param turned  rotation done about the constraint's axes [rad] (3)
/// @param local   entries of the node; only those that may be prescribed are written
FASCIA_HD inline void prescribed_increment(FrameKind kind, const FrameConstraint& c, unsigned fixed,
                                           const PrescribedMotion* motions, const double* factors, const Vec3d& X,
                                           const Vec3d& u, const Mat3d& D, const double* turned, double* local) {
  for (int a = 0; a < c.translations; ++a) {
    const int motion = c.translation_motion[at(a)];
    Vec3d target;
    if (motion >= 0) target = motions[motion].displacement(X, factors[motions[motion].schedule]);
    local[a] = dot(c.translation_axes.row(a), target - u);
  }
  if (kind == FrameKind::affine && c.rotations > 0) {
    prescribed_affine(c, motions, factors, D, local + 3);
    for (int q = 3; q < kMostDofs; ++q)
      if ((fixed >> q & 1U) == 0) local[q] = 0;
  }
  for (int a = 0; kind == FrameKind::rigid && a < c.rotations; ++a) {
    const int motion = c.rotation_motion[at(a)];
    if (motion < 0) continue;
    const PrescribedMotion& m = motions[motion];
    if (m.driven) {
      const Mat3d left = compose_increments(m.turn(factors[m.schedule]), transpose(D));
      local[3 + a] = dot(c.rotation_axes.row(a), rotation_vector(left));
      continue;
    }
    local[3 + a] = dot(c.rotation_axes.row(a), m.axis) * (m.angle * factors[m.schedule]) - turned[a];
  }
}

/// Where a tether pulls to, relative to its place at rest.
FASCIA_HD inline Vec3d tether_target(const Tether& t, const PrescribedMotion* motions, const double* factors) {
  if (t.motion < 0) return {};
  const PrescribedMotion& m = motions[t.motion];
  const Vec3d target = m.displacement(t.X + t.arm, factors[m.schedule]);
  return squared_norm(t.arm) > 0 ? target - m.displacement(t.X, factors[m.schedule]) : target;
}
/// Adds to the target of one tether, in the layout of CpuExecutor::targets().
FASCIA_HD inline void move_target(const Tether& t, int axes, const Vec3d& by, double* targets) {
  for (int k = 0; k < 3; ++k) targets[at(axes * 3 + k) * kGroupSize + at(t.lane)] += by[k];
}

}  // namespace fascia
