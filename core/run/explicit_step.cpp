#include "core/run/explicit_step.hpp"

#include "core/node/node_force.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/step/boundary_loops.hpp"
#include "core/step/explicit_loops.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fascia {

ExplicitStepper::ExplicitStepper(MechanicalSystem& system, State& state, double dt, std::span<const double> factors)
    : model_(system.model()),
      executor_(system.executor()),
      filter_(system.filter()),
      space_(system.space()),
      seen_(system.nodes()),
      followers_(system.model(), system.space()),
      surfaces_(system.model(), system.space()),
      dependents_(system.model().points, system.space()),
      state_(state),
      last_step_(dt),
      times_{dt, dt},
      nodes_(system.model(), dt),
      factors_(factors.begin(), factors.end()),
      memory_(system.model().points.memory, system.space()) {
  require_inertia(model_, filter_);
  refuse_active_stress(model_);
  const auto n = at(model_.node_count());
  state_.turned.resize(model_.constraints.size());
  held_acceleration_.resize(model_.constraints.size());
  half_v_.resize(n);
  half_spin_.resize(model_.has_frames() ? n : 0);
  half_rate_.resize(half_spin_.size());
  gradient_.resize(at(model_.dof_count()));
  if (!model_.followers.empty() || !model_.surfaces.empty() || !dependents_.empty()) load_.resize(gradient_.size());
  const bool remembers = !state_.memory.empty();
  state_.memory.resize(memory_.size());
  fading_.resize(memory_.stress_size());
  increments_.resize(gradient_.size());
  last_increments_.resize(gradient_.size());
  place_dependents(state_);
  dependents_.place_rates(state_.v.data(), state_.Q_dot.data());
  if (!remembers) keep_memory({});
  start_velocities();
}

ExplicitView ExplicitStepper::view() {
  ExplicitView s;
  s.m = seen_;
  s.m.factors = factors_.data();
  s.last_step = last_step_;
  s.times = times_;
  s.damping = nodes_.damping.data();
  s.turning = nodes_.turning.data();
  s.center = nodes_.center.data();
  s.affine = nodes_.affine.data();
  if (!nodes_.inverse_mass.empty()) s.inverse_mass = nodes_.inverse_mass[0].data();
  if (!nodes_.uneven_damping.empty()) s.uneven = nodes_.uneven_damping.data();
  if (!nodes_.follows.empty()) s.follows = nodes_.follows.data();
  s.increments = increments_.data();
  s.last_increments = last_increments_.data();
  if (!load_.empty()) s.load = load_.data();
  s.gradient = gradient_.data();
  s.u = state_.u.data();
  s.v = state_.v.data();
  s.D = state_.D.data();
  s.Q_dot = state_.Q_dot.data();
  s.turned = loops::flat(state_.turned);
  s.half_v = half_v_.data();
  s.half_spin = half_spin_.data();
  s.half_rate = half_rate_.data();
  return s;
}

/// Finds what the prescribed degrees of freedom lack. @param factors  of where the boundary goes
void ExplicitStepper::find_increments(std::span<const double> factors) {
  space_.for_each(
      static_cast<int>(model_.constraints.size()),
      loops::FindPrescribed{
          seen_, {state_.u.data(), state_.D.data()}, loops::flat(state_.turned), factors.data(), increments_.data()});
}

/// Half a step back, so that the mean of both sides is the velocity given.
void ExplicitStepper::start_velocities() {
  if (model_.points.damped) {
    State before = state_;
    space_.for_each(model_.node_count(), loops::StepBack{view(), before.u.data(), before.D.data()});
    history_.inverse_step = 1 / last_step_;
    executor_.store_strain(before, history_.E);
  }
  place_tethers(model_, factors_, executor_.targets());
  start_energy_ = executor_.gradient(state_, {}, gradient_).total();
  update_forces({});
  double kinetic[1];
  for_nodes([&]<bool Frames>() {
    space_.sum<1>(model_.node_count(), loops::StartVelocity<ExplicitView, Frames>{view()},
                  loops::StoreSums<1, 0>{kinetic});
  });
  start_energy_ += kinetic[0];
}

/// @param fading  since the last forces; points that remember stresses then do so from here on
void ExplicitStepper::update_forces(const Fading& fading) {
  memory_.prepare(fading);
  if (!memory_.empty()) history_.given = {memory_.give(state_.memory.data(), factors_.data()), memory_.given_size()};
  add_forces(state_, gradient_, load_);
  if (model_.points.damped) executor_.store_strain(state_, history_.E);
  if (fading.of != Fading::Of::reached) keep_memory(fading);
}

