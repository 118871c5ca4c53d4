#include "core/math/rotation.hpp"
#include "core/physics/inertia.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/solver/node_force.hpp"
#include "core/solver/node_inertia.hpp"
#include "core/solver/small_factor.hpp"

#include <algorithm>

/// The part of MechanicalSystem in which time schemes differ.
namespace fascia {

void MechanicalSystem::begin_step(const State& start, double dt, TimeScheme scheme, const StepMemory& memory) {
  const std::size_t n = start.u.size();
  start_ = start;
  start_.turned.resize(model_.constraints.size());  // a state made before the constraints has none
  place_dependents(model_.points, start_);
  place_dependent_rates(model_.points, start_);
  increment_.du.assign(n, Vec3d{});
  increment_.Ds = start_.D;
  increment_.Ds.set_zero();
  increment_.turned = start_.turned;
  surfaces_.begin_step();
  form_.scheme = scheme;
  form_.step = form_.reach = form_.h = dt;
  if (scheme == TimeScheme::newmark || scheme == TimeScheme::midpoint) form_.h = 0.5 * dt;
  if (scheme == TimeScheme::midpoint) form_.reach = 0.5 * dt;
  if (scheme == TimeScheme::bdf2) form_.h = dt * (memory.step + dt) / (memory.step + 2 * dt);
  form_.q.assign(n, {});
  form_.w.assign(n, {});
  history_.inverse_step = 0;
  if (dt > 0) {
    for (std::size_t i = 0; i < n; ++i) predict_node(i, memory);
    if (scheme == TimeScheme::midpoint) {
      for (const FrameConstraint& c : model_.constraints) {
        Vec3d& q = form_.q[at(c.node)].u;
        for (int a = 0; a < c.translations; ++a) q -= c.translation_axes.row(a) * dot(c.translation_axes.row(a), q);
      }
    }
    if (model_.points.damped) predict_strain(memory);
  }
  rebuild_state();
}

/// q and w of a node. A rotation moves along an arc: where the equations hold, its second derivative must be that of
/// the arc to second order also in directions in which a rotation cannot give way, since they feel the inertia too.
void MechanicalSystem::predict_node(std::size_t i, const StepMemory& memory) {
  const double h = form_.h;
  PoseMotion &q = form_.q[i], &w = form_.w[i];
  const PoseMotion v{start_.v[i], start_.Q_dot[i]};
  const Mat3d Q = Mat3d::identity() + start_.D[i];
  switch (form_.scheme) {
    case TimeScheme::implicit_euler:
      w = v;
      return;
    case TimeScheme::bdf2: {
      const double r = form_.step / memory.step, c = r * r / (1 + 2 * r);
      q = memory.motion[i] * c;
      w = v + (v - memory.velocity[i]) * c;
      return;
    }
    case TimeScheme::newmark: {
      const PoseMotion& a = memory.acceleration[i];
      q = v * h;
      w = v + a * h;
      if (!rigid(i)) return;
      const Mat3d W = skew(spin_of(v.Q, Q)), W_dot = skew(spin_of(a.Q, Q));
      w.Q -= ((W_dot * W + W * W_dot) * Q) * (h * h);
      return;
    }
    case TimeScheme::midpoint:
      if (rigid(i)) {
        // The mass centre goes straight, and the frame's origin around it.
        const FrameInertia& inertia = model_.inertia[i];
        const Mat3d W = skew(spin_of(v.Q, Q));
        q.Q = (W * W * Q) * (-0.5 * h * h);
        if (inertia.mass > 0) q.u = (q.Q * inertia.first) * (-1 / inertia.mass);
      }
      w = v;
      return;
  }
}

/// Where the present velocities lead: rotations along arcs, origins of frames in the midpoint rule as their q says.
State MechanicalSystem::moved_by_velocity(double time) const {
  State moved = start_;
  for (std::size_t i = 0; i < moved.u.size(); ++i) {
    moved.u[i] += start_.v[i] * time;
    if (form_.scheme == TimeScheme::midpoint) moved.u[i] -= form_.q[i].u;
    const Vec3d spin = spin_of(start_.Q_dot[i], Mat3d::identity() + start_.D[i]);
    moved.D[i] = rigid(i) ? compose_increments(rotation_increment(spin * time), start_.D[i])
                          : start_.D[i] + start_.Q_dot[i] * time;
  }
  place_dependents(model_.points, moved);
  return moved;
}

/// Ê of the step. The rate and the second derivative of the strain come from strains along the velocity,
/// h dE/dt = (E(h) − E(−h)) / 2 and h² d²E/dt² = E(h) − 2 E + E(−h).
void MechanicalSystem::predict_strain(const StepMemory& memory) {
  history_.inverse_step = 1 / form_.h;
  executor_.store_strain(start_, history_);
  if (form_.scheme == TimeScheme::implicit_euler) return;
  AlignedVector<double>& E = history_.E;
  start_strain_ = E;
  if (form_.scheme == TimeScheme::bdf2) {
    const double r = form_.step / memory.step, c = r * r / (1 + 2 * r);
    for (std::size_t k = 0; k < E.size(); ++k) E[k] += c * (E[k] - memory.E[k]);
    return;
  }
  StrainHistory ahead, behind;
  executor_.store_strain(moved_by_velocity(form_.h), ahead);
  executor_.store_strain(moved_by_velocity(-form_.h), behind);
  const bool rate = form_.scheme == TimeScheme::newmark;
  for (std::size_t k = 0; k < E.size(); ++k)
    E[k] += rate ? 0.5 * (ahead.E[k] - behind.E[k]) : -0.5 * (ahead.E[k] - 2 * E[k] + behind.E[k]);
}

State MechanicalSystem::finish_step(double end_time, StepMemory& memory) {
  reached_factors_ = factors_;
  surfaces_.finish_step();
  reached_.reset();
  if (form_.scheme == TimeScheme::implicit_euler && !model_.has_frames()) reached_ = {state_.u, internal_.total()};
  const std::size_t n = start_.u.size();
  State end = state_;
  end.turned = increment_.turned;
  end.time = end_time;
  end.v.assign(n, Vec3d{});
  end.Q_dot = end.D;
  end.Q_dot.set_zero();
  const bool same_step = memory.step == form_.step && memory.motion.size() == n;
  const std::vector<PoseMotion> before = same_step ? std::move(memory.motion) : std::vector<PoseMotion>{};
  memory.motion.resize(n);
  for (std::size_t i = 0; i < n; ++i) memory.motion[i] = motion_of(i);
  if (form_.scheme == TimeScheme::midpoint) finish_middle(end, memory.motion);
  if (form_.scheme == TimeScheme::newmark) memory.acceleration.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (rigid(i)) end.D[i] = orthonormalized_increment(end.D[i]);
    if (form_.h <= 0 || form_.scheme == TimeScheme::midpoint) continue;
    const PoseMotion &x = memory.motion[i], v = (x - form_.q[i]) * (1 / form_.h);
    end.v[i] = v.u;
    end.Q_dot[i] = v.Q;
    if (form_.scheme != TimeScheme::newmark) continue;
    PoseMotion& a = memory.acceleration[i];
    a = form_.deviation(x, i) * (1 / (form_.h * form_.h));
    if (!rigid(i)) continue;
    const Mat3d Q = Mat3d::identity() + end.D[i], W = skew(spin_of(v.Q, Q));
    end.Q_dot[i] = W * Q;
    a.Q = (skew(spin_of(a.Q, Q)) + W * W) * Q;
  }
  const bool remembers = form_.h > 0 && form_.scheme != TimeScheme::implicit_euler;
  if (remembers && form_.scheme != TimeScheme::bdf2) follow_boundaries(end, before, memory);
  place_dependents(model_.points, end);
  place_dependent_rates(model_.points, end);
  if (!remembers) return end;
  memory.step = form_.step;
  memory.velocity.resize(n);
  for (std::size_t i = 0; i < n; ++i) memory.velocity[i] = {start_.v[i], start_.Q_dot[i]};
  if (history_.inverse_step > 0) memory.E = start_strain_;
  return end;
}

