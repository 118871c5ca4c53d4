#include "core/solver/boundary_motion.hpp"

#include "core/math/rotation.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

Vec3d displacement(const Model& model, int motion, const Vec3d& X, std::span<const double> factors) {
  const PrescribedMotion& m = model.motions[at(motion)];
  return m.displacement(X, factors[at(m.schedule)]);
}

/// The prescribed entries of A of an affine frame, in constraint axes.
void prescribe_affine(const Model& model, const FrameConstraint& c, const Mat3d& D, std::span<const double> factors,
                      double* local) {
  const int motion = c.turning_motion();
  Mat3d target;
  if (motion >= 0) {
    const PrescribedMotion& m = model.motions[at(motion)];
    target = rotation_increment(m.axis * (m.angle * factors[at(m.schedule)]));
  }
  const Mat3d missing = times_transpose(c.rotation_axes * (target - D), c.rotation_axes);
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) local[3 * q + i] = missing(i, q);
}

}  // namespace

void prescribed_increments(const Model& model, const DofFilter& filter, const State& state,
                           std::span<const std::array<double, 3>> turned, std::span<const double> factors,
                           std::span<double> local) {
  std::fill(local.begin(), local.end(), 0.0);
  for (std::size_t k = 0; k < model.constraints.size(); ++k) {
    const FrameConstraint& c = model.constraints[k];
    const Vec3d& X = model.rest_position[at(c.node)];
    double* increment = local.data() + model.points.dofs.begin(c.node);
    for (int a = 0; a < c.translations; ++a) {
      const int motion = c.translation_motion[at(a)];
      const Vec3d target = motion < 0 ? Vec3d{} : displacement(model, motion, X, factors);
      increment[a] = dot(c.translation_axes.row(a), target - state.u[at(c.node)]);
    }
    if (model.kind(c.node) == FrameKind::affine && c.rotations > 0) {
      prescribe_affine(model, c, state.D[at(c.node)], factors, increment + 3);
      for (int q = 3; q < kMostDofs; ++q)
        if (!filter.is_fixed(at(model.points.dofs.begin(c.node) + q))) increment[q] = 0;
    }
    if (model.kind(c.node) != FrameKind::rigid) continue;
    for (int a = 0; a < c.rotations; ++a) {
      const int motion = c.rotation_motion[at(a)];
      if (motion < 0) continue;
      const PrescribedMotion& m = model.motions[at(motion)];
      const double turn = m.angle * factors[at(m.schedule)];
      increment[3 + a] = dot(c.rotation_axes.row(a), m.axis) * turn - turned[k][at(a)];
    }
  }
}

void move_state(const Model& model, std::span<const double> global, State& state) {
  for (int i = 0; i < model.node_count(); ++i) {
    const double* d = global.data() + model.points.dofs.begin(i);
    advance_increment(model.kind(i), d, 1, state.u[at(i)], state.D[at(i)]);
  }
  for (std::size_t k = 0; k < model.constraints.size(); ++k) {
    const FrameConstraint& c = model.constraints[k];
    if (model.kind(c.node) != FrameKind::rigid) continue;
    const double* d = global.data() + model.points.dofs.begin(c.node);
    advance_turned(c, d, 1, state.turned[k].data());
  }
}

void place_tethers(const Model& model, std::span<const double> factors, std::span<double> targets) {
  for (const Tether& t : model.tethers) {
    Vec3d target;
    if (t.motion >= 0) target = displacement(model, t.motion, t.X + t.arm, factors);
    if (t.motion >= 0 && squared_norm(t.arm) > 0) target -= displacement(model, t.motion, t.X, factors);
    const auto first = at(model.points.rule[at(t.group)].axes) * 3 * kGroupSize + at(t.lane);
    for (int k = 0; k < 3; ++k) targets[first + at(k) * kGroupSize] = target[k];
  }
}

double MechanicalSystem::largest_angle() const {
  double largest = 1;
  for (const PrescribedMotion& m : model_.motions) largest = std::max(largest, std::abs(m.angle));
  return largest;
}

bool MechanicalSystem::has_prescribed_increment() const {
  std::vector<double>& local = work_;
  prescribed_increments(model_, filter_, state_, increment_.turned, factors_, local);
  // Rounding of a target grows with the displacements and, for a turn, with the arm.
  double largest_u = 0;
  for (std::size_t i = 0; i < state_.u.size(); ++i)
    largest_u = std::max({largest_u, norm(state_.u[i]), norm(start_.u[i])});
  for (const FrameConstraint& c : model_.constraints)
    for (const int motion : c.translation_motion)
      if (motion >= 0)
        largest_u = std::max({largest_u, norm(model_.motions[at(motion)].translation),
                              model_.motions[at(motion)].angle != 0
                                  ? norm(model_.rest_position[at(c.node)] - model_.motions[at(motion)].center)
                                  : 0.0});
  const double angle = largest_angle();
  for (const FrameConstraint& c : model_.constraints) {
    const int first = model_.points.dofs.begin(c.node), size = model_.points.dofs.size(c.node);
    for (int k = 0; k < size; ++k)
      if (std::abs(local[at(first + k)]) > 1e-14 * (k < 3 ? largest_u : angle)) return true;
  }
  return false;
}

double MechanicalSystem::prescribed_rotation() const {
  std::vector<double> local(gradient_.size());
  prescribed_increments(model_, filter_, state_, increment_.turned, factors_, local);
  double largest = 0;
  // A turn of places, affine frames or tethers shows in no increment that tells it from a shorter one.
  const auto turn_of = [&](int motion) {
    if (motion < 0) return 0.0;
    const PrescribedMotion& m = model_.motions[at(motion)];
    return std::abs(m.angle * (factors_[at(m.schedule)] - reached_factors_[at(m.schedule)]));
  };
  for (const FrameConstraint& c : model_.constraints) {
    if (model_.kind(c.node) == FrameKind::rigid && c.rotations > 0)
      largest = std::max(largest, rotation_in(FrameKind::rigid, local.data() + model_.points.dofs.begin(c.node)));
    if (model_.kind(c.node) == FrameKind::affine && c.rotations > 0)
      largest = std::max(largest, turn_of(c.turning_motion()));
    for (const int motion : c.translation_motion) largest = std::max(largest, turn_of(motion));
  }
  for (const Tether& t : model_.tethers) largest = std::max(largest, turn_of(t.motion));
  return largest;
}

}  // namespace fascia
