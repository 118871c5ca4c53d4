#pragma once

#include "core/base/index.hpp"
#include "core/solver/state_copies.hpp"
#include "core/solver/step_system.hpp"
#include "core/step/boundary_loops.hpp"

#include <algorithm>
#include <cmath>

/// The bodies of StepSystem, for the files that instantiate it: a step, from its start to its end. What acts at other
/// states is in step_system_reached.hpp.
namespace fascia {

template <class Own, class Types>
StepSystem<Own, Types>::StepSystem(const Model& model, const SolverSettings& settings, Space space)
    : model_(model),
      settings_(settings),
      filter_(model),
      space_(space),
      data_(model, filter_, zero_factors(model).size()),
      node_parts_(model.points.node_part, model.points.part_count(), space_),
      dependents_(model.points, space_),
      moving_(model, space_),
      memory_(model.points.memory, space_),
      conservative_(model.loads_are_conservative()),
      turning_(model.has_frames()),
      damped_(model.points.damped),
      motions_(motion_sizes(model)),
      masses_(part_masses(model)),
      driven_(driven_parts(model)),
      factors_(zero_factors(model)),
      reached_factors_(factors_) {
  for (auto* vector : {&gradient_, &load_, &inertia_, &direction_})
    clear_values(space_, at(model.dof_count()), *vector);
  node_energy_.resize(3 * at(model.node_count()));
  dependent_forces_.resize(6 * model.points.dependents.size());
  data_.set_factors(factors_);
}

template <class Own, class Types>
StepView StepSystem<Own, Types>::step_view() {
  return {.model = data_.view(),
          .step = step_,
          .u0 = start_.u.data(),
          .v0 = start_.v.data(),
          .D0 = start_.D.data(),
          .rate0 = start_.Q_dot.data(),
          .du = increment_.u.data(),
          .u = now_.u.data(),
          .Ds = increment_.D.data(),
          .D = now_.D.data(),
          .q = q_.data(),
          .w = w_.data(),
          .turned = loops::flat(increment_.turned),
          .turning = turning_};
}

// The start of a step.

template <class Own, class Types>
void StepSystem<Own, Types>::begin_step(const Pose& start, double dt, TimeScheme scheme, const Memory& memory) {
  copy_motion(space_, start, start_);
  copy_values(space_, start.memory, start_.memory);
  begin_turned(model_.constraints.size(), start_);
  if (!dependents_.empty()) {
    dependents_.place(start_.u.data(), start_.D.data());
    dependents_.place_rates(start_.v.data(), start_.Q_dot.data());
  }
  begin_increment(space_, start_, increment_);
  shape_place(start_, now_);
  load_work_ = 0;
  if (!moving_.surfaces.empty()) moving_.surfaces.begin_step();
  step_ = StepConstants::of(scheme, dt, memory.step);
  history_.inverse_step = 0;
  if (scheme != TimeScheme::implicit_euler) {
    const auto data_or_null = [](const Motions& motions) { return motions.empty() ? nullptr : motions.data(); };
    q_.resize(start_.u.size());
    w_.resize(start_.u.size());
    if (dt > 0) {
      space_.for_each(model_.node_count(),
                      loops::Predict{step_view(), data_or_null(memory.motion), data_or_null(memory.velocity),
                                     data_or_null(memory.acceleration)});
    } else {
      clear_values(space_, q_.size(), q_);
      clear_values(space_, w_.size(), w_);
    }
  }
  if (dt > 0 && damped_) predict_strain(memory);
  if (!memory_.empty()) {
    if (memory_.remembers() && begin_memory(memory_.size(), start_)) {  // as it is for ever: nothing is left to fade
      memory_.prepare({});
      keep_memory(start_);
    }
    if (memory_.acts()) now_.factors = factors_;
    give_memory(Fading::over(step_.reach));
  }
  rebuild_state();
  own().step_began();
}

template <class Own, class Types>
void StepSystem<Own, Types>::give_memory(const Fading& fading) {
  if (memory_.empty()) return;
  memory_.prepare(fading);
  history_.given = {memory_.give(start_.memory.data(), data_.view().factors), memory_.given_size()};
}

template <class Own, class Types>
void StepSystem<Own, Types>::act(const double* factors) {
  if (memory_.acts() && !history_.given.empty()) memory_.give(start_.memory.data(), factors);
}

/// Has points that remember stresses keep a state, as the fading says that was prepared.
template <class Own, class Types>
void StepSystem<Own, Types>::keep_memory(Pose& state) {
  fading_.resize(memory_.stress_size());
  own().store_stress(state, {memory_.relaxing(), memory_.given_size()}, fading_);
  memory_.keep(state.memory.data(), fading_.data());
}

/// Ê of the step. The rate and the second derivative of the strain come from strains along the velocity,
/// h dE/dt = (E(h) − E(−h)) / 2 and h² d²E/dt² = E(h) − 2 E + E(−h).
template <class Own, class Types>
void StepSystem<Own, Types>::predict_strain(const Memory& memory) {
  history_.inverse_step = 1 / step_.h;
  own().store_strain(start_, history_.E);
  if (step_.scheme == TimeScheme::implicit_euler) return;
  copy_values(space_, history_.E, start_E_);
  double* E = history_.E.data();
  if (step_.scheme == TimeScheme::bdf2)
    return for_strains(loops::Extrapolate{E, memory.E.data(), step_.memory_factor()});
  store_strain_along_velocity(step_.h);
  for_strains(loops::StrainAlongVelocity{E, ahead_E_.data(), behind_E_.data(), step_.scheme == TimeScheme::newmark});
}

/// Stores strains a time ahead of the step's start and behind it: along arcs, of origins of frames in the midpoint rule
/// as their q says.
template <class Own, class Types>
void StepSystem<Own, Types>::store_strain_along_velocity(double time) {
  shape_place(start_, moved_);
  for (const double sign : {1.0, -1.0}) {
    space_.for_each(model_.node_count(),
                    loops::MoveByVelocity{step_view(), sign * time, moved_.u.data(), moved_.D.data()});
    if (!dependents_.empty()) dependents_.place(moved_.u.data(), moved_.D.data());
    own().store_strain(moved_, sign > 0 ? ahead_E_ : behind_E_);
  }
}

template <class Own, class Types>
void StepSystem<Own, Types>::set_factors(std::span<const double> factors) {
  known_.reset();
  note_stretches();
  if constexpr (!Space::kSeesHost)  // what goes there is worth a look
    if (factors_are_placed_ && std::ranges::equal(factors, factors_)) return;
  factors_.assign(factors.begin(), factors.end());
  factors_are_placed_ = true;
  data_.set_factors(factors_);
  own().place_tethers();
  if (memory_.acts()) now_.factors = factors_;
  act(data_.view().factors);
}

template <class Own, class Types>
void StepSystem<Own, Types>::set_rest() {
  set_factors(std::vector<double>(factors_.size(), 0.0));
  own().release_tethers();
  factors_are_placed_ = false;
}

template <class Own, class Types>
void StepSystem<Own, Types>::rebuild_state() {
  known_.reset();
  space_.for_each(model_.node_count(), loops::RebuildState{step_view()});
  place_dependents();
}

/// In the present state, and their increments by those of their hosts, which keep the digits of small steps.
template <class Own, class Types>
void StepSystem<Own, Types>::place_dependents() {
  if (dependents_.empty()) return;
  dependents_.place_increments(increment_.u.data(), increment_.D.data(), start_.D.data());
  dependents_.place(now_.u.data(), now_.D.data());
  dependents_.turn(now_.D.data());
}

/// Energy of the step where it starts. The strain energy is what the step before left; nothing has flowed yet.
template <class Own, class Types>
double StepSystem<Own, Types>::energy_at_start() {
  if (step_.scheme != TimeScheme::implicit_euler || !end_.is_at(start_)) return evaluate().energy;
  own().evaluate_loads();
  return end_energy_ + load_energy_ + inertia_energy_;
}

template <class Own, class Types>
void StepSystem<Own, Types>::start_from_prediction() {
  if (!model_.points.user_blocks.empty()) return;  // a leap that would not ask them, see largest_step()
  const double at_old_state = energy_at_start();
  save();
  space_.for_each(model_.node_count(), loops::PredictIncrement{step_view()});
  rebuild_state();
  const Evaluation predicted = evaluate();
  if (predicted.energy < at_old_state)
    known_ = predicted;  // Newton asks for it next
  else
    restore();
}

template <class Own, class Types>
void StepSystem<Own, Types>::restart_motions() {
  known_.reset();
  data_.show_motions(model_.motions);
  factors_are_placed_ = false;
  start_driven(model_, reached_factors_);
}

template <class Own, class Types>
void StepSystem<Own, Types>::forget_steps(std::span<const double> factors, const std::vector<double>& pressures) {
  known_.reset();
  end_.forget();
  reached_factors_.assign(factors.begin(), factors.end());
  middles_ = {};
  step_ = {};
  data_.show_motions(model_.motions);
  factors_are_placed_ = false;
  if (!moving_.surfaces.empty()) moving_.surfaces.begin_afresh(pressures);
}

// In a step.

template <class Own, class Types>
Evaluation StepSystem<Own, Types>::judged(std::span<const PartForces> parts) const {
  Evaluation e;
  e.energy = internal_.total() + load_energy_ - load_work_ + inertia_energy_;
  e.energy_scale = internal_.size() + std::abs(load_energy_) + inertia_energy_;
  judge(parts, model_.points.part_whole, settings_.tolerance, e);
  return e;
}

template <class Own, class Types>
void StepSystem<Own, Types>::apply(double step) {
  own().note_step(step);
  known_.reset();
  if (!moving_.surfaces.empty()) moving_.surfaces.approach(step);
  space_.for_each(model_.node_count(), loops::Advance{step_view(), direction_.data(), step});
  place_dependents();
}

template <class Own, class Types>
void StepSystem<Own, Types>::save() {
  copy_increment(space_, increment_, saved_);
  own().step_saved();
  if (!moving_.surfaces.empty()) moving_.surfaces.save();
}

template <class Own, class Types>
void StepSystem<Own, Types>::restore() {
  copy_increment(space_, saved_, increment_);
  own().step_restored();
  if (!moving_.surfaces.empty()) moving_.surfaces.restore();
  rebuild_state();
}

// The end of a step.

template <class Own, class Types>
void StepSystem<Own, Types>::finish_step(double end_time, Memory& memory, Pose& end) {
  reached_factors_ = factors_;
  if (!moving_.surfaces.empty()) moving_.surfaces.finish_step();
  const std::size_t n = start_.u.size();
  const bool remembers = step_.h > 0 && step_.scheme != TimeScheme::implicit_euler,
             newmark = step_.scheme == TimeScheme::newmark;
  const bool same_step = StepConstants::equal(step_.step, memory.step) && memory.motion.size() == n;
  shape_end(start_, increment_, end);
  end.time = end_time;
  if (remembers) {
    before_.swap(memory.motion);
    memory.motion.resize(n);
    memory.velocity.resize(n);
    if (newmark) memory.acceleration.resize(n);
  }
  if (solves_for_middle() && step_.h > 0) copy_turned(start_, end);
  loops::finish_step(space_, step_view(),
                     {.u = end.u.data(),
                      .v = end.v.data(),
                      .D = end.D.data(),
                      .Q_dot = end.Q_dot.data(),
                      .turned = loops::flat(end.turned),
                      .motion = remembers ? memory.motion.data() : nullptr,
                      .velocity = remembers ? memory.velocity.data() : nullptr,
                      .acceleration = newmark ? memory.acceleration.data() : nullptr,
                      .before = remembers && same_step ? before_.data() : nullptr});
  if (!dependents_.empty()) {
    dependents_.place(end.u.data(), end.D.data());
    dependents_.place_rates(end.v.data(), end.Q_dot.data());
  }
  // Tethers have been led elsewhere when the next step starts, memory has faded, and muscle acts otherwise.
  end_.take(space_, end,
            step_.h > 0 && step_.scheme == TimeScheme::implicit_euler && memory_.empty() && model_.tethers.empty());
  end_energy_ = internal_.elastic + internal_.stabilization;
  if (memory_.acts()) end.factors = factors_;
  if (memory_.remembers()) {
    copy_values(space_, start_.memory, end.memory);
    memory_.prepare(Fading::over(step_.step));
    keep_memory(end);
  }
  if (!remembers) return;
  memory.step = step_.step;
  if (damped_) copy_values(space_, start_E_, memory.E);
}

template <class Own, class Types>
void StepSystem<Own, Types>::start_acceleration(const Pose& start, double dt, Memory& memory) {
  clear_values(space_, start.u.size(), memory.acceleration);
  begin_step(start, dt, TimeScheme::newmark, memory);
  // Nothing has moved yet: (E − Ê) / h is dE/dt with the Ê of a step that comes from where velocities lead back to.
  if (damped_) for_strains(loops::Extrapolate{history_.E.data(), start_E_.data(), -2});
  step_.h = 0;  // forces without inertia
  give_memory({});
  own().evaluate_unjudged();
  double* force = own().scratch();
  space_.for_each(model_.node_count(), loops::ForceOfAcceleration{step_view(), force_view(), force});
  if (!dependents_.empty()) dependents_.transfer(data_.view().nodes, force);
  space_.for_each(model_.node_count(), loops::StartAcceleration{step_view(), force, memory.acceleration.data()});
}

}  // namespace fascia
