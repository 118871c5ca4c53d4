#include "core/solver/explicit_step.hpp"

#include "core/math/rotation.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/explicit_dynamics.hpp"
#include "core/solver/node_force.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

constexpr int kNodeGrain = 256;

}  // namespace

ExplicitStepper::ExplicitStepper(MechanicalSystem& system, State& state, double dt, std::span<const double> factors)
    : system_(system),
      model_(system.model()),
      executor_(system.executor()),
      filter_(system.filter()),
      surfaces_(system.model()),
      dependents_(system.model().points),
      state_(state),
      dt_(dt),
      factors_(factors.begin(), factors.end()) {
  require_inertia(model_, filter_);
  const auto n = at(model_.node_count());
  state_.turned.resize(model_.constraints.size());
  held_acceleration_.resize(model_.constraints.size());
  velocity_.resize(n);
  turning_.resize(n);
  center_.resize(n);
  damping_.resize(n);
  affine_.resize(n);
  constraint_.assign(n, -1);
  for (std::size_t k = 0; k < model_.constraints.size(); ++k)
    constraint_[at(model_.constraints[k].node)] = static_cast<int>(k);
  gradient_.resize(at(model_.dof_count()));
  const std::vector<DependentNode>& dependents = model_.points.dependents;
  if (!model_.followers.empty() || !model_.surfaces.empty() || !dependents.empty()) follower_.resize(gradient_.size());
  if (!dependents.empty()) follows_.assign(n, 0);
  for (const DependentNode& d : dependents)
    follows_[at(d.node)] = dependent_dofs(d, model_.points.dofs) == model_.points.dofs.size(d.node) ? 1 : 0;
  increments_.resize(gradient_.size());
  last_increments_.resize(gradient_.size());
  chunk_sums_.resize((n + kNodeGrain - 1) / kNodeGrain);
  for (std::size_t i = 0; i < n; ++i) {
    if (!follows_.empty() && follows_[i] != 0) continue;
    const FrameInertia& inertia = model_.inertia[i];
    const bool massive = inertia.mass > 0;  // else its place depends on others, and it turns by itself
    if (!model_.mass_damping.empty()) {
      const FrameInertia& damping = model_.mass_damping[i];
      const double turning = trace(inertia.second);
      if (massive)
        damping_[i] = 0.5 * dt * damping.mass / inertia.mass;
      else if (turning > 0)
        damping_[i] = 0.5 * dt * trace(damping.second) / turning;
    }
    const double still = 1e-10 * model_.points.part_length[at(model_.points.node_part[i])] / dt;
    rounding_energy_ += inertia.mass * still * still;
    if (constraint_[i] >= 0) continue;
    if (model_.frame_kind[i] == FrameKind::rigid) {
      turning_[i] = SpinInertia(inertia);
      if (massive) center_[i] = inertia.first * (1 / inertia.mass);
    }
    if (model_.frame_kind[i] != FrameKind::affine) continue;
    std::array<double, 16> mass{}, inverse{};
    mass[0] = massive ? inertia.mass : 1.0;
    for (int p = 0; p < 3; ++p) {
      mass[at(1 + p)] = mass[at(4 + 4 * p)] = inertia.first[p];
      for (int q = 0; q < 3; ++q) mass[at(5 + 4 * p + q)] = inertia.second(p, q);
    }
    SmallFactor factor;
    factor.factorize(mass.data(), 4);
    for (std::size_t j = 0; j < 4; ++j) {
      inverse[5 * j] = 1;
      factor.solve(inverse.data() + 4 * j);
    }
    affine_[i] = static_cast<int>(inverse_mass_.size());
    inverse_mass_.push_back(inverse);
  }
  if (!dependents.empty() && !model_.mass_damping.empty()) find_uneven_damping();
  place_dependents(model_.points, state_);
  place_dependent_rates(model_.points, state_);
  place_loads();
  start_velocities();
}

void ExplicitStepper::find_uneven_damping() {
  uneven_damping_.resize(velocity_.size());
  for (const DependentNode& d : model_.points.dependents)
    for (const int host : d.hosts) {
      const std::size_t i = at(host);
      if (model_.frame_kind[i] == FrameKind::vertex || follows_[i] != 0) continue;
      const double alpha = 2 * damping_[i] / dt_;
      const FrameInertia &damping = model_.mass_damping[i], &inertia = model_.inertia[i];
      uneven_damping_[i] = {damping.mass - alpha * inertia.mass, damping.first - inertia.first * alpha,
                            damping.second - inertia.second * alpha};
    }
}

