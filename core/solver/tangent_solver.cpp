#include "core/solver/tangent_solver.hpp"

#include "core/base/clock.hpp"
#include "core/base/index.hpp"
#include "core/node/positive_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fascia {

namespace {

/// A limit of CG below this is a budget that the user set, and not too small a guess of ours.
constexpr int kEnoughForBulk = 1000;
constexpr int kNodeChunk = 512;

/// An indefinite tangent is shifted by this part of its material diagonal first.
constexpr double kSmallestShift = 1e-6;

/// y = B x; returns x · y.
template <int N>
double apply_block(const double* B, const double* x, double* y) {
  double dot = 0;
  for (int i = 0; i < N; ++i) {
    double sum = 0;
    for (int j = 0; j < N; ++j) sum += B[N * i + j] * x[j];
    y[i] = sum;
    dot += x[i] * sum;
  }
  return dot;
}

double flops_per_number(const EliminationOrder& order, const BlockMatrix& matrix) {
  return order.flops / (static_cast<double>(matrix.value_count()) * (matrix.fills_upper() ? 2 : 1));
}

}  // namespace

TangentSolver::TangentSolver(const Model& model, CpuExecutor& executor, const DofFilter& filter,
                             const SolverSettings& settings)
    : model_(model),
      executor_(executor),
      filter_(filter),
      settings_(settings),
      vectors_(executor.pool()),
      dependents_(model.points) {}

BlockMatrix& TangentSolver::matrix() {
  if (!matrix_) matrix_.emplace(model_.points);
  return *matrix_;
}

const EliminationOrder& TangentSolver::order() {
  if (!order_) order_ = EliminationOrder::of(matrix(), filter_);
  return *order_;
}

BlockCholesky& TangentSolver::factor() {
  if (!cholesky_) cholesky_.emplace(matrix(), filter_, Pivots::positive, &order());
  return *cholesky_;
}

bool TangentSolver::direct() {
  if (direct_) return *direct_;
  if (settings_.linear != LinearMethod::automatic)
    direct_ = settings_.linear == LinearMethod::cholesky;
  else if (filter_.free_count() <= kDirectDofs)
    direct_ = true;
  else
    direct_ = order().fits() && flops_per_number(order(), matrix()) < kFlopsPerNumber;
  return *direct_;
}

SolverChoice TangentSolver::choice() const {
  SolverChoice made;
  made.direct = direct_.value_or(true);
  made.preconditioner = levels_are_taken() ? Preconditioner::multigrid : settings_.preconditioner;
  if (multigrid_) made.levels = multigrid_->level_sizes();
  if (!order_) return made;
  made.flops = order_->flops;
  made.numbers = order_->numbers;
  made.flops_per_number = flops_per_number(*order_, *matrix_);
  return made;
}

bool TangentSolver::factor_fits() {
  return order().fits() && sizeof(double) * order().numbers <= kMostFactorBytes &&
         factor().factor_bytes() <= kMostFactorBytes;
}

bool TangentSolver::gives_way_to_factor(long iterations) {
  const bool guessed = settings_.linear == LinearMethod::automatic && settings_.cg.max_iterations >= kEnoughForBulk;
  return guessed && iterations >= settings_.cg.max_iterations && factor_fits();
}

bool TangentSolver::cg_is_too_slow(const TangentReport& report) {
  if (!report.usable || !report.unsolved || !gives_way_to_factor(report.iterations)) return false;
  direct_ = true;
  return true;
}

void TangentSolver::assemble(const Linearization& lin, BlockMatrix& out, Entries entries) {
  note_places(lin);
  executor_.assemble(lin, out, dependents_.empty() ? entries : Entries::all);
  if (dependents_.empty()) return;
  dependents_.turn(lin.Q);
  dependents_.condense(out);
}

void TangentSolver::apply_blocks(const BlockMatrix& matrix, std::span<const double> local, std::span<double> out) {
  if (!filter_.turns()) return matrix.multiply(executor_.pool(), local, out);
  std::copy(local.begin(), local.end(), work_.begin());
  filter_.to_global(work_);
  matrix.multiply(executor_.pool(), work_, out);
  filter_.to_local(out);
}

