#pragma once

#include "core/solver/step_system_body.hpp"
#include "core/solver/step_system_reached.hpp"
#include "core/tangent/extrapolation.hpp"
#include "gpu/space/device.hpp"
#include "gpu/system/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The bodies of System, for the files that instantiate it: a step as Newton's method sees it. Its start is in
/// system_step.hpp, its linear solves in system_solve.hpp.
namespace fascia::gpu {

template <class Space>
System<Space>::System(const Model& model, const SolverSettings& settings)
    : Base(model, settings),
      blocks_(model.points, settings.precision),
      cg_(settings.precision == Precision::single ? 0 : at(model.dof_count())),
      narrow_cg_(settings.precision == Precision::single ? at(model.dof_count()) : 0),
      extrapolates_(extrapolates_stresses(model.points, settings.tangent)) {
  const auto n = at(model.node_count()), dofs = at(model.dof_count()), parts = at(model.points.part_count());
  const std::size_t frames = turning_ ? n : 0;
  for (auto* array : {&L_, &dA_}) array->resize(frames);
  Q_.resize(n);
  dx_.resize(n);
  for (auto* array : {&world_d_, &world_y_, &prescribed_}) {
    array->resize(dofs);
    array->set_zero();
  }
  for (auto* array : {&part_motion_, &start_motion_}) {
    array->resize(parts);
    array->set_zero();
  }
  if (!model.tethers.empty()) tether_L_.resize(n);
  tethers_.upload(model.tethers);
  report_.resize(parts * kNodeQuantities + blocks_.report_size() + moving_.surfaces.figure_count() + 3);
  report_.set_zero();
  report_values_.resize(report_.size());
  node_blocks_.resize(model.points.dofs.block_total());
  inverse_.resize(node_blocks_.size());
  if (settings.precision != Precision::full) narrow_dA_.resize(frames);
  if (settings.precision == Precision::single) {
    narrow_blocks_.resize(node_blocks_.size());
    narrow_inverse_.resize(node_blocks_.size());
    narrow_d_.resize(dofs);
    narrow_dx_.resize(n);
  }
  slope_.resize(3);
  spin_.resize(1);
  spin_.set_zero();
  idle_.resize(1);
  if constexpr (Space::kHasTiles) make_tiles();
}

/// Why tiles do not compute the model, whatever its points are; empty where they may. They hold solids of rigid frames
/// that move by themselves, in world axes, and vectors of 64 bits.
template <class Space>
std::string System<Space>::not_in_tiles() const {
  const PreconditionerKind kind = settings_.preconditioner;
  if (std::string refusal = not_for_tiles(model_.points); !refusal.empty()) return refusal;
  if (settings_.precision == Precision::single) return "precision is single";
  if (kind != PreconditionerKind::automatic && kind != PreconditionerKind::block_jacobi &&
      kind != PreconditionerKind::none)
    return "the preconditioner is not block-Jacobi";
  if (filter_.turns()) return "a constraint has axes of its own";
  if (!dependents_.empty()) return "the model has nodes that depend on others";
  if (!moving_.surfaces.empty()) return "a load acts on a surface that moves";
  if (!model_.tethers.empty()) return "a boundary is held by springs";
  return "";
}

template <class Space>
void System<Space>::make_tiles() {
  const bool shared = settings_.devices.size() > 1;
  std::string refusal = not_in_tiles();
  TilePointsResult points;
  if (refusal.empty()) {
    points = tile_points(model_.points, model_.rest_position);
    refusal = points.refusal;
  }
  if (refusal.empty()) {
    TileSolverSettings settings;
    if (settings_.precision == Precision::mixed) settings.constants = TileConstants::float32;
    settings.devices = settings_.devices;
    ThreadPool pool(0);
    try {
      tiles_ = TileSolver::make(points.points, settings, pool);
      if (!tiles_) refusal = "a point has too many frames, or this build has no tiles (they need CUDA 13)";
    } catch (const DeviceMemoryError&) {
      if (shared) throw;  // otherwise groups of points need less
    }
  }
  if (shared && !tiles_) throw NotShared("several GPUs share meshless solids alone, and " + refusal);
  if (!tiles_) return;
  for (int i = 0; i < model_.node_count(); ++i) held_.push_back(static_cast<std::uint8_t>(filter_.fixed_of(i)));
  tiles_->set_held(held_);
  if (settings_.preconditioner == PreconditionerKind::none) tiles_->clear_preconditioner();
}

/// Everything that acts on the nodes, into gradient_, load_ and inertia_.
/// @param quantities  energies of blocks too, and what else is judged
template <class Space>
void System<Space>::evaluate_forces(bool quantities) {
  const NodesView& nodes = data_.view().nodes;
  double* motion = part_motion_.data();
  node_parts_.template sum<0, 1>(loops::NodeMotion{nodes, pose()}, motion);
  Space::for_each(model_.points.part_count(), loops::AtLeast{start_motion_.data(), motion});
  blocks_.forces(nodes, pose(), history(), quantities ? motion : nullptr);
  const ForceView f = force_view();
  Space::for_each(nodes.count, kernels::NodeForces{step_view(), blocks_.view(), f, L_.data(), tether_L_.data()});
  add_other_loads();
  Space::for_each(model_.dof_count(), loops::AddInertiaAndLoads{f});
  if (!dependents_.empty()) dependents_.transfer(nodes, gradient_.data(), dependent_forces_.data());
}

/// Loads that are not of one node alone.
template <class Space>
void System<Space>::add_other_loads() {
  const ModelView& m = data_.view();
  moving_.add_forces(m.nodes, pose(), m.factors, load_.data());
  if (moving_.surfaces.empty()) return;
  Space::copy(report_.data() + report_.size() - 3 - moving_.surfaces.figure_count(), moving_.surfaces.figures(),
              moving_.surfaces.figure_count() * sizeof(double));
}

/// Finds what the prescribed degrees of freedom still lack, and how much of it is left (3 numbers at the report's end).
template <class Space>
void System<Space>::find_prescribed() {
  const ModelView& m = data_.view();
  double* out = report_.data() + report_.size() - 3;
  Space::for_each(static_cast<int>(model_.constraints.size()),
                  loops::FindPrescribed{m, pose(), increment_.turned.data(), m.factors, prescribed_.data()});
  Space::template sum<0, 3>(model_.node_count(), loops::PrescribedLeft{step_view(), prescribed_.data()},
                            loops::StoreSums<0, 3>{out});
}

template <class Space>
Evaluation System<Space>::evaluate_anew() {
  evaluate_forces();
  node_parts_.template sum<kNodeQuantities>(loops::NodeReport{data_.view(), force_view()}, report_.data());
  blocks_.sum_quantities(report_.data() + at(model_.points.part_count()) * kNodeQuantities);
  if (!model_.constraints.empty()) find_prescribed();
  report_.download(report_values_);
  return judge();
}

/// From the numbers of an evaluation.
template <class Space>
Evaluation System<Space>::judge() {
  const std::size_t parts = at(model_.points.part_count());
  const double* nodes = report_values_.data();
  const double* blocks = nodes + parts * kNodeQuantities;
  const std::size_t block_kinds = blocks_.report_size() / (parts * kQuantities);
  internal_ = {};
  load_energy_ = inertia_energy_ = 0;
  std::vector<PartForces> forces(parts);
  for (std::size_t p = 0; p < parts; ++p) {
    const double* q = nodes + p * kNodeQuantities;
    double rounding = 0;
    PartSizes sizes{.leverage = dependents_.leverage()[p], .mass = masses_[p], .driven = driven_[p] != 0};
    for (std::size_t b = 0; b < block_kinds; ++b) {
      const double* own = blocks + (b * parts + p) * kQuantities;
      internal_.elastic += own[kElastic];
      internal_.stabilization += own[kStabilizing];
      internal_.viscous += own[kViscous];
      rounding += own[kRounding];
      sizes.tether += own[kTether];
    }
    load_energy_ += q[kLoadEnergy];
    inertia_energy_ += q[kInertiaEnergy];
    sizes.rounding = std::numeric_limits<double>::epsilon() * std::sqrt(rounding);
    if (!moving_.surfaces.empty()) sizes.of_surfaces = moving_.surfaces.rounding(static_cast<int>(p), figures());
    forces[p] = part_forces(q, sizes, step_.h, [&] {
      double motion = 0;
      Space::copy_out(&motion, part_motion_.data() + p, sizeof motion);
      return motion;
    });
  }
  if (!moving_.surfaces.empty()) load_energy_ += moving_.surfaces.potential(figures());
  prescribed_left_ = !model_.constraints.empty() && motions_.lacks(report_values_.data() + report_values_.size() - 3);
  return this->judged(forces);
}

/// Potentials of loads and inertia at the present state, where the internal energy is known.
template <class Space>
void System<Space>::evaluate_loads() {
  Space::for_each(model_.node_count(),
                  kernels::NodeForces{step_view(), BlocksView{}, force_view(), L_.data(), tether_L_.data()});
  add_other_loads();
  node_parts_.template sum<kNodeQuantities>(loops::NodeReport{data_.view(), force_view()}, report_.data());
  report_.download(report_values_);
  load_energy_ = inertia_energy_ = 0;
  for (std::size_t p = 0; p < at(model_.points.part_count()); ++p) {
    load_energy_ += report_values_[p * kNodeQuantities + kLoadEnergy];
    inertia_energy_ += report_values_[p * kNodeQuantities + kInertiaEnergy];
  }
  if (!moving_.surfaces.empty()) load_energy_ += moving_.surfaces.potential(figures());
}

template <class Space>
void System<Space>::note_step(double step) {
  if (!extrapolates_ || use_tiles()) return;
  copy_place(Space(), now_, taken_);
  taken_length_ = step;
}

}  // namespace fascia::gpu
