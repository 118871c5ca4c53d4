#include "core/run/explicit_step.hpp"

#include "core/run/explicit_steps_body.hpp"

#include <algorithm>
#include <utility>

namespace fascia {

ExplicitStepper::ExplicitStepper(MechanicalSystem& system, const State& state, const ExplicitPlan& plan,
                                 FactorFunction factors)
    : ExplicitSteps(system.model(), state, plan, std::move(factors), system.space()), executor_(system.executor()) {
  gradient_.resize(at(model_.dof_count()));
  begin();
}

double ExplicitStepper::elastic_energy() {
  return executor_.gradient(pose_, {}, {gradient_.data(), gradient_.size()}).total();
}

void ExplicitStepper::place_tethers(std::span<const double> factors) {
  fascia::place_tethers(model_, factors, executor_.targets());
}

/// Moves what tethers pull to, and adds the work that this takes.
void ExplicitStepper::move_tethers(const Array<PoolSpace, double>& factors) {
  const std::span<double> targets = executor_.targets();
  old_targets_.assign(targets.begin(), targets.end());
  old_forces_.clear();
  for (const Tether& t : model_.tethers) old_forces_.push_back(executor_.points().tether_force(t, pose_));
  place_tethers({factors.data(), factors.size()});
  double work = 0;
  for (std::size_t i = 0; i < model_.tethers.size(); ++i) {
    const Tether& t = model_.tethers[i];
    const Vec3d force = (old_forces_[i] + executor_.points().tether_force(t, pose_)) * 0.5;
    const auto first = at(model_.points.rule[at(t.group)].axes) * 3 * kGroupSize + at(t.lane);
    for (int k = 0; k < 3; ++k) {
      const std::size_t entry = first + at(k) * kGroupSize;
      work += force[k] * (targets[entry] - old_targets_[entry]);
    }
  }
  progress_.data()->work += work;
  progress_.data()->end_step();
}

void ExplicitStepper::save_tethers() { saved_targets_.assign(executor_.targets().begin(), executor_.targets().end()); }

void ExplicitStepper::restore_tethers() {
  std::copy(saved_targets_.begin(), saved_targets_.end(), executor_.targets().begin());
}

template class ExplicitSteps<ExplicitStepper, PoolStep>;

}  // namespace fascia