void TangentSolver::apply_matrix(std::span<const double> local, std::span<double> out) {
  apply_blocks(matrix(), local, out);
  low_rank_.add_product(local, out);
}

void TangentSolver::solve_with_factor(std::span<const double> b, std::span<double> x) {
  solving_->solve(b, x);
  low_rank_.correct([&](std::span<const double> g, std::span<double> z) { solving_->solve(g, z); }, b, x);
}

TangentReport TangentSolver::solve(const Linearization& lin, std::span<const double> prescribed,
                                   std::span<const double> b, std::span<double> x, const Relinearize& relinearize) {
  const std::size_t n = b.size();
  work_.resize(n);
  relinearize_ = &relinearize;
  const struct Lent {
    const Relinearize*& within;
    ~Lent() { within = nullptr; }
  } lent{relinearize_};
  assemble(lin, matrix());
  low_rank_.set(lin.low_rank, filter_);
  if (!lin.symmetric() && filter_.free_count() > 0) {
    if (std::optional<TangentReport> exact = solve_unsymmetric(lin, prescribed, b, x, relinearize)) {
      take_prescribed(prescribed, x);
      return *exact;
    }
    assemble(lin, matrix());
  }
  rhs_.assign(b.begin(), b.end());
  if (!prescribed.empty()) {
    solution_.resize(n);
    apply_matrix(prescribed, solution_);
    for (std::size_t i = 0; i < n; ++i) rhs_[i] -= solution_[i];
  }
  filter_.clear_fixed(rhs_);
  TangentReport report;
  if (filter_.free_count() == 0) {
    std::fill(x.begin(), x.end(), 0.0);
  } else if (direct()) {
    if (!factorize(relinearize, report)) return report;
    solve_with_factor(rhs_, x);
    if (shifted_) finish_shifted(x);
  } else {
    report = solve_cg(rhs_, x);
    if (!report.trouble.empty() && !model_.tethers.empty()) {
      assemble(relinearize(TamerTangent::without_tethers), matrix());
      report = solve_cg(rhs_, x);
    }
    if (cg_is_too_slow(report)) {
      const int iterations = report.iterations;
      report = {};
      if (!factorize(relinearize, report)) return report;
      solve_with_factor(rhs_, x);
      if (shifted_) finish_shifted(x);
      report.iterations = iterations;
    }
  }
  if (!std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); }))
    return {false, report.iterations, "the linear solver returned a number that is not finite"};
  take_prescribed(prescribed, x);
  return report;
}

void TangentSolver::take_prescribed(std::span<const double> prescribed, std::span<double> x) const {
  for (std::size_t i = 0; i < prescribed.size(); ++i)
    if (filter_.is_fixed(i)) x[i] = prescribed[i];
}

bool TangentSolver::factorize(const Relinearize& relinearize, TangentReport& report) {
  shifted_ = false;
  solving_ = &factor();
  definite_ = solving_->factorize(matrix()) || definite_with_low_rank();
  if (definite_) return true;
  if (!model_.tethers.empty()) {
    assemble(relinearize(TamerTangent::without_tethers), matrix());
    if (factor().factorize(matrix())) return true;
  }
  shifted_ = shift_until_definite(relinearize);
  if (shifted_) {
    report.trouble = "the tangent was not positive definite (buckling, or parts that nothing holds); it was shifted";
    return true;
  }
  report.usable = false;
  report.trouble = "the tangent stays indefinite under every shift";
  return false;
}