void ExplicitStepper::keep_memory(const Fading& fading) {
  if (memory_.empty()) return;
  memory_.prepare(fading);
  executor_.store_stress(state_, {memory_.relaxing(), memory_.given_size()}, fading_);
  memory_.keep(state_.memory.data(), fading_.data());
}

/// Forces of the internal energy, with the viscous stress of the history, and of loads; on hosts of dependent nodes.
/// @param load  empty where only dead loads act
void ExplicitStepper::add_forces(const State& state, std::vector<double>& gradient, std::vector<double>& load) {
  executor_.forces(state, history_, gradient);
  if (load.empty()) return;
  space_.for_each(model_.node_count(), loops::StoreDeadLoads{view().m, {state.u.data(), state.D.data()}, load.data()});
  const PoseView pose{state.u.data(), state.D.data()};
  if (!followers_.empty()) followers_.add_forces(seen_.nodes, pose, factors_.data(), load.data());
  if (!surfaces_.empty()) surfaces_.add_forces(seen_.nodes, pose, factors_.data(), load.data());
  if (dependents_.empty()) return;
  dependents_.turn(state.D.data());
  dependents_.transfer(seen_.nodes, gradient.data());
  dependents_.transfer(seen_.nodes, load.data());
}

/// Strains are in the history. Points that remember stresses are taken as stiff as they are at once: what fades along a
/// mode that changes its sign in every step gives it no rest.
void ExplicitStepper::keep_strain() {
  if (memory_.empty()) return;
  memory_.prepare({Fading::Of::at_once, 0});
  history_.given = {memory_.give(state_.memory.data(), factors_.data()), memory_.given_size()};
}

void ExplicitStepper::gather_acting(State& pose, double inverse_step, double* out) {
  mode_gradient_.resize(gradient_.size());
  mode_load_.resize(load_.size());
  const double own = std::exchange(history_.inverse_step, inverse_step);
  add_forces(pose, mode_gradient_, mode_load_);
  history_.inverse_step = own;
  ExplicitView s = view();
  s.uneven = nullptr;
  s.D = pose.D.data();
  s.gradient = mode_gradient_.data();
  if (!mode_load_.empty()) s.load = mode_load_.data();
  for_nodes([&]<bool Frames>() {
    space_.for_each(model_.node_count(), loops::GatherActing<ExplicitView, Frames>{s, out});
  });
}

double ExplicitStepper::stable_step(double about) {
  if (filter_.free_count() == 0) return std::numeric_limits<double>::infinity();
  if (!mode_) mode_.emplace(*this);
  return mode_->stable_step(about);
}

void ExplicitStepper::save() {
  saved_ = moving();
  saved_targets_.assign(executor_.targets().begin(), executor_.targets().end());
}

void ExplicitStepper::restore() {
  moving() = saved_;
  std::copy(saved_targets_.begin(), saved_targets_.end(), executor_.targets().begin());
}

void ExplicitStepper::advance(std::span<const double> factors) {
  find_increments(factors);
  if (!stepped_) last_increments_ = increments_;  // as if the boundary had moved on like that before
  stepped_ = true;
  double sums[2];
  for_nodes([&]<bool Frames>() {
    space_.sum<2>(model_.node_count(), loops::KickAndDrift<ExplicitView, Frames>{view()}, loops::StoreSums<2, 0>{sums});
  });
  place_dependents(state_);
  work_ += tether_work(factors);
  kinetic_ = sums[0];
  work_ += sums[1];
  largest_work_ = std::max(largest_work_, work_);
  std::copy(factors.begin(), factors.end(), factors_.begin());
  last_step_ = times_.drift;
  times_ = {last_step_, last_step_};
  history_.inverse_step = model_.points.damped ? 1 / last_step_ : 0.0;
  update_forces(Fading::over(last_step_));
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
  find_increments(factors);
  for_nodes([&]<bool Frames>() {
    space_.for_each(model_.node_count(),
                    loops::ReportVelocity<ExplicitView, Frames>{view(), held_acceleration_.data()});
  });
  dependents_.place_rates(state_.v.data(), state_.Q_dot.data());
}

bool ExplicitStepper::is_sound() const { return is_sound_energy(kinetic_, given_energy() + nodes_.rounding_energy); }

}  // namespace fascia
