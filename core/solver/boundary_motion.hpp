#pragma once

#include "core/node/dof_filter.hpp"
#include "core/structure/model.hpp"

#include <array>
#include <span>
#include <vector>

namespace fascia {

/// The prescribed entries of A − I of an affine frame, in constraint axes. @param local  (9), by columns
FASCIA_HD inline void prescribed_affine(const FrameConstraint& c, const PrescribedMotion* motions,
                                        const double* factors, const Mat3d& D, double* local) {
  const int motion = c.turning_motion();
  Mat3d target;
  if (motion >= 0) {
    const PrescribedMotion& m = motions[motion];
    target = rotation_increment(m.axis * (m.angle * factors[m.schedule]));
  }
  const Mat3d missing = times_transpose(c.rotation_axes * (target - D), c.rotation_axes);
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) local[3 * q + i] = missing(i, q);
}

/// What the prescribed degrees of freedom of a node still lack to where boundary motions take them, in constraint axes.
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
    local[3 + a] = dot(c.rotation_axes.row(a), m.axis) * (m.angle * factors[m.schedule]) - turned[a];
  }
}

/// What the prescribed degrees of freedom still lack to where boundary motions take them, in constraint axes; zero in
/// the free ones. Vertices have no rotations to hold.
/// @param turned  as in State
void prescribed_increments(const Model& model, const DofFilter& filter, const State& state,
                           std::span<const std::array<double, 3>> turned, std::span<const double> factors,
                           std::span<double> local);

/// Sizes that rounding of prescribed increments is judged by: of displacements [m] and of rotations [rad], as far as
/// the model's boundary motions say.
struct MotionSizes {
  double displacement = 0, angle = 1;
};
MotionSizes motion_sizes(const Model& model);

/// Largest rotation [rad] by which a boundary motion would turn a frame.
/// @param turned  as in State, now
/// @param reached  factors at the end of the last step
double prescribed_rotation(const Model& model, std::span<const std::array<double, 3>> turned,
                           std::span<const double> factors, std::span<const double> reached);

/// Moves a state by increments of its degrees of freedom: u + du, exp(dr) Q, A + dA, and counts turns about held axes.
/// @param global  in world axes
void move_state(const Model& model, std::span<const double> global, State& state);

/// Takes from the velocities of a state what constraints hold still. What motions move keeps its own.
void stop_held(const Model& model, State& state);

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
/// The same of all: as CpuExecutor::targets().
void place_tethers(const Model& model, std::span<const double> factors, std::span<double> targets);

}  // namespace fascia