/// The matrix alone is not positive definite, and may be with the terms beside it: an enclosed fluid holds a wall that
/// could not hold itself. K + Σ k g gᵀ has as many negative eigenvalues as K, less those that the terms lift.
bool TangentSolver::definite_with_low_rank() {
  if (low_rank_.empty()) return false;
  const std::optional<int> negative = factorize_any();
  if (!negative || *negative > low_rank_.count()) return false;
  solving_ = &*indefinite_;
  std::vector<double> none(rhs_.size(), 0.0), unused(rhs_.size(), 0.0);
  low_rank_.correct([&](std::span<const double> g, std::span<double> z) { solving_->solve(g, z); }, none, unused);
  if (low_rank_.lifted() == *negative) return true;
  solving_ = &factor();
  return false;
}

/// L D Lᵀ of the matrix as it is; its negative pivots, none where one vanishes.
std::optional<int> TangentSolver::factorize_any() {
  if (!indefinite_) indefinite_.emplace(matrix(), filter_, Pivots::any, &order());
  if (!indefinite_->factorize(matrix())) return std::nullopt;
  return indefinite_->negative_pivots();
}

/// Shifts start small, since those that are larger than need be shorten every step, and come down again.
bool TangentSolver::shift_until_definite(const Relinearize& relinearize) {
  constexpr double kLargest = 1e3, kDown = 0.1, kUp = 4;
  if (!material_matrix_) material_matrix_.emplace(model_.points);
  assemble(relinearize(TamerTangent::material), *material_matrix_, Entries::diagonal);
  for (shift_ = std::max(kSmallestShift, kDown * shift_); shift_ < kLargest; shift_ *= kUp)
    if (factor().factorize(matrix(), shift_, &*material_matrix_)) return true;
  return false;
}

/// Where the smallest shift is enough, a few soft directions alone are indefinite, and a slender body has softer ones
/// beside them: conjugate gradients with the shifted factor as a preconditioner give those their full step, and stop
/// at the first direction of negative curvature, which they take as far as if it were as stiff upwards.
void TangentSolver::finish_shifted(std::span<double> x) {
  constexpr CgOptions kOptions{30, 1e-6};
  if (shift_ > kSmallestShift) return;
  CpuVectors::Vector result;
  const CgReport cg = conjugate_gradients(
      vectors_,
      [&](const std::vector<double>& p, std::vector<double>& Ap) {
        apply_matrix(p, Ap);
        filter_.clear_fixed(Ap);
      },
      [&](const auto& r, auto& z) {
        solve_with_factor(r, z);
        return vectors_.dot(r, z);
      },
      CpuVectors::Vector(rhs_.begin(), rhs_.end()), result, kOptions, NegativeCurvature::reflected);
  const double descent = vectors_.dot(rhs_, result);  // else the shifted solution stays
  if (cg.status != CgStatus::not_finite && std::isfinite(descent) && descent > 0)
    std::copy(result.begin(), result.end(), x.begin());
}

void TangentSolver::build_block_jacobi(const BlockMatrix& matrix) {
  const bool blocks = settings_.preconditioner != Preconditioner::jacobi;
  const DofLayout& dofs = model_.points.dofs;
  inverse_blocks_.resize(dofs.block_total());
  executor_.pool().for_ranges(model_.node_count(), 128, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      const int n = dofs.size(node);
      double* block = inverse_blocks_.data() + dofs.block_begin(node);
      filter_.rotate_block(node, node, matrix.block(matrix.diagonal(node)), block);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const bool held = filter_.is_fixed(at(dofs.begin(node) + i)) || filter_.is_fixed(at(dofs.begin(node) + j));
          if (held || (!blocks && i != j)) block[n * i + j] = i == j ? 1 : 0;
        }
      }
      positive_inverse(block, n);
    }
  });
}