/// Velocity and acceleration of what is prescribed, by differences of its motion: those that the scheme would keep ring
/// for ever after a boundary that starts at once.
/// @param before  motion in the step before, of the same length; or empty
void MechanicalSystem::follow_boundaries(State& end, const std::vector<PoseMotion>& before, StepMemory& memory) const {
  const double dt = form_.step;
  for (const FrameConstraint& c : model_.constraints) {
    const std::size_t i = at(c.node);
    const PoseMotion& x = memory.motion[i];
    const Vec3d last = before.empty() ? x.u : before[i].u;
    const Vec3d v = (x.u * 1.5 - last * 0.5) * (1 / dt), a = (x.u - last) * (1 / (dt * dt));
    for (int k = 0; k < c.translations; ++k) {
      const Vec3d axis = c.translation_axes.row(k);
      end.v[i] += axis * dot(axis, v - end.v[i]);
      if (form_.scheme == TimeScheme::newmark) {
        Vec3d& kept = memory.acceleration[i].u;
        kept += axis * dot(axis, a - kept);
      }
    }
    if (!rigid(i) || c.rotations < 3) continue;
    const Mat3d Q = Mat3d::identity() + end.D[i], W = skew(spin_of(x.Q * (1 / dt), Q));
    end.Q_dot[i] = W * Q;
    if (form_.scheme == TimeScheme::newmark) memory.acceleration[i].Q = W * W * Q;
  }
}

