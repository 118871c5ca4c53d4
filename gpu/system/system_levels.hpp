#pragma once

#include "gpu/space/device.hpp"
#include "gpu/system/system.hpp"

#include <new>

/// The part of System that preconditions conjugate gradients by levels of rigid frames, which the host makes.
namespace fascia::gpu {

/// Levels are made by the host, at some 4 us a node. An iteration with blocks takes 50 us, and 2 ns a node (an H200
/// beside 16 cores).
template <class Space>
BlocksOrLevels::Costs System<Space>::costs_of_levels() const {
  const double nodes = model_.node_count();
  return {.cycle = 2, .making = 20 + 0.08 * nodes / (1 + nodes / 25000)};
}

/// An automatic preconditioner goes on with levels where blocks have taken too long, no factor of the host takes over,
/// which in dynamics would be made in every step, and the limit of iterations is no budget, of the user or of a step's
/// time: as on the processor.
template <class Space>
bool System<Space>::levels_may_pay() const {
  return !blocks_or_levels_.levels() && !kept_levels_.fail() && levels_fit_ &&
         settings_.preconditioner == PreconditionerKind::automatic && settings_.precision != Precision::single &&
         settings_.devices.size() <= 1 && ((step_.h > 0 && tiles_ == nullptr) || !host_may_solve()) &&
         settings_.cg.max_iterations >= CgOptions{}.max_iterations && most_iterations_ == kAsManyAsNeeded;
}

/// Limits a solve with blocks that levels may follow. Tiles, far faster than what levels need in their place, and
/// solvers that the user chose, go on to their limit.
template <class Space>
CgOptions System<Space>::before_levels() const {
  if (settings_.linear != LinearMethod::automatic || tiles_ != nullptr) return settings_.cg;
  CgOptions options = solve_options();
  options.max_iterations = std::min(options.max_iterations, blocks_or_levels_.patience());
  return options;
}

/// @return  false where a level is not positive definite, or memory ends
template <class Space>
bool System<Space>::make_levels(bool material) {
  if (!levels_fit_) return false;
  try {
    host().stand_in(step_in_progress());
    const Multigrid* made = host().levels(material);
    if (made == nullptr) return false;
    levels_.take(*made, data_.view().nodes);
    return true;
  } catch (const std::bad_alloc&) {
    levels_fit_ = false;
  } catch (const DeviceMemoryError&) {
    levels_fit_ = false;
  }
  levels_.clear();
  return false;
}

/// Fluids are in no level and in no product of the cycle, as on the processor.
template <class Space>
CgReport System<Space>::solve_by_levels(const CgOptions& options, bool has_material) {
  if (settings_.precision == Precision::single) return solve_by_blocks(options);
  const std::size_t n = at(model_.dof_count());
  kept_rhs_.resize(n);
  Space::copy(kept_rhs_.data(), cg_.rhs(), n * sizeof(double));
  const auto begin_again = [&] { Space::copy(cg_.rhs(), kept_rhs_.data(), n * sizeof(double)); };
  const auto with_levels = [&]<class T>(T /*of products*/, const CgOptions& few) {
    return cg_.solve_with([&](const double* r, double* z) { levels_.cycle(r, z); }, few, operator_key(),
                          [&](const CgView<double>& v) { apply_tangent<T, double>(v); });
  };
  return kept_levels_.solve(
      options, has_material, [&](bool material) { return make_levels(material); },
      [&](bool /*material*/, const CgOptions& few) {
        begin_again();
        return settings_.precision == Precision::mixed ? with_levels(0.0F, few) : with_levels(0.0, few);
      },
      [&](const CgOptions& all) {
        begin_again();
        return solve_by_blocks(all);
      });
}

}  // namespace fascia::gpu