/// Dead loads by node, and those on dependent nodes.
void ExplicitStepper::place_loads() {
  std::vector<char> depends(at(model_.node_count()), 0);
  for (const DependentNode& d : model_.points.dependents) depends[at(d.node)] = 1;
  for (const DeadLoad& load : model_.loads)
    for (const NodeLoad& n : load.nodes)
      (depends[at(n.node)] != 0 ? dependent_loads_ : loads_).push_back({load.schedule, n});
  std::stable_sort(loads_.begin(), loads_.end(),
                   [](const PlacedLoad& a, const PlacedLoad& b) { return a.load.node < b.load.node; });
  load_begin_.assign(at(model_.node_count() + 1), 0);
  for (const PlacedLoad& p : loads_) ++load_begin_[at(p.load.node + 1)];
  for (std::size_t i = 1; i < load_begin_.size(); ++i) load_begin_[i] += load_begin_[i - 1];
}

/// Half a step back, so that the mean of both sides is the velocity given.
void ExplicitStepper::start_velocities() {
  if (model_.points.damped) {
    State before = state_;
    for (std::size_t i = 0; i < before.u.size(); ++i) {
      before.u[i] -= state_.v[i] * dt_;
      before.D[i] -= state_.Q_dot[i] * dt_;
    }
    history_.inverse_step = 1 / dt_;
    executor_.store_strain(before, history_);
  }
  place_tethers(model_, factors_, executor_.targets());
  start_energy_ = executor_.gradient(state_, {}, gradient_).total();
  update_forces();
  for (int i = 0; i < model_.node_count(); ++i) {
    const PoseMotion given{state_.v[at(i)], state_.Q_dot[at(i)]};
    start_energy_ += 0.5 * inertia_product(model_.inertia[at(i)], given.u, given.Q);
    if (!follows_.empty() && follows_[at(i)] != 0) continue;
    const Velocity now = velocity_of(i, given);
    velocity_[at(i)] = now;
    double load[kMostDofs], force[kMostDofs];
    node_force(i, load, force);
    // Kicked from `now`: ((1 − a) v + dt f/m) / (1 + a), of which the half step back is (1 + a) v − dt f/(2 m).
    const double a = damping_[at(i)];
    const Velocity next = kicked(i, force);
    const auto back = [a](const auto& v, const auto& v_next) {
      return v * (1 + a) - (v_next * (1 + a) - v * (1 - a)) * 0.5;
    };
    velocity_[at(i)] = {back(now.v, next.v), back(now.spin, next.spin), back(now.rate, next.rate)};
  }
}

void ExplicitStepper::update_forces() {
  executor_.forces(state_, history_, gradient_);
  if (model_.points.damped) executor_.store_strain(state_, history_);
  std::fill(follower_.begin(), follower_.end(), 0.0);
  for (const FollowerLoad& load : model_.followers)
    for_each_share(load, state_, factors_[at(load.schedule)],
                   [&](int node, const Vec3d& force, const Mat3d& couple, const Vec3d& torque) {
                     add_node_force(model_.kind(node), state_.D[at(node)], force, couple, torque,
                                    follower_.data() + model_.points.dofs.begin(node));
                   });
  surfaces_.add_forces(state_, factors_, follower_);
  if (!dependents_.empty()) transfer_to_hosts();
}

void ExplicitStepper::transfer_to_hosts() {
  for (const PlacedLoad& p : dependent_loads_) {
    const double s = factors_[at(p.schedule)];
    add_node_force(model_.kind(p.load.node), state_.D[at(p.load.node)], p.load.force * s, p.load.couple * s,
                   p.load.torque * s, follower_.data() + model_.points.dofs.begin(p.load.node));
  }
  dependents_.turn(state_.D);
  dependents_.transfer(gradient_);
  dependents_.transfer(follower_);
}

/// What loads do on a node, and all that acts on it.
void ExplicitStepper::node_force(int node, double* load, double* force) const {
  const int n = model_.points.dofs.size(node);
  const auto first = at(model_.points.dofs.begin(node));
  std::fill_n(load, n, 0.0);
  for (int k = load_begin_[at(node)]; k < load_begin_[at(node + 1)]; ++k) {
    const NodeLoad& l = loads_[at(k)].load;
    const double s = factors_[at(loads_[at(k)].schedule)];
    add_node_force(model_.kind(node), state_.D[at(node)], l.force * s, l.couple * s, l.torque * s, load);
  }
  if (!follower_.empty())
    for (int k = 0; k < n; ++k) load[k] += follower_[first + at(k)];
  for (int k = 0; k < n; ++k) force[k] = load[k] - gradient_[first + at(k)];
  if (uneven_damping_.empty() || model_.kind(node) == FrameKind::vertex) return;
  const PoseMotion v = pose_velocity(node, velocity_[at(node)]);
  const InertiaForce drag = inertia_force(uneven_damping_[at(node)], v.u, v.Q);
  add_node_force(model_.kind(node), state_.D[at(node)], -drag.force, drag.moment * -1.0, {}, force);
}