/// From the middle of the step to its end. @param motion  of the nodes to the middle, then to the end
void MechanicalSystem::finish_middle(State& end, std::vector<PoseMotion>& motion) const {
  std::vector<const FrameConstraint*> constraint(start_.u.size(), nullptr);
  for (const FrameConstraint& c : model_.constraints) constraint[at(c.node)] = &c;
  for (std::size_t i = 0; i < start_.u.size(); ++i) {
    const PoseMotion x = motion[i];
    motion[i] = x * 2;
    end.v[i] = x.u * (2 / form_.h) - start_.v[i];
    end.Q_dot[i] = x.Q * (2 / form_.h) - start_.Q_dot[i];
    if (rigid(i)) finish_middle_of_frame(i, constraint[i], end, motion[i]);
    end.u[i] = start_.u[i] + motion[i].u;
    end.D[i] = start_.D[i] + motion[i].Q;
  }
  for (std::size_t k = 0; k < end.turned.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) end.turned[k][a] += end.turned[k][a] - start_.turned[k][a];
  if (model_.constraints.empty()) return;
  prescribed_increments(model_, filter_, end, end.turned, factors_, work_);
  filter_.to_global(work_);
  move_state(model_, work_, end);
  for (const FrameConstraint& c : model_.constraints) {
    const std::size_t i = at(c.node);
    motion[i] = {end.u[i] - start_.u[i], end.D[i] - start_.D[i]};
  }
}

