#include "core/solver/mechanical_system.hpp"
#include "core/solver/state_copies.hpp"
#include "core/step/boundary_loops.hpp"

/// The part of MechanicalSystem in which time schemes differ.
namespace fascia {

namespace {

const PoseMotion* data_or_null(const std::vector<PoseMotion>& motions) {
  return motions.empty() ? nullptr : motions.data();
}

}  // namespace

void MechanicalSystem::begin_step(const State& start, double dt, TimeScheme scheme, const StepMemory& memory) {
  ThreadPool& pool = executor_.pool();
  copy_place(pool, start, start_);
  copy_into(pool, start.v, start_.v);
  copy_matrices(pool, start.Q_dot, start_.Q_dot);
  start_.turned = start.turned;
  start_.turned.resize(model_.constraints.size());  // a state made before the constraints has none
  place_dependents(start_);
  place_dependent_rates(start_);
  clear_as(pool, start_.u, increment_.du);
  clear_as(pool, start_.D, increment_.Ds);
  increment_.turned = start_.turned;
  has_taken_ = false;
  load_work_ = saved_work_ = applied_ = 0;
  if (!surfaces_.empty()) surfaces_.begin_step();
  executor_.start_from(start_);
  static_cast<StepConstants&>(form_) = StepConstants::of(scheme, dt, memory.step);
  history_.inverse_step = 0;
  if (scheme != TimeScheme::implicit_euler) {
    clear_as(pool, start_.u, form_.q);
    clear_as(pool, start_.u, form_.w);
    if (dt > 0)
      space_.for_each(model_.node_count(),
                      loops::Predict{step_view(), data_or_null(memory.motion), data_or_null(memory.velocity),
                                     data_or_null(memory.acceleration)});
  }
  if (dt > 0 && model_.points.damped) predict_strain(memory);
  if (!memory_.empty()) {
    if (memory_.remembers() && start_.memory.empty()) rest_as_it_is(start_);
    state_.memory = start_.memory;
    if (memory_.acts()) state_.factors = factors_;
    give_memory(Fading::over(form_.reach));
  }
  rebuild_state();
}

/// A state that remembers nothing has been as it is for ever: nothing is left to fade.
void MechanicalSystem::rest_as_it_is(State& state) {
  state.memory.resize(memory_.size());
  memory_.prepare({});
  keep_memory(state);
}

/// Has points that remember stresses keep a state, as the fading says that was prepared.
void MechanicalSystem::keep_memory(State& state) {
  fading_.resize(memory_.stress_size());
  executor_.store_stress(state, {memory_.relaxing(), memory_.given_size()}, fading_);
  memory_.keep(state.memory.data(), fading_.data());
}

/// Gives the points that remember stresses, or make them, what they add to a step, or to a state that was reached.
void MechanicalSystem::give_memory(const Fading& fading) {
  if (memory_.empty()) return;
  memory_.prepare(fading);
  history_.given = {memory_.give(start_.memory.data(), factors_.data()), memory_.given_size()};
}

/// Gives them anew once a step has begun, with the factors of schedules that came after that.
void MechanicalSystem::act(std::span<const double> factors) {
  if (!memory_.acts()) return;
  state_.factors.assign(factors.begin(), factors.end());
  if (!history_.given.empty()) memory_.give(start_.memory.data(), factors.data());
}

/// Where the present velocities lead: rotations along arcs, origins of frames in the midpoint rule as their q says.
State MechanicalSystem::moved_by_velocity(double time) {
  State moved = start_;
  space_.for_each(model_.node_count(), loops::MoveByVelocity{step_view(), time, moved.u.data(), moved.D.data()});
  place_dependents(moved);
  return moved;
}

/// Ê of the step. The rate and the second derivative of the strain come from strains along the velocity,
/// h dE/dt = (E(h) − E(−h)) / 2 and h² d²E/dt² = E(h) − 2 E + E(−h).
void MechanicalSystem::predict_strain(const StepMemory& memory) {
  history_.inverse_step = 1 / form_.h;
  executor_.store_strain(start_, history_);
  if (form_.scheme == TimeScheme::implicit_euler) return;
  start_strain_ = history_.E;
  double* E = history_.E.data();
  if (form_.scheme == TimeScheme::bdf2)
    return for_strains(loops::Extrapolate{E, memory.E.data(), form_.memory_factor()});
  StrainHistory ahead, behind;
  executor_.store_strain(moved_by_velocity(form_.h), ahead);
  executor_.store_strain(moved_by_velocity(-form_.h), behind);
  for_strains(loops::StrainAlongVelocity{E, ahead.E.data(), behind.E.data(), form_.scheme == TimeScheme::newmark});
}

void MechanicalSystem::restart_motions() {
  known_.reset();
  start_driven(model_, reached_factors_);
}

void MechanicalSystem::begin_afresh(std::span<const double> factors, const std::vector<double>& pressures) {
  forget_steps(factors, pressures);
  tangent_.begin_afresh();
}

void MechanicalSystem::forget_steps(std::span<const double> factors, const std::vector<double>& pressures) {
  known_.reset();
  reached_.reset();
  reached_factors_.assign(factors.begin(), factors.end());
  middles_ = {};
  static_cast<StepConstants&>(form_) = {};
  if (!surfaces_.empty()) surfaces_.begin_afresh(pressures);
  tangent_.forget_kept_factor();
}

void MechanicalSystem::finish_step(double end_time, StepMemory& memory, State& end) {
  reached_factors_ = factors_;
  if (!surfaces_.empty()) surfaces_.finish_step();
  Reached reached = reached_ ? *std::exchange(reached_, std::nullopt) : Reached{};
  const std::size_t n = start_.u.size();
  ThreadPool& pool = executor_.pool();
  copy_place(pool, state_, end);
  end.turned = increment_.turned;
  end.time = end_time;
  clear_as(pool, end.u, end.v);
  clear_as(pool, end.D, end.Q_dot);
  const bool remembers = form_.h > 0 && form_.scheme != TimeScheme::implicit_euler;
  const bool same_step = StepConstants::equal(form_.step, memory.step) && memory.motion.size() == n;
  if (remembers) {
    before_.swap(memory.motion);
    memory.motion.resize(n);
    memory.velocity.resize(n);
    if (form_.scheme == TimeScheme::newmark) memory.acceleration.resize(n);
  }
  if (solves_for_middle() && form_.h > 0) end.turned = start_.turned;
  loops::finish_step(space_, step_view(),
                     {.u = end.u.data(),
                      .v = end.v.data(),
                      .D = end.D.data(),
                      .Q_dot = end.Q_dot.data(),
                      .turned = loops::flat(end.turned),
                      .motion = remembers ? memory.motion.data() : nullptr,
                      .velocity = remembers ? memory.velocity.data() : nullptr,
                      .acceleration = form_.scheme == TimeScheme::newmark ? memory.acceleration.data() : nullptr,
                      .before = remembers && same_step ? before_.data() : nullptr});
  place_dependents(end);
  place_dependent_rates(end);
  // Tethers have been led elsewhere when the next step starts, memory has faded, and muscle acts otherwise.
  if (form_.h > 0 && form_.scheme == TimeScheme::implicit_euler && memory_.empty() && model_.tethers.empty()) {
    copy_into(pool, end.u, reached.u);
    copy_matrices(pool, end.D, reached.D);
    reached.energy = internal_.elastic + internal_.stabilization;
    reached_ = std::move(reached);
  }
  if (memory_.acts()) end.factors = factors_;
  if (memory_.remembers()) {
    memory_.prepare(Fading::over(form_.step));
    keep_memory(end);
  }
  if (!remembers) return;
  memory.step = form_.step;
  if (history_.inverse_step > 0) memory.E = start_strain_;
}

void MechanicalSystem::start_acceleration(const State& start, double dt, StepMemory& memory) {
  memory.acceleration.assign(start.u.size(), {});
  begin_step(start, dt, TimeScheme::newmark, memory);
  // Nothing has moved yet: (E − Ê) / h is dE/dt with the Ê of a step that comes from where velocities lead back to.
  if (model_.points.damped) for_strains(loops::Extrapolate{history_.E.data(), start_strain_.data(), -2});
  form_.h = 0;  // forces without inertia
  give_memory({});
  executor_.gradient(state_, history_, gradient_);
  add_loads_and_inertia();
  const int nodes = model_.node_count();
  space_.for_each(model_.dof_count(), loops::AddInertiaAndLoads{force_view()});
  space_.for_each(nodes, loops::ForceOfAcceleration{step_view(), force_view(), work_.data()});
  dependents_.transfer(data_.view().nodes, work_.data());
  space_.for_each(nodes, loops::StartAcceleration{step_view(), work_.data(), memory.acceleration.data()});
}

}  // namespace fascia
