#include "core/run/explicit_step.hpp"

#include "core/node/node_force.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/solver/boundary_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fascia {

namespace {

constexpr int kNodeGrain = 256;

}  // namespace

ExplicitStepper::ExplicitStepper(MechanicalSystem& system, State& state, double dt, std::span<const double> factors)
    : model_(system.model()),
      executor_(system.executor()),
      filter_(system.filter()),
      surfaces_(system.model()),
      dependents_(system.model().points),
      state_(state),
      last_step_(dt),
      times_{dt, dt},
      nodes_(system.model(), dt),
      factors_(factors.begin(), factors.end()) {
  require_inertia(model_, filter_);
  const auto n = at(model_.node_count());
  state_.turned.resize(model_.constraints.size());
  held_acceleration_.resize(model_.constraints.size());
  velocity_.resize(n);
  gradient_.resize(at(model_.dof_count()));
  if (!model_.followers.empty() || !model_.surfaces.empty() || !dependents_.empty()) follower_.resize(gradient_.size());
  increments_.resize(gradient_.size());
  last_increments_.resize(gradient_.size());
  chunk_sums_.resize((n + kNodeGrain - 1) / kNodeGrain);
  place_dependents(model_.points, state_);
  place_dependent_rates(model_.points, state_);
  place_loads();
  start_velocities();
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
      before.u[i] -= state_.v[i] * last_step_;
      before.D[i] -= state_.Q_dot[i] * last_step_;
    }
    history_.inverse_step = 1 / last_step_;
    executor_.store_strain(before, history_);
  }
  place_tethers(model_, factors_, executor_.targets());
  start_energy_ = executor_.gradient(state_, {}, gradient_).total();
  update_forces();
  for (int i = 0; i < model_.node_count(); ++i) {
    const PoseMotion given{state_.v[at(i)], state_.Q_dot[at(i)]};
    start_energy_ += 0.5 * inertia_product(model_.inertia[at(i)], given.u, given.Q);
    if (nodes_.skips(i)) continue;
    const ExplicitNode node = node_at(i);
    const HalfStepVelocity now = velocity_of(node, given);
    velocity_[at(i)] = now;
    double load[kMostDofs], force[kMostDofs];
    node_force(node, i, load, force);
    velocity_[at(i)] = kicked_back(node, now, force, last_step_);
  }
}

void ExplicitStepper::update_forces() {
  add_forces(state_, gradient_, follower_);
  if (model_.points.damped) executor_.store_strain(state_, history_);
}

/// Of the internal energy with the viscous stress of the history; of loads that follow; on hosts of dependent nodes.
void ExplicitStepper::add_forces(const State& state, std::vector<double>& gradient, std::vector<double>& follower) {
  executor_.forces(state, history_, gradient);
  std::fill(follower.begin(), follower.end(), 0.0);
  for (const FollowerLoad& load : model_.followers)
    for_each_share(load, state, factors_[at(load.schedule)],
                   [&](int node, const Vec3d& force, const Mat3d& couple, const Vec3d& torque) {
                     add_node_force(model_.kind(node), state.D[at(node)], force, couple, torque,
                                    follower.data() + model_.points.dofs.begin(node));
                   });
  surfaces_.add_forces(state, factors_, follower);
  if (dependents_.empty()) return;
  for (const PlacedLoad& p : dependent_loads_) {
    const double s = factors_[at(p.schedule)];
    add_node_force(model_.kind(p.load.node), state.D[at(p.load.node)], p.load.force * s, p.load.couple * s,
                   p.load.torque * s, follower.data() + model_.points.dofs.begin(p.load.node));
  }
  dependents_.turn(state.D);
  dependents_.transfer(gradient);
  dependents_.transfer(follower);
}

double ExplicitStepper::stable_step(double about) {
  if (filter_.free_count() == 0) return std::numeric_limits<double>::infinity();
  if (!mode_)
    mode_.emplace(model_, filter_, executor_.pool(),
                  [this, all = std::vector<double>(gradient_.size()), follower = follower_](
                      const State& state, double inverse_step, std::span<double> out) mutable {
                    const double own = std::exchange(history_.inverse_step, inverse_step);
                    add_forces(state, all, follower);
                    history_.inverse_step = own;
                    for (std::size_t k = 0; k < all.size(); ++k) out[k] = all[k];
                    for (std::size_t k = 0; k < follower.size(); ++k) out[k] -= follower[k];
                  });
  return mode_->stable_step(state_, about);
}

void ExplicitStepper::save() {
  saved_ = moving();
  saved_targets_.assign(executor_.targets().begin(), executor_.targets().end());
}

void ExplicitStepper::restore() {
  moving() = saved_;
  std::copy(saved_targets_.begin(), saved_targets_.end(), executor_.targets().begin());
}

/// What loads do on a node, and all that acts on it.
void ExplicitStepper::node_force(const ExplicitNode& at_node, int node, double* load, double* force) const {
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
  if (!nodes_.uneven_damping.empty() && model_.kind(node) != FrameKind::vertex)
    add_uneven_damping(at_node, nodes_.uneven_damping[at(node)], velocity_[at(node)], force);
}

