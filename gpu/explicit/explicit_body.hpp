#pragma once

#include "core/run/explicit_dynamics.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/step/boundary_loops.hpp"
#include "gpu/explicit/explicit.hpp"

#include <limits>
#include <utility>

/// The bodies of ExplicitSystem, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
ExplicitSystem<Space>::ExplicitSystem(const Model& model, const State& state, const ExplicitPlan& plan,
                                      FactorFunction factors)
    : model_(model),
      factor_function_(std::move(factors)),
      plan_(plan),
      last_step_(plan.step()),
      times_{plan.step(), plan.step()},
      filter_(model),
      nodes_(model, plan.step()),
      data_(model, filter_, zero_factors(model).size()),
      blocks_(model.points),
      dependents_(model.points),
      followers_(model),
      surfaces_(model),
      pose_(state),
      schedules_(static_cast<int>(zero_factors(model).size())),
      memory_(model.points.memory) {
  require_inertia(model, filter_);
  refuse_active_stress(model);
  upload_nodes();
  const auto n = at(model.node_count()), dofs = at(model.dof_count());
  begin_turned(model.constraints.size(), pose_);
  const bool rested = begin_memory(memory_.size(), pose_);
  fading_.resize(memory_.stress_size());
  memory_.prepare({});
  half_v_.resize(n);
  half_spin_.resize(pose_.D.size());
  half_rate_.resize(pose_.D.size());
  if (!dependents_.empty()) gradient_.resize(dofs);
  if (!dependents_.empty() || !followers_.empty() || !surfaces_.empty()) load_.resize(dofs);
  for (auto* array : {&increments_, &last_increments_}) {
    array->resize(model.constraints.empty() ? 0 : dofs);
    array->set_zero();
  }
  held_acceleration_.resize(model.constraints.size());
  still_.resize(at(model.points.part_count()));
  still_.set_zero();
  energies_.resize(blocks_.report_size());
  present_.resize(at(schedules_));
  table_.resize(at(kQueue * schedules_));
  progress_.upload(std::vector<Progress>(1));
  if (!dependents_.empty()) {
    dependents_.place(pose_.u.data(), pose_.D.data());
    dependents_.place_rates(pose_.v.data(), pose_.Q_dot.data());
  }
  if (rested) keep_memory(pose_.memory);
  before_.copy_from(pose_.memory);
  start_velocities();
  if (plan.automatic() && filter_.free_count() > 0) mode_ = std::make_unique<ExplicitMode<ExplicitSystem>>(*this);
}

template <class Space>
void ExplicitSystem<Space>::upload_nodes() {
  damping_.upload(nodes_.damping);
  if (!pose_.D.empty()) turning_.upload(nodes_.turning);
  if (!pose_.D.empty()) center_.upload(nodes_.center);
  if (!nodes_.inverse_mass.empty()) {
    affine_.upload(nodes_.affine);
    inverse_mass_.upload(std::span(nodes_.inverse_mass[0].data(), 16 * nodes_.inverse_mass.size()));
  }
  uneven_.upload(nodes_.uneven_damping);
  follows_.upload(nodes_.follows);
  tethers_.upload(model_.tethers);
}

template <class Space>
template <class Act>
void ExplicitSystem<Space>::for_nodes(const Act& act) {
  if (pose_.D.empty())
    act.template operator()<false>();
  else
    act.template operator()<true>();
}

/// @param factors  at the state
template <class Space>
kernels::ExplicitBlocksView ExplicitSystem<Space>::view(const Array<Space, double>& factors) {
  kernels::ExplicitBlocksView s;
  s.m = data_.view();
  s.m.factors = factors.data();
  s.blocks = blocks_.view();
  s.last_step = last_step_;
  s.times = times_;
  s.damping = damping_.data();
  s.turning = turning_.data();
  s.center = center_.data();
  s.affine = affine_.data();
  s.inverse_mass = inverse_mass_.data();
  s.uneven = uneven_.data();
  s.follows = follows_.data();
  s.increments = increments_.data();
  s.last_increments = last_increments_.data();
  s.load = load_.data();
  s.gradient = gradient_.data();
  s.u = pose_.u.data();
  s.v = pose_.v.data();
  s.D = pose_.D.data();
  s.Q_dot = pose_.Q_dot.data();
  s.turned = pose_.turned.data();
  s.half_v = half_v_.data();
  s.half_spin = half_spin_.data();
  s.half_rate = half_rate_.data();
  return s;
}

/// The strain a step before, along the given velocities.
template <class Space>
void ExplicitSystem<Space>::store_start_strain() {
  Array<Space, Vec3d> u(pose_.u.size());
  Array<Space, Mat3d> D(pose_.D.size());
  Space::for_each(model_.node_count(), loops::StepBack{view(next_), u.data(), D.data()});
  E_.resize(blocks_.strain_size());
  blocks_.store_strain({u.data(), D.data()}, E_.data());
  Space::synchronize();
}

