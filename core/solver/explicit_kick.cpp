#include "core/math/rotation.hpp"
#include "core/solver/explicit_step.hpp"
#include "core/solver/node_force.hpp"

#include <algorithm>

/// Velocities of ExplicitStepper from one half step to the next.
namespace fascia {

ExplicitStepper::Velocity ExplicitStepper::kicked(int node, const double* f) const {
  if (constraint_[at(node)] >= 0) return kicked_held(node, f);
  const std::size_t i = at(node);
  const double a = damping_[i], keep = (1 - a) / (1 + a), kick = dt_ / (1 + a);
  const Velocity& old = velocity_[i];
  const Vec3d force{{f[0], f[1], f[2]}};
  Velocity next;
  switch (model_.kind(node)) {
    case FrameKind::vertex:
      next.v = old.v * keep + force * (kick / model_.inertia[i].mass);
      break;
    case FrameKind::rigid: {
      const Vec3d arm = center_[i] + state_.D[i] * center_[i];
      if (const double mass = model_.inertia[i].mass; mass > 0) next.v = old.v * keep + force * (kick / mass);
      next.spin = old.spin * keep + (Vec3d{{f[3], f[4], f[5]}} - cross(arm, force)) * kick;
      break;
    }
    case FrameKind::affine: {
      const std::array<double, 16>& inverse = inverse_mass_[at(affine_[i])];
      next.v = old.v * keep;
      next.rate = old.rate * keep;
      for (int k = 0; k < 3; ++k) {
        const double row[4] = {f[k], f[3 + k], f[6 + k], f[9 + k]};
        for (int p = 0; p < 4; ++p) {
          double sum = 0;
          for (int q = 0; q < 4; ++q) sum += inverse[at(4 * p + q)] * row[q];
          (p == 0 ? next.v[k] : next.rate(k, p - 1)) += kick * sum;
        }
      }
      break;
    }
  }
  return next;
}

/// In constraint axes: what is prescribed goes where it must, the rest follows M dw/dt + α M w = f − what turning
/// takes.
ExplicitStepper::Velocity ExplicitStepper::kicked_held(int node, const double* f) const {
  const std::size_t i = at(node);
  const FrameConstraint& c = model_.constraints[at(constraint_[i])];
  const FrameKind kind = model_.kind(node);
  if (kind == FrameKind::vertex) return {kicked_held_vertex(node, {{f[0], f[1], f[2]}}), {}, {}};
  const int n = model_.points.dofs.size(node), first = model_.points.dofs.begin(node);
  const double a = damping_[i];
  const Mat3d Q = Mat3d::identity() + state_.D[i];
  const auto entries_of = [&](const Velocity& w, double* d) {
    std::copy(w.v.v, w.v.v + 3, d);
    if (kind == FrameKind::rigid) std::copy(w.spin.v, w.spin.v + 3, d + 3);
    if (kind == FrameKind::affine)
      for (int k = 0; k < 9; ++k) d[3 + k] = w.rate(k % 3, k / 3);
    turn_dofs(kind, c.translation_axes, c.rotation_axes, false, d);
  };
  double old[kMostDofs] = {}, local_f[kMostDofs] = {}, next[kMostDofs] = {};
  std::array<double, kMostDofs * kMostDofs> mass{}, local{};
  entries_of(velocity_[i], old);
  add_inertia_block(kind, model_.inertia[i], Q, mass.data());
  filter_.rotate_block(node, node, mass.data(), local.data());
  SmallFactor factor;
  const bool regular = factor.factorize(free_mass_block(model_, filter_, node, Q).data(), n);
  Velocity result;
  Vec3d spin = velocity_[i].spin;
  for (int round = 0; round < (kind == FrameKind::rigid ? 2 : 1); ++round) {
    std::copy(f, f + n, local_f);
    if (kind == FrameKind::rigid) {
      const Mat3d W = skew(spin);
      const InertiaForce turning = inertia_force(model_.inertia[i], {}, W * W * Q);
      add_node_force(kind, state_.D[i], -turning.force, turning.moment * -1.0, {}, local_f);
    }
    turn_dofs(kind, c.translation_axes, c.rotation_axes, false, local_f);
    // z = (1 + a) w₊ − (1 − a) w₋
    double z[kMostDofs] = {};
    for (int k = 0; k < n; ++k)
      if (filter_.is_fixed(at(first + k))) z[k] = (1 + a) * increments_[at(first + k)] / dt_ - (1 - a) * old[k];
    for (int k = 0; k < n; ++k) {
      if (filter_.is_fixed(at(first + k))) continue;
      double sum = dt_ * local_f[k];
      for (int j = 0; j < n; ++j)
        if (filter_.is_fixed(at(first + j))) sum -= local[at(n * k + j)] * z[j];
      z[k] = regular ? sum : 0.0;
    }
    if (regular) factor.solve(z);
    for (int k = 0; k < n; ++k) {
      const bool fixed = filter_.is_fixed(at(first + k));
      next[k] = fixed ? increments_[at(first + k)] / dt_ : (z[k] + (1 - a) * old[k]) / (1 + a);
    }
    turn_dofs(kind, c.translation_axes, c.rotation_axes, true, next);
    result.v = Vec3d{{next[0], next[1], next[2]}};
    if (kind == FrameKind::rigid) result.spin = Vec3d{{next[3], next[4], next[5]}};
    if (kind == FrameKind::affine) result.rate = frame_variation(kind, next + 3, {});
    spin = (velocity_[i].spin + result.spin) * 0.5;
  }
  return result;
}

Vec3d ExplicitStepper::kicked_held_vertex(int node, const Vec3d& force) const {
  const std::size_t i = at(node);
  const Mat3d& T = model_.constraints[at(constraint_[i])].translation_axes;
  const double a = damping_[i];
  Vec3d next = T * (velocity_[i].v * ((1 - a) / (1 + a)) + force * (dt_ / (1 + a) / model_.inertia[i].mass));
  const auto first = at(model_.points.dofs.begin(node));
  for (int k = 0; k < 3; ++k)
    if (filter_.is_fixed(first + at(k))) next[k] = increments_[first + at(k)] / dt_;
  return transpose(T) * next;
}

}  // namespace fascia