/// The whole step of a vertex that nothing holds; false for other nodes.
bool ExplicitStepper::step_free_vertex(int node, Sums& sums) {
  const std::size_t i = at(node);
  if (model_.frame_kind[i] != FrameKind::vertex || constraint_[i] >= 0 || !follower_.empty()) return false;
  Vec3d load;
  for (int k = load_begin_[i]; k < load_begin_[i + 1]; ++k)
    load += loads_[at(k)].load.force * factors_[at(loads_[at(k)].schedule)];
  const double* g = gradient_.data() + model_.points.dofs.begin(node);
  const double a = damping_[i], mass = model_.inertia[i].mass;
  Vec3d& v = velocity_[i].v;
  v = v * ((1 - a) / (1 + a)) + (load - Vec3d{{g[0], g[1], g[2]}}) * (dt_ / (1 + a) / mass);
  state_.u[i] += v * dt_;
  sums.kinetic += 0.5 * mass * squared_norm(v);
  sums.work += dot(load, v) * dt_;
  return true;
}

void ExplicitStepper::drift(int node, const Velocity& w, const double* load, Sums& sums) {
  const std::size_t i = at(node);
  const FrameInertia& inertia = model_.inertia[i];
  const bool held = constraint_[i] >= 0;
  Vec3d du = w.v * dt_, rotation;
  double work = 0;
  switch (model_.kind(node)) {
    case FrameKind::vertex:
      if (!held) sums.kinetic += 0.5 * inertia.mass * squared_norm(w.v);
      break;
    case FrameKind::rigid: {
      Vec3d spin = w.spin;
      if (!held) {
        const Mat3d Q = Mat3d::identity() + state_.D[i];
        const Vec3d first = turning_[i].spin(Q, w.spin);
        spin = turning_[i].spin(Q + rotation_increment(first * (0.5 * dt_)) * Q, w.spin);
        sums.kinetic += 0.5 * (inertia.mass * squared_norm(w.v) + dot(w.spin, spin));
      }
      rotation = spin * dt_;
      const Mat3d D = orthonormalized_increment(compose_increments(rotation_increment(rotation), state_.D[i]));
      if (!held) du -= (D - state_.D[i]) * center_[i];
      state_.D[i] = D;
      for (int k = 0; k < 3; ++k) work += load[3 + k] * rotation[k];
      break;
    }
    case FrameKind::affine:
      if (!held) sums.kinetic += 0.5 * inertia_product(inertia, w.v, w.rate);
      state_.D[i] += w.rate * dt_;
      for (int k = 0; k < 9; ++k) work += load[3 + k] * w.rate(k % 3, k / 3) * dt_;
      break;
  }
  state_.u[i] += du;
  for (int k = 0; k < 3; ++k) work += load[k] * du[k];
  sums.work += work;
  if (!held || model_.kind(node) != FrameKind::rigid) return;
  const FrameConstraint& c = model_.constraints[at(constraint_[i])];
  for (int k = 0; k < c.rotations; ++k)
    state_.turned[at(constraint_[i])][at(k)] += dot(c.rotation_axes.row(k), rotation);
}