template <class Space>
void ExplicitSystem<Space>::place_tethers() {
  if (model_.tethers.empty()) return;
  std::vector<double> targets(blocks_.points().targets().size());
  fascia::place_tethers(model_, factor_function_(plan_.time()), targets);
  blocks_.points().targets().upload(targets);
}

/// Half a step back, so that the mean of both sides is the velocity given.
template <class Space>
void ExplicitSystem<Space>::start_velocities() {
  next_.upload(factor_function_(plan_.time()));
  if (model_.points.damped) store_start_strain();
  place_tethers();
  const double internal = energy(false).total();
  update_forces(next_);
  for_nodes([&]<bool Frames>() {
    Space::template sum<1>(model_.node_count(), loops::StartVelocity<View, Frames>{view(next_)},
                           loops::StoreSums<1, 0>{&progress_.data()->given});
  });
  Progress start = progress();
  start.given += internal + nodes_.rounding_energy;
  progress_.upload(std::vector<Progress>{start});
}

/// Finds what points that remember stresses add at the present state; null where nothing fades.
template <class Space>
const double* ExplicitSystem<Space>::give_memory(Array<Space, double>& memory) {
  return memory_.empty() ? nullptr : memory_.give(memory.data(), nullptr);
}

/// @param memory  from before the present state; it becomes that of the state
template <class Space>
void ExplicitSystem<Space>::keep_memory(Array<Space, double>& memory) {
  if (memory_.empty()) return;
  blocks_.store_stress(pose_view(), memory_.relaxing(), fading_.data());
  memory_.keep(memory.data(), fading_.data());
}

/// Has the factors of the next two steps in the space.
template <class Space>
void ExplicitSystem<Space>::queue_factors() {
  if (plan_.taken() + 2 <= queued_from_ + queued_) return;
  queued_from_ = plan_.taken();
  queued_ = kQueue;
  std::vector<double> rows;
  ExplicitPlan ahead = plan_;
  for (int k = 0; k < kQueue; ++k, ahead.take()) {
    const std::vector<double> factors = factor_function_(ahead.end());
    rows.insert(rows.end(), factors.begin(), factors.end());
  }
  table_.upload(rows);
  Space::set_zero(&progress_.data()->row, sizeof(int));
}

/// Blocks and loads at the state. @param factors  there
template <class Space>
void ExplicitSystem<Space>::update_forces(const Array<Space, double>& factors) {
  update_forces(view(factors),
                {.E = E_.data(), .inverse_step = E_.empty() ? 0.0 : 1 / last_step_, .given = give_memory(before_)});
}

/// Forces of blocks and loads at the pose of a view.
template <class Space>
void ExplicitSystem<Space>::update_forces(const kernels::ExplicitBlocksView& s, const HistoryView& history) {
  const NodesView& nodes = data_.view().nodes;
  const PoseView pose{s.u, s.D};
  blocks_.forces(nodes, pose, history, nullptr);
  if (load_.empty()) return;
  for_nodes([&]<bool Frames>() { Space::for_each(nodes.count, kernels::GatherLoads<Frames>{s}); });
  if (!followers_.empty()) followers_.add_forces(nodes, pose, s.m.factors, load_.data());
  if (!surfaces_.empty()) surfaces_.add_forces(nodes, pose, s.m.factors, load_.data());
  if (dependents_.empty()) return;
  dependents_.turn(s.D);
  dependents_.transfer(nodes, gradient_.data(), nullptr);
  dependents_.transfer(nodes, load_.data(), nullptr);
}

template <class Space>
void ExplicitSystem<Space>::keep_strain() {
  memory_.prepare({Fading::Of::at_once, 0});  // as ExplicitStepper
  if (!model_.points.damped) return;
  mode_E_.resize(blocks_.strain_size());
  blocks_.store_strain(pose_view(), mode_E_.data());
}

template <class Space>
void ExplicitSystem<Space>::gather_acting(Pose& pose, double inverse_step, double* out) {
  View s = view(next_);
  s.u = pose.u.data();
  s.D = pose.D.data();
  s.uneven = nullptr;
  update_forces(
      s, {.E = mode_E_.data(), .inverse_step = mode_E_.empty() ? 0.0 : inverse_step, .given = give_memory(before_)});
  for_nodes([&]<bool Frames>() { Space::for_each(model_.node_count(), loops::GatherActing<View, Frames>{s, out}); });
}

template <class Space>
void ExplicitSystem<Space>::find_prescribed(const double* factors, Array<Space, double>& out) {
  Space::for_each(static_cast<int>(model_.constraints.size()),
                  loops::FindPrescribed{data_.view(), pose_view(), pose_.turned.data(), factors, out.data()});
}

