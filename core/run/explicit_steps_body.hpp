#pragma once

#include "core/base/index.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/explicit_steps.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/state_copies.hpp"
#include "core/step/boundary_loops.hpp"

#include <algorithm>
#include <limits>
#include <utility>

/// The bodies of ExplicitSteps, for the files that instantiate it.
namespace fascia {

template <class Own, class Types>
ExplicitSteps<Own, Types>::ExplicitSteps(const Model& model, const State& state, const ExplicitPlan& plan,
                                         FactorFunction factors, Space space)
    : model_(model),
      factor_function_(std::move(factors)),
      plan_(plan),
      filter_(model),
      nodes_(model, plan.step()),
      space_(space),
      data_(model, filter_, zero_factors(model).size()),
      dependents_(model.points, space_),
      moving_(model, space_),
      memory_(model.points.memory, space_),
      turning_(model.has_frames()),
      damped_(model.points.damped),
      pose_(state),
      last_step_(plan.step()),
      times_{plan.step(), plan.step()},
      schedules_(static_cast<int>(zero_factors(model).size())) {
  require_inertia(model, filter_);
  refuse_active_stress(model);
  show_nodes();
  begin_turned(model.constraints.size(), pose_);
  const std::size_t n = at(model.node_count()), frames = turning_ ? n : 0, dofs = at(model.dof_count());
  half_v_.resize(n);
  half_spin_.resize(frames);
  half_rate_.resize(frames);
  if (!dependents_.empty()) gradient_.resize(dofs);
  if (!dependents_.empty() || !moving_.empty()) load_.resize(dofs);
  for (auto* array : {&increments_, &last_increments_}) {
    array->resize(model.constraints.empty() ? 0 : dofs);
    array->set_zero();
  }
  held_acceleration_.resize(model.constraints.size());
  fading_.resize(memory_.stress_size());
  present_.resize(at(schedules_));
  table_.resize(at(Own::kQueue * schedules_));
  progress_.upload(std::vector<Progress>(1));
  place_dependents(pose_);
  if (!dependents_.empty()) dependents_.place_rates(pose_.v.data(), pose_.Q_dot.data());
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::begin() {
  memory_.prepare({});
  if (begin_memory(memory_.size(), pose_)) keep_memory(pose_.memory);
  copy_values(space_, pose_.memory, before_);
  start_velocities();
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::show_nodes() {
  ExplicitView& c = constants_;
  c.damping = damping_.show(nodes_.damping);
  if (turning_) c.turning = turning_inertia_.show(nodes_.turning);
  if (turning_) c.center = center_.show(nodes_.center);
  c.affine = affine_.show(nodes_.affine);
  if (!nodes_.inverse_mass.empty())
    c.inverse_mass = inverse_mass_.show(std::span(nodes_.inverse_mass[0].data(), 16 * nodes_.inverse_mass.size()));
  c.uneven = uneven_.show(nodes_.uneven_damping);
  c.follows = follows_.show(nodes_.follows);
}

template <class Own, class Types>
ExplicitView ExplicitSteps<Own, Types>::nodes_view(const Array<Space, double>& factors) {
  ExplicitView s = constants_;
  s.m = data_.view();
  s.m.factors = factors.data();
  s.last_step = last_step_;
  s.times = times_;
  s.increments = increments_.data();
  s.last_increments = last_increments_.data();
  s.load = load_.data();
  s.gradient = gradient_.data();
  s.u = pose_.u.data();
  s.v = pose_.v.data();
  s.D = pose_.D.data();
  s.Q_dot = pose_.Q_dot.data();
  s.turned = loops::flat(pose_.turned);
  s.half_v = half_v_.data();
  s.half_spin = half_spin_.data();
  s.half_rate = half_rate_.data();
  return s;
}

/// Half a step back, so that the mean of both sides is the velocity given. The strain is that of a step before, along
/// the given velocities.
template <class Own, class Types>
void ExplicitSteps<Own, Types>::start_velocities() {
  const std::vector<double> factors = factor_function_(plan_.time());
  next_.upload(factors);
  if (damped_) {
    Pose before = pose_;
    space_.for_each(model_.node_count(), loops::StepBack{view(next_), before.u.data(), before.D.data()});
    own().store_strain(before, history_.E);
    progress();  // waits, since that pose goes
  }
  own().place_tethers(factors);
  const double internal = own().elastic_energy();
  update_forces(next_);
  for_nodes([&]<bool Frames>() {
    using View = decltype(view());
    space_.template sum<1>(model_.node_count(), loops::StartVelocity<View, Frames>{view(next_)},
                           loops::StoreSums<1, 0>{&progress_.data()->given});
  });
  Progress start = progress();
  start.given += internal + nodes_.rounding_energy;
  progress_.upload(std::vector<Progress>{start});
}

template <class Own, class Types>
ExplicitProgress ExplicitSteps<Own, Types>::progress() const {
  Progress now;
  Space::copy_out(&now, progress_.data(), sizeof now);
  return now;
}

template <class Own, class Types>
std::span<const double> ExplicitSteps<Own, Types>::given(double* memory) {
  if (memory_.empty()) return {};
  return {memory_.give(memory, nullptr), memory_.given_size()};
}

/// @param memory  from before the present state; it becomes that of the state
template <class Own, class Types>
void ExplicitSteps<Own, Types>::keep_memory(decltype(Pose::memory)& memory) {
  if (memory_.empty()) return;
  own().store_stress(pose_, {memory_.relaxing(), memory_.given_size()}, fading_);
  memory_.keep(memory.data(), fading_.data());
}

/// Has the factors of the next two steps in the space.
template <class Own, class Types>
void ExplicitSteps<Own, Types>::queue_factors() {
  if (plan_.taken() + 2 <= queued_from_ + queued_) return;
  queued_from_ = plan_.taken();
  queued_ = Own::kQueue;
  std::vector<double> rows;
  ExplicitPlan ahead = plan_;
  for (int k = 0; k < Own::kQueue; ++k, ahead.take()) {
    const std::vector<double> factors = factor_function_(ahead.end());
    rows.insert(rows.end(), factors.begin(), factors.end());
  }
  table_.upload(rows);
  Space::set_zero(&progress_.data()->row, sizeof(int));
}

/// Forces at the present state, unless they are known. @param factors  there
template <class Own, class Types>
void ExplicitSteps<Own, Types>::update_forces(const Array<Space, double>& factors) {
  if constexpr (Own::kKeepsForces)
    if (std::exchange(acting_, true)) return;
  history_.inverse_step = damped_ ? 1 / last_step_ : 0.0;
  history_.given = given(before_.data());
  update_forces(view(factors), pose_, history_);
}

/// Forces of blocks and loads. @param s  at the pose
template <class Own, class Types>
template <class View>
void ExplicitSteps<Own, Types>::update_forces(const View& s, const Pose& pose, const History& history) {
  const NodesView& nodes = data_.view().nodes;
  own().block_forces(pose, history);
  if (load_.empty()) return;
  for_nodes([&]<bool Frames>() { own().template store_loads<Frames>(s); });
  moving_.add_forces(nodes, {s.u, s.D}, s.m.factors, load_.data());
  if (dependents_.empty()) return;
  dependents_.turn(s.D);
  dependents_.transfer(nodes, gradient_.data());
  dependents_.transfer(nodes, load_.data());
}

/// Points that remember stresses are taken as stiff as they are at once: what fades along a mode that changes its sign
/// in every step gives it no rest.
template <class Own, class Types>
void ExplicitSteps<Own, Types>::keep_strain() {
  memory_.prepare({Fading::Of::at_once, 0});
  if (damped_) own().store_strain(pose_, mode_history_.E);
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::gather_acting(Pose& pose, double inverse_step, double* out) {
  acting_ = false;
  auto s = view(next_);
  s.u = pose.u.data();
  s.D = pose.D.data();
  s.uneven = nullptr;
  mode_history_.inverse_step = damped_ ? inverse_step : 0.0;
  mode_history_.given = given(before_.data());
  update_forces(s, pose, mode_history_);
  for_nodes([&]<bool Frames>() {
    space_.for_each(model_.node_count(), loops::GatherActing<decltype(s), Frames>{s, out});
  });
}

/// Finds what the prescribed degrees of freedom lack. @param factors  of where the boundary goes
template <class Own, class Types>
void ExplicitSteps<Own, Types>::find_prescribed(const double* factors, Array<Space, double>& out) {
  space_.for_each(static_cast<int>(model_.constraints.size()),
                  loops::FindPrescribed{
                      data_.view(), {pose_.u.data(), pose_.D.data()}, loops::flat(pose_.turned), factors, out.data()});
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::advance() {
  queue_factors();
  // The boundary counts as having moved on like that before.
  if (plan_.taken() == 0) find_prescribed(table_.data(), last_increments_);
  const LeapTimes times = LeapTimes::between(last_step_, plan_.step());
  if (times.kick != times_.kick || times.drift != times_.drift) ++record_;
  times_ = times;
  memory_.prepare(fading_to_here());
  own().run_recorded(record_, [this] { step(); });
  acting_ = false;
  last_step_ = times_.drift;
  plan_.take();
  pose_.time = plan_.time();
}

/// A step: the same loops in all of them.
template <class Own, class Types>
void ExplicitSteps<Own, Types>::step() {
  Progress* progress = progress_.data();
  space_.for_each(schedules_, loops::TakeFactors{progress, table_.data(), schedules_, present_.data(), next_.data()});
  update_forces(present_);
  if (damped_) own().store_strain(pose_, history_.E);
  keep_memory(before_);
  find_prescribed(next_.data(), increments_);
  const bool tethered = !model_.tethers.empty();
  for_nodes([&]<bool Frames>() {
    using View = decltype(view());
    space_.template sum<2>(model_.node_count(), loops::KickAndDrift<View, Frames>{view(present_)},
                           loops::EndNodes{progress, !tethered});
  });
  place_dependents(pose_);
  if (tethered) own().move_tethers(next_);
}

template <class Own, class Types>
double ExplicitSteps<Own, Types>::stable_step() {
  if (filter_.free_count() == 0) return std::numeric_limits<double>::infinity();
  if (mode_ == nullptr) mode_ = std::make_unique<ExplicitMode<Own>>(own());
  return mode_->stable_step(plan_.limit());
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::adopt(double stable) {
  const double step = plan_.step();
  plan_.adopt(stable);
  if (plan_.step() != step) queued_ = queued_from_ = 0;
}

template <class Own, class Types>
template <class Act>
void ExplicitSteps<Own, Types>::for_moving(const Act& act) {
  act(half_v_, saved_.half_v);
  act(half_spin_, saved_.half_spin);
  act(half_rate_, saved_.half_rate);
  act(last_increments_, saved_.last_increments);
  act(history_.E, saved_.E);
  act(before_, saved_.memory);
  act(present_, saved_.present);
  act(next_, saved_.next);
  act(progress_, saved_.progress);
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::save() {
  for_moving([&](const auto& now, auto& kept) { copy_values(space_, now, kept); });
  own().save_tethers();
  saved_.pose = pose_;
  saved_.plan = plan_;
  saved_.last_step = last_step_;
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::restore(double limit) {
  for_moving([&](auto& now, const auto& kept) { copy_values(space_, kept, now); });
  own().restore_tethers();
  pose_ = saved_.pose;
  plan_ = *saved_.plan;
  plan_.shorten(limit);
  last_step_ = saved_.last_step;
  queued_ = queued_from_ = 0;
  acting_ = false;
}

template <class Own, class Types>
void ExplicitSteps<Own, Types>::report_velocities() {
  queue_factors();
  memory_.prepare(fading_to_here());
  update_forces(next_);
  copy_values(space_, before_, pose_.memory);
  keep_memory(pose_.memory);
  find_prescribed(table_.data() + at((plan_.taken() - queued_from_) * schedules_), increments_);
  auto present = view(next_);
  present.times = LeapTimes::between(last_step_, plan_.step());
  for_nodes([&]<bool Frames>() {
    space_.for_each(model_.node_count(),
                    loops::ReportVelocity<decltype(present), Frames>{present, held_acceleration_.data()});
  });
  if (!dependents_.empty()) dependents_.place_rates(pose_.v.data(), pose_.Q_dot.data());
  space_.template sum<1>(model_.node_count(), loops::SizeOfMotion{present},
                         loops::StoreSums<1, 0>{&progress_.data()->motion});
}

}  // namespace fascia
