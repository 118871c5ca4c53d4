#include "core/math/rotation.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>

/// The part of MechanicalSystem that follows boundary motions.
namespace fascia {

/// The prescribed entries of A of an affine frame, in constraint axes.
void MechanicalSystem::prescribe_affine(const FrameConstraint& c, double* local) const {
  const int motion = c.turning_motion();
  Mat3d target;
  if (motion >= 0) {
    const PrescribedMotion& m = model_.motions[at(motion)];
    target = rotation_increment(m.axis * (m.angle * factors_[at(m.schedule)]));
  }
  const Mat3d missing = times_transpose(c.rotation_axes * (target - state_.D[at(c.node)]), c.rotation_axes);
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) local[3 * q + i] = missing(i, q);
}

void MechanicalSystem::prescribed_increments(std::span<double> local) const {
  std::fill(local.begin(), local.end(), 0.0);
  for (std::size_t k = 0; k < model_.constraints.size(); ++k) {
    const FrameConstraint& c = model_.constraints[k];
    const Vec3d& X = model_.rest_position[at(c.node)];
    double* increment = local.data() + model_.points.dofs.begin(c.node);
    for (int a = 0; a < c.translations; ++a) {
      const int motion = c.translation_motion[at(a)];
      const Vec3d target = motion < 0 ? Vec3d{} : displacement(motion, X);
      increment[a] = dot(c.translation_axes.row(a), target - state_.u[at(c.node)]);
    }
    if (!rigid(at(c.node))) {
      if (c.rotations > 0) prescribe_affine(c, increment + 3);
      continue;
    }
    for (int a = 0; a < c.rotations; ++a) {
      const int motion = c.rotation_motion[at(a)];
      if (motion < 0) continue;
      const PrescribedMotion& m = model_.motions[at(motion)];
      const double turn = m.angle * factors_[at(m.schedule)];
      increment[3 + a] = dot(c.rotation_axes.row(a), m.axis) * turn - increment_.turned[k][at(a)];
    }
  }
  filter_.keep_fixed(local);
}

double MechanicalSystem::largest_angle() const {
  double largest = 1;
  for (const PrescribedMotion& m : model_.motions) largest = std::max(largest, std::abs(m.angle));
  return largest;
}

bool MechanicalSystem::has_prescribed_increment() const {
  std::vector<double>& local = work_;
  prescribed_increments(local);
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
  prescribed_increments(local);
  double largest = 0;
  // A turn of places, affine frames or tethers shows in no increment that tells it from a shorter one.
  const auto turn_of = [&](int motion) {
    if (motion < 0) return 0.0;
    const PrescribedMotion& m = model_.motions[at(motion)];
    return std::abs(m.angle * (factors_[at(m.schedule)] - reached_factors_[at(m.schedule)]));
  };
  for (const FrameConstraint& c : model_.constraints) {
    if (c.rotations > 0)
      largest = std::max(largest, rigid(at(c.node)) ? rotation_in(c.node, local.data()) : turn_of(c.turning_motion()));
    for (const int motion : c.translation_motion) largest = std::max(largest, turn_of(motion));
  }
  for (const Tether& t : model_.tethers) largest = std::max(largest, turn_of(t.motion));
  return largest;
}

}  // namespace fascia