template <class Space>
void ExplicitSystem<Space>::advance() {
  queue_factors();
  // As if the boundary had moved on like that before.
  if (plan_.taken() == 0) find_prescribed(table_.data(), last_increments_);
  const LeapTimes times = LeapTimes::between(last_step_, plan_.step());
  if (times.kick != times_.kick || times.drift != times_.drift) ++record_;
  times_ = times;
  memory_.prepare(fading_to_here());
  loop_.run(record_, 1, 1, &progress_.data()->unsound, [this] { step(); });
  last_step_ = times_.drift;
  plan_.take();
  pose_.time = plan_.time();
}

template <class Space>
double ExplicitSystem<Space>::stable_step() {
  return mode_ == nullptr ? std::numeric_limits<double>::infinity() : mode_->stable_step(plan_.limit());
}

template <class Space>
void ExplicitSystem<Space>::adopt(double stable) {
  const double step = plan_.step();
  plan_.adopt(stable);
  if (plan_.step() != step) queued_ = queued_from_ = 0;
}

template <class Space>
template <class Act>
void ExplicitSystem<Space>::for_moving(const Act& act) {
  act(half_v_, saved_.half_v);
  act(half_spin_, saved_.half_spin);
  act(half_rate_, saved_.half_rate);
  act(last_increments_, saved_.last_increments);
  act(E_, saved_.E);
  act(before_, saved_.memory);
  act(present_, saved_.present);
  act(next_, saved_.next);
  act(progress_, saved_.progress);
  if (!model_.tethers.empty()) act(blocks_.points().targets(), saved_.targets);
}

template <class Space>
void ExplicitSystem<Space>::save() {
  for_moving([](const auto& now, auto& kept) { kept.copy_from(now); });
  saved_.pose = pose_;
  saved_.plan = plan_;
  saved_.last_step = last_step_;
}

template <class Space>
void ExplicitSystem<Space>::restore(double limit) {
  for_moving([](auto& now, const auto& kept) { now.copy_from(kept); });
  pose_ = saved_.pose;
  plan_ = *saved_.plan;
  plan_.shorten(limit);
  last_step_ = saved_.last_step;
  queued_ = queued_from_ = 0;
}

/// Queues a step: the same launches in all of them.
template <class Space>
void ExplicitSystem<Space>::step() {
  Progress* progress = progress_.data();
  Space::for_each(schedules_, kernels::TakeFactors{progress, table_.data(), schedules_, present_.data(), next_.data()});
  update_forces(present_);
  if (!E_.empty()) blocks_.store_strain(pose_view(), E_.data());
  keep_memory(before_);
  find_prescribed(next_.data(), increments_);
  for_nodes([&]<bool Frames>() {
    Space::template sum<2>(model_.node_count(), loops::KickAndDrift<View, Frames>{view(present_)},
                           kernels::EndNodes{progress, tethers_.empty()});
  });
  if (!dependents_.empty()) dependents_.place(pose_.u.data(), pose_.D.data());
  if (tethers_.empty()) return;
  double* targets = blocks_.points().targets().data();
  Space::template sum<1>(static_cast<int>(tethers_.size()),
                         kernels::MoveTethers{tethers_.data(), data_.view().motions, next_.data(),
                                              blocks_.points().view(), pose_view(), targets},
                         kernels::EndTethers{progress});
}

template <class Space>
void ExplicitSystem<Space>::report_velocities() {
  queue_factors();
  memory_.prepare(fading_to_here());
  update_forces(next_);
  pose_.memory.copy_from(before_);
  keep_memory(pose_.memory);
  find_prescribed(table_.data() + at((plan_.taken() - queued_from_) * schedules_), increments_);
  View present = view(next_);
  present.times = LeapTimes::between(last_step_, plan_.step());
  for_nodes([&]<bool Frames>() {
    Space::for_each(model_.node_count(), loops::ReportVelocity<View, Frames>{present, held_acceleration_.data()});
  });
  if (!dependents_.empty()) dependents_.place_rates(pose_.v.data(), pose_.Q_dot.data());
  Space::template sum<1>(model_.node_count(), kernels::SizeOfMotion{view(next_)},
                         loops::StoreSums<1, 0>{&progress_.data()->motion});
}

/// @param faded  of what never fades, where points remember stresses; else as if nothing had faded
template <class Space>
InternalEnergy ExplicitSystem<Space>::energy(bool faded) {
  memory_.prepare({});
  const HistoryView history{.given = faded ? give_memory(pose_.memory) : nullptr};
  blocks_.forces(data_.view().nodes, pose_view(), history, still_.data());
  blocks_.sum_quantities(energies_.data());
  const std::vector<double> q = energies_.downloaded();
  InternalEnergy sum;
  for (std::size_t i = 0; i < q.size(); i += kQuantities) {
    sum.elastic += q[i + kElastic];
    sum.stabilization += q[i + kStabilizing];
  }
  return sum;
}

}  // namespace fascia::gpu