ExplicitNode ExplicitStepper::node_at(int node) const {
  const std::size_t i = at(node);
  ExplicitNode out;
  out.kind = model_.kind(node);
  out.damping = 0.5 * times_.kick * nodes_.damping[i];
  out.inertia = &model_.inertia[i];
  out.turning = &nodes_.turning[i];
  if (!nodes_.inverse_mass.empty()) out.inverse_mass = nodes_.inverse_mass[at(nodes_.affine[i])].data();
  out.center = nodes_.center[i];
  out.D = state_.D[i];
  if (nodes_.constraint[i] < 0) return out;
  out.held = &model_.constraints[at(nodes_.constraint[i])];
  out.turn = filter_.turn_of(node);
  out.fixed = filter_.fixed_of(node);
  out.increments = increments_.data() + model_.points.dofs.begin(node);
  return out;
}

/// The whole step of a vertex that nothing holds; false for other nodes.
bool ExplicitStepper::step_free_vertex(int node, ExplicitSums& sums) {
  const std::size_t i = at(node);
  if (model_.frame_kind[i] != FrameKind::vertex || nodes_.constraint[i] >= 0 || !follower_.empty()) return false;
  Vec3d load;
  for (int k = load_begin_[i]; k < load_begin_[i + 1]; ++k)
    load += loads_[at(k)].load.force * factors_[at(loads_[at(k)].schedule)];
  fascia::step_free_vertex(0.5 * times_.kick * nodes_.damping[i], model_.inertia[i].mass, load,
                           gradient_.data() + model_.points.dofs.begin(node), times_, state_.u[i], velocity_[i].v,
                           sums);
  return true;
}

void ExplicitStepper::advance(std::span<const double> factors) {
  if (!model_.constraints.empty()) prescribed_increments(model_, filter_, state_, state_.turned, factors, increments_);
  if (!stepped_) last_increments_ = increments_;  // as if the boundary had moved on like that before
  stepped_ = true;
  const DofLayout& dofs = model_.points.dofs;
  executor_.pool().for_ranges(model_.node_count(), kNodeGrain, [&](int begin, int end) {
    ExplicitSums sums;
    for (int i = begin; i < end; ++i) {
      if (nodes_.skips(i) || step_free_vertex(i, sums)) continue;
      double load[kMostDofs], force[kMostDofs];
      const ExplicitNode node = node_at(i);
      node_force(node, i, load, force);
      velocity_[at(i)] = kicked(node, velocity_[at(i)], force, times_);
      double* turned = node.held == nullptr ? nullptr : state_.turned[at(nodes_.constraint[at(i)])].data();
      Mat3d D = node.D;
      drift(node, velocity_[at(i)], times_.drift, load, state_.u[at(i)], D, turned, sums);
      if (node.kind != FrameKind::vertex) state_.D[at(i)] = D;
      if (node.held != nullptr) add_boundary_work(node, force, last_increments_.data() + dofs.begin(i), sums);
    }
    chunk_sums_[at(begin / kNodeGrain)] = sums;
  });
  place_dependents(model_.points, state_);
  work_ += tether_work(factors);
  kinetic_ = 0;
  for (const ExplicitSums& sums : chunk_sums_) {
    kinetic_ += sums.kinetic;
    work_ += sums.work;
  }
  largest_work_ = std::max(largest_work_, work_);
  std::copy(factors.begin(), factors.end(), factors_.begin());
  last_step_ = times_.drift;
  times_ = {last_step_, last_step_};
  history_.inverse_step = model_.points.damped ? 1 / last_step_ : 0.0;
  update_forces();
}

/// Moves what tethers pull to; the work that this takes.
double ExplicitStepper::tether_work(std::span<const double> factors) {
  if (model_.tethers.empty()) return 0;
  const std::span<double> targets = executor_.targets();
  old_targets_.assign(targets.begin(), targets.end());
  old_forces_.clear();
  for (const Tether& t : model_.tethers) old_forces_.push_back(executor_.points().tether_force(t, state_));
  place_tethers(model_, factors, targets);
  double work = 0;
  for (std::size_t i = 0; i < model_.tethers.size(); ++i) {
    const Tether& t = model_.tethers[i];
    const Vec3d force = (old_forces_[i] + executor_.points().tether_force(t, state_)) * 0.5;
    const auto first = at(model_.points.rule[at(t.group)].axes) * 3 * kGroupSize + at(t.lane);
    for (int k = 0; k < 3; ++k) {
      const std::size_t entry = first + at(k) * kGroupSize;
      work += force[k] * (targets[entry] - old_targets_[entry]);
    }
  }
  return work;
}

void ExplicitStepper::report_velocities(std::span<const double> factors) {
  if (!model_.constraints.empty()) prescribed_increments(model_, filter_, state_, state_.turned, factors, increments_);
  const double later = times_.share_of_later();
  for (int i = 0; i < model_.node_count(); ++i) {
    if (nodes_.skips(i)) continue;
    double load[kMostDofs], force[kMostDofs];
    const ExplicitNode node = node_at(i);
    node_force(node, i, load, force);
    const HalfStepVelocity &old = velocity_[at(i)], next = kicked(node, old, force, times_);
    const PoseMotion v = pose_velocity(node, old * (1 - later) + next * later);
    if (node.held != nullptr)
      held_acceleration_[at(nodes_.constraint[at(i)])] =
          (pose_velocity(node, next) - pose_velocity(node, old)) * (1 / times_.kick);
    state_.v[at(i)] = v.u;
    state_.Q_dot[at(i)] = v.Q;
  }
  place_dependent_rates(model_.points, state_);
}

bool ExplicitStepper::is_sound() const { return is_sound_energy(kinetic_, given_energy() + nodes_.rounding_energy); }

}  // namespace fascia
