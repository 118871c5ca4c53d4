#include "core/solver/tangent_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The part of TangentSolver that preconditions conjugate gradients by levels of rigid frames.
namespace fascia {

namespace {

constexpr double kRounding = 1e-12;  ///< of r · z at the start, of which the sign means nothing

}  // namespace

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
  std::optional<Multigrid>& levels = material ? material_multigrid_ : multigrid_;
  const BlockMatrix& from = material ? *material_matrix_ : matrix();
  if (!levels) levels.emplace(from, filter_, executor_.pool());
  build_block_jacobi(from);
  levels_iterations_ = 0;
  return levels->build(places_, inverse_blocks_, [this, &from](std::span<const double> x, std::span<double> y) {
    apply_blocks(from, x, y);
    filter_.clear_fixed(y);
  });
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
        const bool indefinite = first ? rz < 0 || (rz == 0 && vectors_.dot(r, r) > 0) : rz < -kRounding * start;
        return indefinite ? std::numeric_limits<double>::quiet_NaN() : rz;
      },
      b, x, options);
}

/// Levels are kept while the iterations that they take grow by less than half: making them costs as much as ten. Those
/// of an indefinite tangent are made again from its material part; where no levels are definite, blocks are left.
CgReport TangentSolver::solve_by_multigrid(const CpuVectors::Vector& b, CpuVectors::Vector& x,
                                           const CgOptions& options) {
  using enum CgStatus;
  int before = 0;
  const auto counted = [&](CgReport report) {
    report.iterations += before;
    return report;
  };
  if (levels_iterations_ > 0 && levels_tolerance_ == options.tolerance) {
    CgOptions few = options;
    few.max_iterations = std::min(options.max_iterations, levels_iterations_ + levels_iterations_ / 2 + 2);
    const CgReport report = solve_with_levels(*multigrid_, b, x, few);
    if (report.status == converged) return report;
    before = report.iterations;
  }
  if (!material_first_ || relinearize_ == nullptr) {
    CgReport report{not_finite, 0, 0, 0};
    if (build_multigrid(false)) report = solve_with_levels(*multigrid_, b, x, options);
    if (report.status == converged && report.iterations > 0) {
      levels_iterations_ = report.iterations;
      levels_tolerance_ = options.tolerance;
    }
    if (report.status == converged || report.status == limit) return counted(report);
    before += report.iterations;
    if (relinearize_ == nullptr && report.status == negative_curvature) return counted(report);
  }
  if (relinearize_ != nullptr && build_multigrid(true)) {
    const CgReport report = solve_with_levels(*material_multigrid_, b, x, options);
    material_first_ = report.status == negative_curvature;
    if (report.status != not_finite) return counted(report);
    before += report.iterations;
  }
  material_first_ = false;
  return counted(solve_by_blocks(b, x, options));
}

}  // namespace fascia
