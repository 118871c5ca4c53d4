#pragma once

#include "core/solver/state_copies.hpp"
#include "core/solver/step_system.hpp"
#include "core/step/boundary_loops.hpp"

/// The bodies of StepSystem that say what acts at a state that was reached, where no step's equations say it.
namespace fascia {

template <class Own, class Types>
void StepSystem<Own, Types>::look_at(const Pose& state, double h) {
  begin_step(state, 0);
  if (damped_ && h > 0) {
    own().store_strain(now_, history_.E);
    store_strain_along_velocity(h);
    for_strains(loops::StrainAlongVelocity{history_.E.data(), behind_E_.data(), ahead_E_.data(), true});
    history_.inverse_step = 1 / h;
    // The steps to come may never need them.
    ahead_E_ = Strains();
    behind_E_ = Strains();
    moved_ = Pose();
  }
  give_memory({});
  evaluate();
  internal_.viscous = 0;
  add_support_inertia(state, 0);
}

template <class Own, class Types>
void StepSystem<Own, Types>::look_back(const Pose& state, const Pose& before, const Pose& earlier, double dt) {
  begin_step(state, 0);
  if (damped_) follow_strain(before, earlier, dt);
  give_memory({});
  evaluate();
  internal_.viscous = 0;
  if (!middles_.empty()) {
    own().stretch_tethers(middles_.weights(state.time));
    factors_are_placed_ = false;
  }
  add_support_inertia(before, 1 / dt);
}

/// Ê of the strain rate at the end of a step, from the strains of three states.
template <class Own, class Types>
void StepSystem<Own, Types>::follow_strain(const Pose& before, const Pose& earlier, double dt) {
  const bool second = !earlier.u.empty();
  own().store_strain(now_, history_.E);
  store_strain_at(before, behind_E_);
  if (second) store_strain_at(earlier, ahead_E_);
  for_strains(loops::StrainFromSteps{history_.E.data(), behind_E_.data(), second ? ahead_E_.data() : nullptr});
  history_.inverse_step = 1 / dt;
}

/// @param pose  whose dependent nodes may not be placed yet
template <class Own, class Types>
void StepSystem<Own, Types>::store_strain_at(const Pose& pose, Strains& E) {
  if (dependents_.empty()) return own().store_strain(pose, E);
  copy_place(space_, pose, moved_);
  dependents_.place(moved_.u.data(), moved_.D.data());
  own().store_strain(moved_, E);
}

/// Before the factors of the end take the place of those of the middle.
template <class Own, class Types>
void StepSystem<Own, Types>::note_stretches() {
  if (model_.tethers.empty() || !solves_for_middle() || step_.h <= 0) return;
  auto& stretch = middles_.at_middle(start_.time + step_.reach);
  stretch.resize(model_.tethers.size());
  own().store_stretches(stretch.data());
}

/// With the mass damping of what is held. @param before  a time 1/inverse_dt before the state
template <class Own, class Types>
void StepSystem<Own, Types>::add_support_inertia(const Pose& before, double inverse_dt) {
  space_.for_each(
      static_cast<int>(model_.constraints.size()),
      loops::SupportInertia{step_view(), before.v.data(), before.Q_dot.data(), inverse_dt, gradient_.data()});
}

template <class Own, class Types>
void StepSystem<Own, Types>::add_held_inertia(const Motions& acceleration) {
  space_.for_each(static_cast<int>(acceleration.size()),
                  loops::HeldInertia{step_view(), acceleration.data(), gradient_.data()});
}

}  // namespace fascia
