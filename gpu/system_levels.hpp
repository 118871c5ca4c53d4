#pragma once

#include "gpu/device.hpp"
#include "gpu/system.hpp"

#include <new>

/// The part of System that preconditions conjugate gradients by levels of rigid frames, which the host makes.
namespace fascia::gpu {

/// An automatic preconditioner goes on with levels from the first solve on that ends at its limit of iterations, where
/// no factor of the host takes over and the limit is not a budget that the user set: as on the processor.
template <class Space>
bool System<Space>::levels_may_pay() const {
  return !levels_pay_ && settings_.preconditioner == Preconditioner::automatic &&
         settings_.precision != Precision::single && settings_.devices.size() <= 1 && !host_may_solve() &&
         settings_.cg.max_iterations >= CgOptions{}.max_iterations;
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
  return false;
}

/// Fluids are in no level and in no product of the cycle, as on the processor. Levels of the material part smooth with
/// the whole tangent on the finest level, of which there is one here: where that makes the cycle indefinite, blocks are
/// left.
template <class Space>
CgReport System<Space>::solve_by_levels(const CgOptions& options, bool has_material) {
  if (settings_.precision == Precision::single) return solve_by_blocks(options);
  const std::size_t n = at(model_.dof_count());
  for (auto* array : {&kept_rhs_, &still_, &still_Ap_}) array->resize(n);
  Space::copy(kept_rhs_.data(), cg_.rhs(), n * sizeof(double));
  const auto begin_again = [&] { Space::copy(cg_.rhs(), kept_rhs_.data(), n * sizeof(double)); };
  const auto with_levels = [&]<class T>(T /*of products*/, const CgOptions& few) {
    still_.set_zero();
    idle_.set_zero();  // β = 0: a product of x itself
    const auto product = [&](double* x, double* y) {
      apply_tangent<T, double>({nullptr, nullptr, x, still_.data(), y, idle_.data()}, false);
    };
    return cg_.solve_with([&](const double* r, double* z) { levels_.cycle(r, z, product); }, few, operator_key(),
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
