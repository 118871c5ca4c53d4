#include "core/solver/mechanical_system.hpp"
#include "core/step/boundary_loops.hpp"

#include <algorithm>
#include <array>

/// What acts at a state that was reached, where no step's equations say it.
namespace fascia {

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
  executor_.store_slot_sums(now_, history_, out.slot_sums);
}

void MechanicalSystem::stand_in(const StepInProgress& step) {
  begin_step(step.start, 0);
  set_factors(step.factors);
  step_ = step.step;
  q_ = step.q;
  w_ = step.w;
  history_ = step.history;
  give_memory(Fading::over(step_.reach));
  copy_increment(space_, step.increment, increment_);
  rebuild_state();
  has_taken_ = extrapolates_ && !step.taken.d.empty();
  if (has_taken_) taken_ = step.taken;
  if (!step.pressures.empty()) moving_.surfaces.follow(step.pressures);
  evaluate();
}

void MechanicalSystem::store_stretches(Vec3d* stretch) const {
  for (const Tether& t : model_.tethers) *stretch++ = executor_.points().tether_stretch(t, now_);
}

/// Evaluates forces again, with tethers that pull as in the middles of steps.
void MechanicalSystem::stretch_tethers(const std::array<double, 3>& weights) {
  for (std::size_t i = 0; i < model_.tethers.size(); ++i) {
    const Tether& t = model_.tethers[i];
    Vec3d more = executor_.points().tether_stretch(t, now_) * -1.0;
    for (std::size_t k = 0; k < 3; ++k)
      if (weights[k] != 0) more += middles_.stretch[k][i] * weights[k];
    move_target(t, model_.points.rule[at(t.group)].axes, more, executor_.targets().data());
  }
  executor_.forces(now_, history_, gradient_);
  for (std::size_t i = 0; i < gradient_.size(); ++i) gradient_[i] -= load_[i];
  dependents_.transfer(data_.view().nodes, gradient_.data(), dependent_forces_.data());
}

}  // namespace fascia
