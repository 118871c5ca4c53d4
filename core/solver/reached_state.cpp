#include "core/solver/mechanical_system.hpp"
#include "core/step/boundary_loops.hpp"

#include <algorithm>
#include <array>

/// What acts at a state that was reached, where no step's equations say it.
namespace fascia {

void MechanicalSystem::look_at(const State& state, double h) {
  begin_step(state, 0);
  if (model_.points.damped && h > 0) {
    StrainHistory ahead, behind;
    executor_.store_strain(moved_by_velocity(h), ahead);
    executor_.store_strain(moved_by_velocity(-h), behind);
    executor_.store_strain(state_, history_);
    for_strains(loops::StrainAlongVelocity{history_.E.data(), behind.E.data(), ahead.E.data(), true});
    history_.inverse_step = 1 / h;
  }
  give_memory({});
  evaluate_reached({});
  add_support_inertia(state, 0);
}

void MechanicalSystem::look_back(const State& state, const State& before, const State& earlier, double dt) {
  begin_step(state, 0);
  if (model_.points.damped) {
    StrainHistory last, first;
    store_strain_at(before, last);
    if (!earlier.u.empty()) store_strain_at(earlier, first);
    executor_.store_strain(state_, history_);
    for_strains(loops::StrainFromSteps{history_.E.data(), last.E.data(), first.E.empty() ? nullptr : first.E.data()});
    history_.inverse_step = 1 / dt;
  }
  give_memory({});
  std::vector<double> targets;
  if (!middles_.empty()) {
    targets.assign(executor_.targets().begin(), executor_.targets().end());
    const std::array<double, 3> weights = middles_.weights(state.time);
    for (std::size_t i = 0; i < model_.tethers.size(); ++i) {
      const Tether& t = model_.tethers[i];
      Vec3d more = executor_.points().tether_stretch(t, state_) * -1.0;
      for (std::size_t k = 0; k < 3; ++k)
        if (weights[k] != 0) more += middles_.stretch[k][i] * weights[k];
      move_target(t, model_.points.rule[at(t.group)].axes, more, targets.data());
    }
  }
  evaluate_reached(targets);
  add_support_inertia(before, 1 / dt);
}

/// With the mass damping of what is held.
/// @param before  a time 1/inverse_dt before the state
void MechanicalSystem::add_support_inertia(const State& before, double inverse_dt) {
  space_.for_each(
      static_cast<int>(model_.constraints.size()),
      loops::SupportInertia{step_view(), before.v.data(), before.Q_dot.data(), inverse_dt, gradient_.data()});
}

void MechanicalSystem::add_held_inertia(std::span<const PoseMotion> acceleration) {
  space_.for_each(static_cast<int>(acceleration.size()),
                  loops::HeldInertia{step_view(), acceleration.data(), gradient_.data()});
}

void read_tethers(const Model& model, std::span<const double> targets, const State& state, ReachedForces& out) {
  out.tether_forces.clear();
  for (const Tether& t : model.tethers) out.tether_forces.push_back(tether_force(model.points, targets, t, state));
}

void MechanicalSystem::read(const ReachedParts& parts, const State& state, ReachedForces& out) {
  if (parts.forces) {
    out.gradient = gradient_;
    out.dependent_forces = dependent_forces_;
    read_tethers(model_, executor_.targets(), state, out);
  }
  if (parts.energies) out.energies = executor_.energies();
  if (!parts.slots) return;
  executor_.store_slot_sums(state_, history_, out.slot_sums);
}

void MechanicalSystem::stand_in(const StepInProgress& step) {
  begin_step(step.start, 0);
  set_factors(step.factors);
  form_ = step.form;
  history_ = step.history;
  give_memory(Fading::over(form_.reach));
  increment_ = {step.increment.u, step.increment.D, step.increment.turned};
  rebuild_state();
  has_taken_ = extrapolates_ && !step.taken.d.empty();
  if (has_taken_) taken_ = step.taken;
  if (!step.pressures.empty()) surfaces_.follow(step.pressures);
  evaluate();
}

/// @param state  whose dependent nodes may not be placed yet
void MechanicalSystem::store_strain_at(State state, StrainHistory& history) {
  place_dependents(state);
  executor_.store_strain(state, history);
}

/// Before the factors of the end take the place of those of the middle.
void MechanicalSystem::note_stretches() {
  if (model_.tethers.empty() || !solves_for_middle() || form_.h <= 0) return;
  std::vector<Vec3d>& stretch = middles_.at_middle(start_.time + form_.reach);
  stretch.clear();
  for (const Tether& t : model_.tethers) stretch.push_back(executor_.points().tether_stretch(t, state_));
}

/// @param targets  what tethers pull to where that differs from what their energy says; or empty
void MechanicalSystem::evaluate_reached(std::span<const double> targets) {
  evaluate();
  internal_.viscous = 0;
  if (!targets.empty()) {
    std::copy(targets.begin(), targets.end(), executor_.targets().begin());
    executor_.forces(state_, history_, gradient_);
    for (std::size_t i = 0; i < gradient_.size(); ++i) gradient_[i] -= load_[i];
    dependents_.transfer(data_.view().nodes, gradient_.data(), dependent_forces_.data());
  }
}

}  // namespace fascia