void ExplicitStepper::advance(std::span<const double> factors) {
  if (!model_.constraints.empty()) prescribed_increments(model_, filter_, state_, state_.turned, factors, increments_);
  if (!stepped_) last_increments_ = increments_;  // as if the boundary had moved on like that before
  stepped_ = true;
  const DofLayout& dofs = model_.points.dofs;
  executor_.pool().for_ranges(model_.node_count(), kNodeGrain, [&](int begin, int end) {
    Sums sums;
    for (int node = begin; node < end; ++node) {
      if (!follows_.empty() && follows_[at(node)] != 0) continue;
      if (step_free_vertex(node, sums)) continue;
      double load[kMostDofs], force[kMostDofs];
      node_force(node, load, force);
      const Velocity next = kicked(node, force);
      drift(node, next, load, sums);
      velocity_[at(node)] = next;
      if (constraint_[at(node)] < 0) continue;
      // The boundary overcomes the force on what it moves, in the mean of both ends of a step.
      const FrameConstraint& held = model_.constraints[at(constraint_[at(node)])];
      turn_dofs(model_.kind(node), held.translation_axes, held.rotation_axes, false, force);
      for (int k = 0; k < dofs.size(node); ++k) {
        const std::size_t i = at(dofs.begin(node) + k);
        sums.work -= 0.5 * force[k] * (last_increments_[i] + increments_[i]);
        last_increments_[i] = increments_[i];
      }
    }
    chunk_sums_[at(begin / kNodeGrain)] = sums;
  });
  place_dependents(model_.points, state_);
  work_ += tether_work(factors);
  kinetic_ = 0;
  for (const Sums& sums : chunk_sums_) {
    kinetic_ += sums.kinetic;
    work_ += sums.work;
  }
  largest_work_ = std::max(largest_work_, work_);
  std::copy(factors.begin(), factors.end(), factors_.begin());
  update_forces();
}

/// Moves what tethers pull to; the work that this takes.
double ExplicitStepper::tether_work(std::span<const double> factors) {
  if (model_.tethers.empty()) return 0;
  const std::span<double> targets = executor_.targets();
  old_targets_.assign(targets.begin(), targets.end());
  old_forces_.clear();
  for (const Tether& t : model_.tethers) old_forces_.push_back(executor_.tether_force(t, state_));
  place_tethers(model_, factors, targets);
  double work = 0;
  for (std::size_t i = 0; i < model_.tethers.size(); ++i) {
    const Tether& t = model_.tethers[i];
    const Vec3d force = (old_forces_[i] + executor_.tether_force(t, state_)) * 0.5;
    const auto first = at(model_.points.rule[at(t.group)].axes) * 3 * kGroupSize + at(t.lane);
    for (int k = 0; k < 3; ++k) {
      const std::size_t entry = first + at(k) * kGroupSize;
      work += force[k] * (targets[entry] - old_targets_[entry]);
    }
  }
  return work;
}

PoseMotion ExplicitStepper::pose_velocity(int node, const Velocity& w) const {
  const std::size_t i = at(node);
  if (model_.kind(node) != FrameKind::rigid) return {w.v, w.rate};
  const Mat3d Q = Mat3d::identity() + state_.D[i];
  if (constraint_[i] >= 0) return {w.v, skew(w.spin) * Q};
  const Mat3d Q_dot = skew(turning_[i].spin(Q, w.spin)) * Q;
  return {w.v - Q_dot * center_[i], Q_dot};
}

ExplicitStepper::Velocity ExplicitStepper::velocity_of(int node, const PoseMotion& motion) const {
  const std::size_t i = at(node);
  if (model_.kind(node) != FrameKind::rigid) return {motion.u, {}, motion.Q};
  const Mat3d Q = Mat3d::identity() + state_.D[i];
  const Vec3d spin = spin_of(motion.Q, Q);
  if (constraint_[i] >= 0) return {motion.u, spin, {}};
  return {motion.u + motion.Q * center_[i], turning_[i].momentum(Q, spin), {}};
}

void ExplicitStepper::report_velocities(std::span<const double> factors) {
  if (!model_.constraints.empty()) prescribed_increments(model_, filter_, state_, state_.turned, factors, increments_);
  for (int node = 0; node < model_.node_count(); ++node) {
    if (!follows_.empty() && follows_[at(node)] != 0) continue;
    double load[kMostDofs], force[kMostDofs];
    node_force(node, load, force);
    const Velocity &old = velocity_[at(node)], next = kicked(node, force);
    const Velocity mean{(old.v + next.v) * 0.5, (old.spin + next.spin) * 0.5, (old.rate + next.rate) * 0.5};
    const PoseMotion v = pose_velocity(node, mean);
    if (constraint_[at(node)] >= 0)
      held_acceleration_[at(constraint_[at(node)])] =
          (pose_velocity(node, next) - pose_velocity(node, old)) * (1 / dt_);
    state_.v[at(node)] = v.u;
    state_.Q_dot[at(node)] = v.Q;
  }
  place_dependent_rates(model_.points, state_);
}

bool ExplicitStepper::is_sound() const {
  constexpr double kRoom = 10;
  return std::isfinite(kinetic_) && kinetic_ <= kRoom * (given_energy() + rounding_energy_);
}

}  // namespace fascia
