#include "core/solver/boundary_motion.hpp"

#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/node/node_force.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

MotionSizes motion_sizes(const Model& model) {
  MotionSizes sizes;
  for (const PrescribedMotion& m : model.motions) sizes.angle = std::max(sizes.angle, std::abs(m.angle));
  for (const FrameConstraint& c : model.constraints)
    for (const int motion : c.translation_motion) {
      if (motion < 0) continue;
      const PrescribedMotion& m = model.motions[at(motion)];
      const double arm = m.angle != 0 ? norm(model.rest_position[at(c.node)] - m.center) : 0.0;
      sizes.displacement = std::max({sizes.displacement, norm(m.translation), arm});
    }
  return sizes;
}

double prescribed_rotation(const Model& model, std::span<const std::array<double, 3>> turned,
                           std::span<const double> factors, std::span<const double> reached) {
  double largest = 0;
  // A turn of places, affine frames or tethers shows in no increment that tells it from a shorter one.
  const auto turn_of = [&](int motion) {
    if (motion < 0) return 0.0;
    const PrescribedMotion& m = model.motions[at(motion)];
    return std::abs(m.angle * (factors[at(m.schedule)] - reached[at(m.schedule)]));
  };
  for (std::size_t k = 0; k < model.constraints.size(); ++k) {
    const FrameConstraint& c = model.constraints[k];
    const int turning = c.turning_motion();
    if (turning >= 0 && model.motions[at(turning)].driven) {
      largest = std::max(largest, turn_of(turning));
    } else if (model.kind(c.node) == FrameKind::rigid && c.rotations > 0) {
      double local[kMostDofs] = {};
      prescribed_increment(FrameKind::rigid, c, 0, model.motions.data(), factors.data(), {}, {}, {}, turned[k].data(),
                           local);
      largest = std::max(largest, std::hypot(local[3], local[4], local[5]));
    }
    if (model.kind(c.node) == FrameKind::affine && c.rotations > 0) largest = std::max(largest, turn_of(turning));
    for (const int motion : c.translation_motion) largest = std::max(largest, turn_of(motion));
  }
  for (const Tether& t : model.tethers) largest = std::max(largest, turn_of(t.motion));
  return largest;
}

void start_driven(const Model& model, std::vector<double>& factors) {
  for (const PrescribedMotion& m : model.motions)
    if (m.driven) factors[at(m.schedule)] = 0;
}

std::vector<double> zero_factors(const Model& model) {
  int schedules = 0;
  for (const DeadLoad& l : model.loads) schedules = std::max(schedules, l.schedule + 1);
  for (const FollowerLoad& l : model.followers) schedules = std::max(schedules, l.schedule + 1);
  for (const SurfaceLoad& l : model.surfaces) schedules = std::max({schedules, l.schedule + 1, l.weight_schedule + 1});
  for (const PrescribedMotion& m : model.motions) schedules = std::max(schedules, m.schedule + 1);
  for (const int active : model.points.memory.schedule) schedules = std::max(schedules, active + 1);
  return std::vector<double>(at(schedules), 0.0);
}

void place_tethers(const Model& model, std::span<const double> factors, std::span<double> targets) {
  for (const Tether& t : model.tethers) {
    const Vec3d target = tether_target(t, model.motions.data(), factors.data());
    const auto first = at(model.points.rule[at(t.group)].axes) * 3 * kGroupSize + at(t.lane);
    for (int k = 0; k < 3; ++k) targets[first + at(k) * kGroupSize] = target[k];
  }
}

void stop_held(const Model& model, State& state) {
  for (const FrameConstraint& c : model.constraints) {
    const std::size_t i = at(c.node);
    for (int a = 0; a < c.translations; ++a) {
      const Vec3d axis = c.translation_axes.row(a);
      if (c.translation_motion[at(a)] < 0) state.v[i] -= axis * dot(axis, state.v[i]);
    }
    const Mat3d& R = c.rotation_axes;
    if (model.kind(c.node) == FrameKind::rigid) {
      const Mat3d Q = Mat3d::identity() + state.D[i];
      Vec3d spin = spin_of(state.Q_dot[i], Q);
      for (int a = 0; a < c.rotations; ++a)
        if (c.rotation_motion[at(a)] < 0) spin -= R.row(a) * dot(R.row(a), spin);
      state.Q_dot[i] = skew(spin) * Q;
    } else if (model.kind(c.node) == FrameKind::affine && c.turning_motion() < 0) {
      Mat3d rate = times_transpose(R * state.Q_dot[i], R);
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          if (c.whole || (a != b && 3 - a - b < c.rotations)) rate(a, b) = 0;
      state.Q_dot[i] = transpose(R) * rate * R;
    }
  }
}

}  // namespace fascia
