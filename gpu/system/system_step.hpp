#pragma once

#include "core/solver/boundary_motion.hpp"
#include "core/step/boundary_loops.hpp"
#include "gpu/system/system.hpp"
#include "gpu/system/tether_kernels.hpp"

/// The start and the end of a step of System.
namespace fascia::gpu {

template <class Space>
void System<Space>::begin_step(const Pose& start, double dt, TimeScheme scheme, const Memory& memory) {
  start_ = start;
  if (start_.turned.size() != turned_.size()) {  // a state made before the constraints has none
    start_.turned.resize(turned_.size());
    start_.turned.set_zero();
  }
  if (!dependents_.empty()) {
    dependents_.place(start_.u.data(), start_.D.data());
    dependents_.place_rates(start_.v.data(), start_.Q_dot.data());
  }
  du_.set_zero();
  Ds_.set_zero();
  turned_.copy_from(start_.turned);
  taken_length_ = 0;
  indefinite_ = false;
  if (!surfaces_.empty()) surfaces_.begin_step();
  step_ = StepConstants::of(scheme, dt, memory.step);
  inverse_step_ = 0;
  if (scheme != TimeScheme::implicit_euler) {
    if (dt > 0) {
      Space::for_each(model_.node_count(), loops::Predict{step_view(), memory.motion.data(), memory.velocity.data(),
                                                          memory.acceleration.data()});
    } else {
      q_.set_zero();
      w_.set_zero();
    }
  }
  if (dt > 0 && damped_) predict_strain(memory);
  if (!memory_.empty()) {
    if (memory_.remembers() && start_.begin_memory(memory_.size())) {  // as it is for ever
      memory_.prepare({});
      keep_memory(start_);
    }
    give_memory(Fading::over(step_.reach));
  }
  rebuild_state();
  node_parts_.template sum<0, 1>(loops::NodeMotion{data_.view().nodes, pose()}, start_motion_.data());
}

/// Gives the points that remember stresses, or make them, what they add to a step, or to a state that was reached.
template <class Space>
void System<Space>::give_memory(const Fading& fading) {
  if (memory_.empty()) return;
  memory_.prepare(fading);
  given_ = memory_.give(start_.memory.data(), data_.view().factors);
}

/// Has points that remember stresses keep a state, as the fading says that was prepared.
template <class Space>
void System<Space>::keep_memory(Pose& state) {
  fading_.resize(memory_.stress_size());
  blocks_.store_stress({state.u.data(), state.D.data()}, memory_.relaxing(), fading_.data());
  memory_.keep(state.memory.data(), fading_.data());
}

template <class Space>
void System<Space>::predict_strain(const Memory& memory) {
  inverse_step_ = 1 / step_.h;
  for (auto* E : {&E_, &start_E_, &ahead_E_, &behind_E_})
    if (E == &E_ || step_.scheme != TimeScheme::implicit_euler) E->resize(blocks_.strain_size());
  blocks_.store_strain({start_.u.data(), start_.D.data()}, E_.data());
  if (use_tiles()) tiles_->store_strain(start_.u.data()->v, &(*start_.D.data())(0, 0));
  if (step_.scheme == TimeScheme::implicit_euler) return;
  start_E_.copy_from(E_);
  double* E = E_.data();
  const int count = static_cast<int>(E_.size());
  if (step_.scheme == TimeScheme::bdf2) {
    Space::for_each(count, loops::Extrapolate{E, memory.E.data(), step_.memory_factor()});
    return;
  }
  store_strain_along_velocity(step_.h);
  Space::for_each(
      count, loops::StrainAlongVelocity{E, ahead_E_.data(), behind_E_.data(), step_.scheme == TimeScheme::newmark});
}

/// Stores strains a time h ahead of the step's start and behind it.
template <class Space>
void System<Space>::store_strain_along_velocity(double h) {
  moved_u_.resize(u_.size());
  moved_D_.resize(D_.size());
  for (const double sign : {1.0, -1.0}) {
    Space::for_each(model_.node_count(),
                    loops::MoveByVelocity{step_view(), sign * h, moved_u_.data(), moved_D_.data()});
    if (!dependents_.empty()) dependents_.place(moved_u_.data(), moved_D_.data());
    blocks_.store_strain({moved_u_.data(), moved_D_.data()}, sign > 0 ? ahead_E_.data() : behind_E_.data());
  }
}

template <class Space>
void System<Space>::look_at(const Pose& state, double h) {
  begin_step(state, 0);
  if (damped_ && h > 0) {
    for (auto* E : {&E_, &ahead_E_, &behind_E_}) E->resize(blocks_.strain_size());
    blocks_.store_strain(pose(), E_.data());
    store_strain_along_velocity(h);
    Space::for_each(static_cast<int>(E_.size()),
                    loops::StrainAlongVelocity{E_.data(), behind_E_.data(), ahead_E_.data(), true});
    inverse_step_ = 1 / h;
    // The steps to come may never need them.
    ahead_E_ = Array<Space, double>();
    behind_E_ = Array<Space, double>();
    moved_u_ = Array<Space, Vec3d>();
    moved_D_ = Array<Space, Mat3d>();
  }
  give_memory({});
  evaluate();
  internal_.viscous = 0;
  // Supports carry the mass damping of what they hold; nothing is accelerated.
  Space::for_each(static_cast<int>(model_.constraints.size()),
                  loops::SupportInertia{step_view(), state.v.data(), state.Q_dot.data(), 0, gradient_.data()});
}

template <class Space>
void System<Space>::add_held_inertia(const Array<Space, PoseMotion>& acceleration) {
  Space::for_each(static_cast<int>(acceleration.size()),
                  loops::HeldInertia{step_view(), acceleration.data(), gradient_.data()});
}

template <class Space>
void System<Space>::set_factors(std::span<const double> factors) {
  known_.reset();
  note_stretches();
  if (std::equal(factors.begin(), factors.end(), factors_.begin(), factors_.end()) && factors_are_placed_) return;
  factors_.assign(factors.begin(), factors.end());
  factors_are_placed_ = true;
  data_.set_factors(factors_);
  place_tethers();
  if (memory_.acts() && given_ != nullptr) memory_.give(start_.memory.data(), data_.view().factors);
}

template <class Space>
void System<Space>::set_rest() {
  set_factors(std::vector<double>(factors_.size(), 0.0));
  if (model_.tethers.empty()) return;
  blocks_.points().targets().set_zero();
  factors_are_placed_ = false;
}

template <class Space>
void System<Space>::place_tethers() {
  if (model_.tethers.empty()) return;
  std::vector<double> targets(blocks_.points().targets().size());
  fascia::place_tethers(model_, factors_, targets);
  blocks_.points().targets().upload(targets);
}

/// The strain energy is what the step before left; nothing has flowed yet.
template <class Space>
double System<Space>::energy_at_start() {
  const bool same = reached_ && step_.scheme == TimeScheme::implicit_euler && memory_.empty() && start_.step != 0 &&
                    reached_->first == start_.step;
  if (!same) return evaluate().energy;
  evaluate_loads();
  return reached_->second + load_energy_ + inertia_energy_;
}

template <class Space>
void System<Space>::start_from_prediction() {
  const double at_old_state = energy_at_start();
  save();
  Space::for_each(model_.node_count(), loops::PredictIncrement{step_view()});
  rebuild_state();
  const Evaluation predicted = evaluate();
  if (predicted.energy < at_old_state)
    known_ = predicted;  // Newton asks for it next
  else
    restore();
}

template <class Space>
void System<Space>::restart_motions() {
  known_.reset();
  data_.show_motions(model_.motions);
  factors_are_placed_ = false;
  start_driven(model_, reached_factors_);
}

template <class Space>
void System<Space>::begin_afresh(std::span<const double> factors, const std::vector<double>& pressures) {
  forget_steps(factors, pressures);
  kept_levels_ = {};
  blocks_or_levels_ = BlocksOrLevels(costs_of_levels());
  too_slow_ = false;
  if (host_) host_->system.begin_afresh(factors, {});
}

/// As MechanicalSystem's.
template <class Space>
void System<Space>::forget_steps(std::span<const double> factors, const std::vector<double>& pressures) {
  known_.reset();
  reached_.reset();
  reached_factors_.assign(factors.begin(), factors.end());
  middles_ = {};
  step_ = {};
  data_.show_motions(model_.motions);
  factors_are_placed_ = false;
  if (!surfaces_.empty()) surfaces_.begin_afresh(pressures);
}

template <class Space>
void System<Space>::finish_step(double end_time, Memory& memory, Pose& end) {
  reached_factors_ = factors_;
  if (!surfaces_.empty()) surfaces_.finish_step();
  const bool remembers = step_.h > 0 && step_.scheme != TimeScheme::implicit_euler;
  const bool same_step = StepConstants::equal(step_.step, memory.step) && memory.motion.size() == u_.size();
  end.u.resize(u_.size());
  end.v.resize(u_.size());
  end.D.resize(D_.size());
  end.Q_dot.resize(D_.size());
  end.turned.copy_from(turned_);
  end.time = end_time;
  end.step = ++steps_;
  if (remembers) {
    before_.swap(memory.motion);
    memory.motion.resize(u_.size());
    memory.velocity.resize(u_.size());
    if (step_.scheme == TimeScheme::newmark) memory.acceleration.resize(u_.size());
  }
  if (solves_for_middle() && step_.h > 0) end.turned.copy_from(start_.turned);
  loops::finish_step(Space(), step_view(),
                     {.u = end.u.data(),
                      .v = end.v.data(),
                      .D = end.D.data(),
                      .Q_dot = end.Q_dot.data(),
                      .turned = end.turned.data(),
                      .motion = remembers ? memory.motion.data() : nullptr,
                      .velocity = remembers ? memory.velocity.data() : nullptr,
                      .acceleration = step_.scheme == TimeScheme::newmark ? memory.acceleration.data() : nullptr,
                      .before = remembers && same_step ? before_.data() : nullptr});
  if (!dependents_.empty()) {
    dependents_.place(end.u.data(), end.D.data());
    dependents_.place_rates(end.v.data(), end.Q_dot.data());
  }
  if (memory_.acts()) end.factors = factors_;
  if (memory_.remembers()) {
    end.memory.copy_from(start_.memory);
    memory_.prepare(Fading::over(step_.step));
    keep_memory(end);
  }
  reached_.reset();
  if (step_.scheme == TimeScheme::implicit_euler && model_.tethers.empty())
    reached_ = {end.step, internal_.elastic + internal_.stabilization};
  if (!remembers) return;
  memory.step = step_.step;
  if (damped_) memory.E.copy_from(start_E_);
}

template <class Space>
void System<Space>::start_acceleration(const Pose& start, double dt, Memory& memory) {
  memory.acceleration.resize(u_.size());
  memory.acceleration.set_zero();
  begin_step(start, dt, TimeScheme::newmark, memory);
  // Nothing has moved yet, see MechanicalSystem: E + h dE/dt becomes E − h dE/dt.
  if (damped_) Space::for_each(static_cast<int>(E_.size()), loops::Extrapolate{E_.data(), start_E_.data(), -2});
  step_.h = 0;  // forces without inertia
  give_memory({});
  evaluate_forces();
  Space::for_each(model_.node_count(), loops::ForceOfAcceleration{step_view(), force_view(), world_y_.data()});
  if (!dependents_.empty()) dependents_.transfer(data_.view().nodes, world_y_.data(), nullptr);
  Space::for_each(model_.node_count(),
                  loops::StartAcceleration{step_view(), world_y_.data(), memory.acceleration.data()});
}

template <class Space>
void System<Space>::look_back(const Pose& state, const Pose& before, const Pose& earlier, double dt) {
  begin_step(state, 0);
  if (damped_) follow_strain(before, earlier, dt);
  give_memory({});
  evaluate();
  internal_.viscous = 0;
  if (!middles_.empty()) stretch_tethers(state.time);
  Space::for_each(static_cast<int>(model_.constraints.size()),
                  loops::SupportInertia{step_view(), before.v.data(), before.Q_dot.data(), 1 / dt, gradient_.data()});
}

/// Before the factors of the end take the place of those of the middle.
template <class Space>
void System<Space>::note_stretches() {
  if (tethers_.empty() || !solves_for_middle() || step_.h <= 0) return;
  Array<Space, Vec3d>& stretch = middles_.at_middle(start_.time + step_.reach);
  stretch.resize(tethers_.size());
  Points<Space>& points = blocks_.points();
  Space::for_each(static_cast<int>(tethers_.size()), kernels::NoteStretches{tethers_.data(), points.view(), pose(),
                                                                            points.targets().data(), stretch.data()});
}

/// Evaluates forces again, with tethers that pull as in the middles of steps.
template <class Space>
void System<Space>::stretch_tethers(double time) {
  Points<Space>& points = blocks_.points();
  const std::array<double, 3> w = middles_.weights(time);
  const auto& s = middles_.stretch;
  Space::for_each(static_cast<int>(tethers_.size()), kernels::StretchTethers{tethers_.data(),
                                                                             points.view(),
                                                                             pose(),
                                                                             {s[0].data(), s[1].data(), s[2].data()},
                                                                             {w[0], w[1], w[2]},
                                                                             points.targets().data()});
  factors_are_placed_ = false;
  evaluate_forces(false);
}

template <class Space>
std::vector<double> System<Space>::tether_targets() {
  return tethers_.empty() ? std::vector<double>{} : blocks_.points().targets().downloaded();
}

/// Ê of the strain rate at the end of a step, from the strains of three states.
template <class Space>
void System<Space>::follow_strain(const Pose& before, const Pose& earlier, double dt) {
  const bool second = !earlier.u.empty();
  E_.resize(blocks_.strain_size());
  blocks_.store_strain(pose(), E_.data());
  store_strain_at(before, behind_E_);
  if (second) store_strain_at(earlier, ahead_E_);
  Space::for_each(static_cast<int>(E_.size()),
                  loops::StrainFromSteps{E_.data(), behind_E_.data(), second ? ahead_E_.data() : nullptr});
  inverse_step_ = 1 / dt;
}

/// @param pose  whose dependent nodes may not be placed yet
template <class Space>
void System<Space>::store_strain_at(const Pose& pose, Array<Space, double>& E) {
  E.resize(blocks_.strain_size());
  if (dependents_.empty()) return blocks_.store_strain({pose.u.data(), pose.D.data()}, E.data());
  moved_u_.copy_from(pose.u);
  moved_D_.copy_from(pose.D);
  dependents_.place(moved_u_.data(), moved_D_.data());
  blocks_.store_strain({moved_u_.data(), moved_D_.data()}, E.data());
}

template <class Space>
StrainHistory System<Space>::strain_history() const {
  StrainHistory out;
  if (!damped_ || inverse_step_ == 0) return out;
  out.inverse_step = inverse_step_;
  out.E.resize(E_.size());
  E_.download(out.E);
  return out;
}

template <class Space>
void System<Space>::read(const ReachedParts& parts, ReachedForces& out) {
  if (parts.forces) {
    out.gradient = gradient();
    out.dependent_forces = dependent_forces();
  }
  if (parts.energies) out.energies = blocks_.energies(model_.points);
  if (!parts.slots || blocks_.points().empty()) return;
  blocks_.points().forces(data_.view().nodes, pose(), history(), nullptr);  // products may have overwritten them
  out.slot_sums = blocks_.points().slot_sums();
}

template <class Space>
double System<Space>::prescribed_rotation() {
  if (std::all_of(model_.motions.begin(), model_.motions.end(), [](const PrescribedMotion& m) { return m.angle == 0; }))
    return 0;
  std::vector<std::array<double, 3>> turned(model_.constraints.size());
  if (!turned.empty()) turned_.download(std::span(turned[0].data(), turned_.size()));
  return fascia::prescribed_rotation(model_, turned, factors_, reached_factors_);
}

}  // namespace fascia::gpu