/// Q turns by the same rotation again, and the mass centre goes on straight. The momentum is kept exactly, L₊ = L + dt
/// τ with the torque in the middle of the step: about the mass centre, or of a held frame about its origin and its free
/// axes.
void MechanicalSystem::finish_middle_of_frame(std::size_t i, const FrameConstraint* held, State& end,
                                              PoseMotion& motion) const {
  const double h = form_.h;
  const FrameInertia& inertia = model_.inertia[i];
  const PoseMotion x = motion_of(i);
  const Mat3d& Ds = increment_.Ds[i];
  const Mat3d twice = compose_increments(Ds, Ds), Q = Mat3d::identity() + start_.D[i];
  motion.Q = twice + twice * start_.D[i];
  const Mat3d Q_middle = Mat3d::identity() + state_.D[i], Q_end = Q + motion.Q;
  const PoseMotion rest = form_.deviation(x, i) * (1 / (h * h));
  const Vec3d spin = spin_of(start_.Q_dot[i], Q);
  const Vec3d center = inertia.mass > 0 ? inertia.first * (1 / inertia.mass) : Vec3d{};
  const InertiaForce f = inertia_force(inertia, rest.u, rest.Q);
  Vec3d spin_end = rotation_vector(Ds) * (2 / h) - spin;
  if (held == nullptr) {
    const SpinInertia turning(inertia);
    const Vec3d torque = axl(Q_middle * transpose(f.moment)) - cross(Q_middle * center, f.force);
    if (turning.regular) spin_end = turning.spin(Q_end, turning.momentum(Q, spin) + torque * form_.step);
  } else if (const SpinInertia turning(inertia.second); turning.regular) {
    const Mat3d& R = held->rotation_axes;
    const Vec3d torque = axl(Q_middle * transpose(rest.Q * inertia.second));
    Vec3d momentum = R * (turning.momentum(Q, spin) + torque * form_.step);
    Mat3d local = times_transpose(R * times_transpose(Q_end * turning.rest, Q_end), R);
    for (int a = 0; a < held->rotations; ++a) {
      momentum[a] = dot(R.row(a), spin_end);
      for (int k = 0; k < 3; ++k) local(a, k) = a == k ? 1 : 0;
    }
    spin_end = transpose(R) * (inverse(local) * momentum);
  }
  end.Q_dot[i] = skew(spin_end) * Q_end;
  if (!(inertia.mass > 0)) return;
  const Vec3d kept = end.v[i];
  motion.u = (x.u + x.Q * center) * 2 - motion.Q * center;
  end.v[i] = start_.v[i] + start_.Q_dot[i] * center + f.force * (form_.step / inertia.mass) - end.Q_dot[i] * center;
  for (int a = 0; held != nullptr && a < held->translations; ++a) {
    const Vec3d axis = held->translation_axes.row(a);
    end.v[i] += axis * dot(axis, kept - end.v[i]);
  }
}

void MechanicalSystem::start_acceleration(const State& start, double dt, StepMemory& memory) {
  memory.acceleration.assign(start.u.size(), {});
  begin_step(start, dt, TimeScheme::newmark, memory);
  executor_.gradient(state_, history_, gradient_);
  add_loads();
  std::vector<double>& force = work_;
  for (std::size_t k = 0; k < force.size(); ++k) force[k] = load_[k] - gradient_[k];
  for (int i = 0; i < model_.node_count(); ++i) {
    const Mat3d Q = Mat3d::identity() + state_.D[at(i)], W = skew(spin_of(start.Q_dot[at(i)], Q));
    InertiaForce f;
    if (rigid(at(i))) f = inertia_force(model_.inertia[at(i)], {}, W * W * Q);
    if (!model_.mass_damping.empty()) {
      const InertiaForce damping = inertia_force(model_.mass_damping[at(i)], start.v[at(i)], start.Q_dot[at(i)]);
      f.force += damping.force;
      f.moment += damping.moment;
    }
    add(force, i, -f.force, f.moment * -1.0, {});
  }
  dependents_.transfer(force);
  filter_.to_local(force);
  filter_.clear_fixed(force);
  const DofLayout& dofs = model_.points.dofs;
  for (int i = 0; i < model_.node_count(); ++i) {
    const Mat3d Q = Mat3d::identity() + state_.D[at(i)];
    double* a = force.data() + dofs.begin(i);
    SmallFactor factor;
    if (!factor.factorize(free_mass_block(model_, filter_, i, Q).data(), dofs.size(i)))
      std::fill_n(a, dofs.size(i), 0.0);
    else
      factor.solve(a);
  }
  filter_.to_global(force);
  for (int i = 0; i < model_.node_count(); ++i) {
    const Mat3d Q = Mat3d::identity() + state_.D[at(i)], W = skew(spin_of(start.Q_dot[at(i)], Q));
    const double* a = force.data() + dofs.begin(i);
    PoseMotion& out = memory.acceleration[at(i)];
    out.u = Vec3d{{a[0], a[1], a[2]}};
    out.Q = frame_variation(model_.kind(i), a + 3, Q);
    if (rigid(at(i))) out.Q += W * W * Q;
  }
}

}  // namespace fascia
