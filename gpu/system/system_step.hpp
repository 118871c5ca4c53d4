#pragma once

#include "core/solver/boundary_motion.hpp"
#include "gpu/system/system.hpp"
#include "gpu/system/tether_kernels.hpp"

#include <algorithm>
#include <array>

/// The steps of a StepSystem ask System for these; others read the rest.
namespace fascia::gpu {

template <class Space>
void System<Space>::step_began() {
  taken_length_ = 0;
  indefinite_ = false;
  if (step_.h > 0 && damped_ && use_tiles()) tiles_->store_strain(start_.u.data()->v, &(*start_.D.data())(0, 0));
  node_parts_.template sum<0, 1>(loops::NodeMotion{data_.view().nodes, pose()}, start_motion_.data());
}

template <class Space>
void System<Space>::store_strain(const Pose& state, Array<Space, double>& E) {
  E.resize(blocks_.strain_size());
  blocks_.store_strain({state.u.data(), state.D.data()}, E.data());
}

template <class Space>
void System<Space>::begin_afresh(std::span<const double> factors, const std::vector<double>& pressures) {
  Base::forget_steps(factors, pressures);
  kept_levels_ = {};
  blocks_or_levels_ = BlocksOrLevels(costs_of_levels());
  too_slow_ = false;
  if (host_) host_->system.begin_afresh(factors, {});
}

template <class Space>
void System<Space>::place_tethers() {
  if (model_.tethers.empty()) return;
  std::vector<double> targets(blocks_.points().targets().size());
  fascia::place_tethers(model_, factors_, targets);
  blocks_.points().targets().upload(targets);
}

template <class Space>
void System<Space>::release_tethers() {
  if (!model_.tethers.empty()) blocks_.points().targets().set_zero();
}

template <class Space>
void System<Space>::store_stretches(Vec3d* stretch) {
  Points<Space>& points = blocks_.points();
  Space::for_each(static_cast<int>(tethers_.size()),
                  kernels::NoteStretches{tethers_.data(), points.view(), pose(), points.targets().data(), stretch});
}

/// Evaluates forces again, with tethers that pull as in the middles of steps.
template <class Space>
void System<Space>::stretch_tethers(const std::array<double, 3>& weights) {
  Points<Space>& points = blocks_.points();
  const auto& s = middles_.stretch;
  Space::for_each(static_cast<int>(tethers_.size()), kernels::StretchTethers{tethers_.data(),
                                                                             points.view(),
                                                                             pose(),
                                                                             {s[0].data(), s[1].data(), s[2].data()},
                                                                             {weights[0], weights[1], weights[2]},
                                                                             points.targets().data()});
  evaluate_forces(false);
}

template <class Space>
std::vector<double> System<Space>::tether_targets() {
  return tethers_.empty() ? std::vector<double>{} : blocks_.points().targets().downloaded();
}

template <class Space>
StrainHistory System<Space>::strain_history() const {
  StrainHistory out;
  if (!damped_ || history_.inverse_step == 0) return out;
  out.inverse_step = history_.inverse_step;
  out.E.resize(history_.E.size());
  history_.E.download(out.E);
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
  if (!turned.empty()) increment_.turned.download(std::span(turned[0].data(), increment_.turned.size()));
  return fascia::prescribed_rotation(model_, turned, factors_, reached_factors_);
}

}  // namespace fascia::gpu
