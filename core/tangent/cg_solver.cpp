#include "core/tangent/cg_solver.hpp"

#include "core/base/clock.hpp"
#include "core/base/parallel_copy.hpp"

#include <algorithm>

namespace fascia {

CgSolver::CgSolver(TangentOperator& K, const LinearSettings& settings, FactorSolver& factor)
    : K_(K), settings_(settings), factor_(factor), levels_(K, false), material_(K, true) {
  choose_one();
}

void CgSolver::choose_one() {
  rounds_ = settings_.precision == Precision::mixed;
  renew_one();
}

void CgSolver::renew_one() {
  one_is_ready_ = false;
  one_ = preconditioner_of(settings_.preconditioner, K_, factor_);
  if (!one_) one_ = std::make_unique<DiagonalBlocks>(K_, true);
}

namespace {

/// Loops of conjugate gradients that each do what they can to a vector while they have it.
struct TangentLoops {
  TangentOperator& K;
  Preconditioner& M;
  bool rounded;
  using Vector = CpuVectors::Vector;

  double begin(const Vector& r, Vector& z) const { return M.apply(r, z); }
  double direct(const Vector& z, double s, Vector& p, Vector& Ap) const {
    return K.apply_free_next(z, s, p, Ap, rounded);
  }
  double advance(double s, const Vector& p, const Vector& Ap, Vector& x, Vector& r, Vector& z) const {
    return M.advance(K.vectors(), s, p, Ap, x, r, z);
  }
};

}  // namespace

CgReport CgSolver::iterate(Preconditioner& M, const Vector& b, Vector& x, const CgOptions& options, bool rounded) {
  M.begin();
  return conjugate_gradients(K_.vectors(), TangentLoops{K_, M, rounded}, b, x, work_, options);
}

CgReport CgSolver::solve_with(Preconditioner& M, const Vector& b, Vector& x, const CgOptions& options) {
  if (!rounds_ || exact_) return iterate(M, b, x, options, false);
  const CgReport rounded = iterate(M, b, x, options, true);
  if (rounded.status == CgStatus::converged || rounded.status == CgStatus::limit) return rounded;
  CgReport exact = iterate(M, b, x, options, false);
  rounds_ = exact.status == CgStatus::negative_curvature;
  exact.iterations += rounded.iterations;
  return exact;
}

CgReport CgSolver::solve_by_one(const Vector& b, Vector& x, const CgOptions& options) {
  if (!one_is_ready_ && !one_->prepare()) return {CgStatus::not_finite, 0, 0, 0};
  const CgReport cg = solve_with(*one_, b, x, options);
  one_is_ready_ = one_->took(cg.iterations);
  return cg;
}

CgReport CgSolver::solve_by_levels(const Vector& b, Vector& x, const CgOptions& options) {
  return kept_levels_.solve(
      options, K_.has_tamer(), [this](bool material) { return make_levels(material); },
      [&](bool material, const CgOptions& few) { return solve_with(material ? material_ : levels_, b, x, few); },
      [&](const CgOptions& all) { return solve_by_one(b, x, all); });
}

/// A factor with a solve takes less time than so many iterations with blocks. From 900 unknowns to 70,000, on one
/// thread of an EPYC and of a Xeon, it took 60 to 4,000 of them: within a third of this but for the smallest, of which
/// it took more.
bool CgSolver::factor_takes_less(double iterations) {
  constexpr double kAlways = 100, kOperations = 4;  // for each number of the matrix, in the time of an iteration
  return iterations > kAlways &&
         !factor_.takes_more_than((iterations - kAlways) * kOperations * factor_.matrix_numbers()) && factor_.fits();
}

/// Where time limits a solve, blocks may have all that is left, and levels have no time to be made. But a factor takes
/// over from blocks that gain nothing, or have no time to show it, where it is the cheaper of the two.
CgReport CgSolver::solve_by_either(const Vector& b, Vector& x, const CgOptions& options) {
  const bool chosen = settings_.linear == LinearMethod::automatic && settings_.cg.max_iterations >= kEnoughForBulk,
             leaves = chosen && !exact_;
  const auto by_levels = [&] {
    const int made = kept_levels_.made();
    const CgReport cg = solve_by_levels(b, x, options);
    blocks_or_levels_.took(cg.iterations, kept_levels_.made() - made);
    hands_over_ =
        leaves && !options.timed && blocks_or_levels_.disappoint() && factor_takes_less(blocks_or_levels_.recent());
    return cg;
  };
  if (levels_are_taken()) return by_levels();
  const bool factor = leaves && options.timed && factor_takes_less(blocks_or_levels_.expected());
  const bool limited = chosen && !kept_levels_.fail() && (!options.timed || factor);
  const CgOptions by_blocks = limited ? blocks_or_levels_.limited(options) : options;
  const CgReport tried = solve_by_one(b, x, by_blocks);
  if (tried.status != CgStatus::limit) return tried;
  if (options.timed) {
    hands_over_ = factor && (tried.iterations < options.max_iterations ||
                             (tried.iterations <= by_blocks.look && tried.relative_residual > by_blocks.hope));
    return tried;
  }
  if (options.max_iterations < kEnoughForBulk || kept_levels_.fail()) return tried;
  hands_over_ = leaves && factor_takes_less(blocks_or_levels_.expected());
  if (hands_over_) return tried;
  blocks_or_levels_.turn_to_levels();
  renew_one();  // what it holds may go: levels have the same of their own
  CgReport cg = by_levels();
  cg.iterations += tried.iterations;
  return cg;
}

void CgSolver::begin_afresh() {
  choose_one();
  pattern_ = K_.pattern_revision();
  levels_.forget();
  material_.forget();
  hands_over_ = false;
  kept_levels_ = {};
  blocks_or_levels_ = BlocksOrLevels({});
}

LinearReport CgSolver::solve(std::span<const double> b, std::span<double> x, double rough) {
  CgOptions options = settings_.cg;
  options.tolerance = std::max(options.tolerance, rough);
  if (rough == 0 && !rounds_) options.aim = aim_;
  return solve(b, x, options);
}

CgReport CgSolver::solve_as_asked(const Vector& b, Vector& x, const CgOptions& options) {
  switch (settings_.preconditioner) {
    case PreconditionerKind::automatic:
      return solve_by_either(b, x, options);
    case PreconditionerKind::multigrid:
      return solve_by_levels(b, x, options);
    default:
      return solve_by_one(b, x, options);
  }
}

LinearReport CgSolver::solve(std::span<const double> b, std::span<double> x, const CgOptions& asked) {
  const Clock::time_point start = Clock::now();
  CgOptions options = asked;
  if (limited_) {
    options.max_iterations = std::clamp(left_, 1, options.max_iterations);
    options.timed = true;
  }
  found_.clear();
  copy_into(K_.pool(), b, b_);
  LinearReport report = report_of(solve_as_asked(b_, found_, options), x);
  left_ -= report.iterations;
  report.seconds = seconds_since(start);
  return report;
}

LinearReport CgSolver::solve_by(Preconditioner& M, std::span<const double> b, std::span<double> x,
                                const CgOptions& asked) {
  found_.clear();
  copy_into(K_.pool(), b, b_);
  return report_of(iterate(M, b_, found_, asked, false), x);
}

LinearReport CgSolver::report_of(const CgReport& cg, std::span<double> x) const {
  copy_parallel(K_.pool(), std::span(found_), x);
  LinearReport report;
  report.iterations = cg.iterations;
  report.negative = cg.status == CgStatus::negative_curvature ? 1 : 0;
  if (report.negative > 0) report.trouble = "CG met negative curvature";
  report.usable = cg.status != CgStatus::not_finite;
  if (!report.usable) report.trouble = found_.empty() ? one_->trouble() : "CG met a number that is not finite";
  report.unsolved = cg.status == CgStatus::limit;
  report.residual = cg.relative_norm;
  return report;
}

}  // namespace fascia