CgReport TangentSolver::solve_by_blocks(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options) {
  build_block_jacobi(*matrix_);
  const DofLayout& dofs = model_.points.dofs;
  const auto precondition = [&](const std::vector<double>& r, std::vector<double>& z) {
    executor_.pool().for_ranges(model_.node_count(), kNodeChunk, [&](int begin, int end) {
      double sum = 0;
      for (int node = begin; node < end; ++node) {
        const double* inverse = inverse_blocks_.data() + dofs.block_begin(node);
        const std::size_t first = at(dofs.begin(node));
        switch (dofs.size(node)) {
          case 3:
            sum += apply_block<3>(inverse, r.data() + first, z.data() + first);
            break;
          case 6:
            sum += apply_block<6>(inverse, r.data() + first, z.data() + first);
            break;
          default:
            sum += apply_block<12>(inverse, r.data() + first, z.data() + first);
        }
      }
      chunk_sums_[at(begin / kNodeChunk)] = sum;
    });
    return std::accumulate(chunk_sums_.begin(), chunk_sums_.end(), 0.0);
  };
  chunk_sums_.resize(at((model_.node_count() + kNodeChunk - 1) / kNodeChunk));
  return solve_cg_with(precondition, b, x, options);
}

CgReport TangentSolver::solve_by_factor(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options) {
  const CgReport cg = solve_cg_with(
      [&](const auto& r, auto& z) {
        factor().solve(r, z);
        return vectors_.dot(r, z);
      },
      b, x, options);
  if (cg.iterations > 30) factor_is_preconditioner_ = false;  // out of date: renewed next time
  return cg;
}

/// Blocks precondition; levels of rigid frames do from the first solve on that ends at its limit of iterations, where
/// the limit is not a budget that the user set. Where the program chose conjugate gradients itself, they do as soon as
/// they are likely to be cheaper, and hand back where they are not.
CgReport TangentSolver::solve_by_either(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options) {
  const auto by_levels = [&] {
    const int made = kept_levels_.made();
    const CgReport cg = solve_by_multigrid(b, x, options);
    blocks_or_levels_.took(cg.iterations, kept_levels_.made() - made);
    return cg;
  };
  if (levels_are_taken()) return by_levels();
  const bool budget = options.max_iterations < kEnoughForBulk, chosen = settings_.linear == LinearMethod::automatic;
  CgOptions first = options;
  if (chosen && !budget && !kept_levels_.fail())
    first.max_iterations = std::min(options.max_iterations, blocks_or_levels_.patience());
  const CgReport tried = solve_by_blocks(b, x, first);
  if (tried.status != CgStatus::limit || budget || kept_levels_.fail()) return tried;
  blocks_or_levels_.turn_to_levels();
  CgReport cg = by_levels();
  cg.iterations += tried.iterations;
  return cg;
}

TangentReport TangentSolver::solve_cg(std::span<const double> b, std::span<double> x, const CgOptions& options) {
  const Clock::time_point start = Clock::now();
  const CpuVectors::Vector rhs(b.begin(), b.end());
  CpuVectors::Vector result;
  CgReport cg;
  switch (settings_.preconditioner) {
    case Preconditioner::none:
      cg = solve_cg_with(
          [&](const auto& r, auto& z) {
            z = r;
            return vectors_.dot(r, z);
          },
          rhs, result, options);
      break;
    case Preconditioner::cholesky:
      if (!factor_is_preconditioner_) factor_is_preconditioner_ = factor().factorize(matrix());
      if (!factor_is_preconditioner_)
        return {false, 0, "the tangent is not positive definite: no Cholesky preconditioner"};
      cg = solve_by_factor(rhs, result, options);
      break;
    case Preconditioner::multigrid:
      cg = solve_by_multigrid(rhs, result, options);
      break;
    case Preconditioner::automatic:
      cg = solve_by_either(rhs, result, options);
      break;
    case Preconditioner::jacobi:
    case Preconditioner::block_jacobi:
      cg = solve_by_blocks(rhs, result, options);
  }
  std::copy(result.begin(), result.end(), x.begin());
  TangentReport report;
  report.iterations = cg.iterations;
  if (cg.status == CgStatus::negative_curvature) report.trouble = "CG met negative curvature";
  if (cg.status == CgStatus::not_finite) report.trouble = "CG met a number that is not finite";
  report.usable = cg.status != CgStatus::not_finite;
  report.unsolved = cg.status == CgStatus::limit;
  report.residual = cg.relative_norm;
  report.cg_seconds = seconds_since(start);
  return report;
}

}  // namespace fascia
