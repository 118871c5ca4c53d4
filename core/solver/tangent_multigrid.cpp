#include "core/solver/tangent_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The part of TangentSolver that preconditions conjugate gradients by levels of rigid frames.
namespace fascia {

void TangentSolver::note_places(const Linearization& lin) {
  if (settings_.preconditioner != Preconditioner::multigrid && settings_.preconditioner != Preconditioner::automatic)
    return;
  places_.x = model_.rest_position;
  for (std::size_t i = 0; i < lin.u.size(); ++i) places_.x[i] += lin.u[i];
  places_.Q = lin.Q;
}

/// @param material  from the part of the tangent that is definite whatever the stress
/// @return          false where a level is not positive definite
bool TangentSolver::build_multigrid(bool material) {
  if (material) {
    if (!material_matrix_) material_matrix_.emplace(model_.points);
    assemble((*relinearize_)(TamerTangent::material), *material_matrix_);
  }
  return build_levels(material);
}

/// Of a matrix that was assembled.
bool TangentSolver::build_levels(bool material) {
  std::optional<Multigrid>& levels = material ? material_multigrid_ : multigrid_;
  const BlockMatrix& from = material ? *material_matrix_ : matrix();
  if (!levels) levels.emplace(from, filter_, executor_.pool());
  build_block_jacobi(from);
  return levels->build(places_, inverse_blocks_, [this, &from](std::span<const double> x, std::span<double> y) {
    apply_blocks(from, x, y);
    filter_.clear_fixed(y);
  });
}

const Multigrid* TangentSolver::levels(const Linearization& lin, bool material) {
  if (material && !material_matrix_) material_matrix_.emplace(model_.points);
  work_.resize(at(model_.dof_count()));
  assemble(lin, material ? *material_matrix_ : matrix());
  if (!build_levels(material)) return nullptr;
  return material ? &*material_multigrid_ : &*multigrid_;
}

/// Conjugate gradients with levels. An indefinite cycle, with which they mean nothing, ends as `not_finite`.
CgReport TangentSolver::solve_with_levels(Multigrid& levels, const CpuVectors::Vector& b, CpuVectors::Vector& x,
                                          const CgOptions& options) {
  double start = 0;
  return solve_cg_with(
      [&](const auto& r, auto& z) {
        const double rz = levels.precondition(r, z);
        const bool first = start == 0;
        if (first) start = std::abs(rz);
        // Where nothing but rounding is left its sign says nothing.
        const bool indefinite = first ? rz < 0 || (rz == 0 && vectors_.dot(r, r) > 0) : rz < -kCycleRounding * start;
        return indefinite ? std::numeric_limits<double>::quiet_NaN() : rz;
      },
      b, x, options);
}

CgReport TangentSolver::solve_by_multigrid(const CpuVectors::Vector& b, CpuVectors::Vector& x,
                                           const CgOptions& options) {
  return kept_levels_.solve(
      options, relinearize_ != nullptr, [&](bool material) { return build_multigrid(material); },
      [&](bool material, const CgOptions& few) {
        return solve_with_levels(material ? *material_multigrid_ : *multigrid_, b, x, few);
      },
      [&](const CgOptions& all) { return solve_by_blocks(b, x, all); });
}

}  // namespace fascia
