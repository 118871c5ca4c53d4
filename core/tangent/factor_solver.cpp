#include "core/tangent/factor_solver.hpp"

#include "core/linear/cg.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

/// An indefinite tangent is shifted by this part of its material diagonal first.
constexpr double kSmallestShift = 1e-6;

}  // namespace

void FactorSolver::follow_pattern() {
  if (pattern_ == K_.pattern_revision()) return;
  pattern_ = K_.pattern_revision();
  order_.reset();
  cholesky_.reset();
  definite_ = false;
}

const EliminationOrder& FactorSolver::order() {
  follow_pattern();
  if (!order_ || order_->rough) order_ = EliminationOrder::of(K_.pattern(), K_.filter());
  return *order_;
}

bool FactorSolver::takes_more_than(double flops) {
  follow_pattern();
  if (!order_) order_ = EliminationOrder::of(K_.pattern(), K_.filter(), flops);
  return order_->exceeds(flops) || order().flops > flops;
}

BlockCholesky& FactorSolver::cholesky() {
  follow_pattern();
  if (!cholesky_) cholesky_.emplace(K_.pattern(), K_.filter(), &order(), &K_.pool());
  return *cholesky_;
}

double FactorSolver::matrix_numbers() {
  const BlockMatrix& matrix = K_.pattern();
  return static_cast<double>(matrix.read_count()) * (matrix.fills_upper() ? 2 : 1);
}

bool FactorSolver::fits() {
  return sizeof(double) * order().numbers <= kMostBytes && cholesky().number_bytes() <= kMostBytes;
}

/// K + Σ k g gᵀ has as many negative eigenvalues as K, less those that the terms lift.
void FactorSolver::renew_terms() {
  shifted_ = false;
  K_.beside().prepare([&](std::span<const double> g, std::span<double> z) { cholesky_->solve(g, z); });
  negative_ = std::max(0, cholesky_->negative_pivots() - K_.beside().lifted());
  definite_ = negative_ == 0;
}

bool FactorSolver::prepare_with(Pivots pivots) {
  definite_ = false;
  if (!cholesky().factorize(K_.matrix(), pivots)) return false;
  renew_terms();
  return true;
}

bool FactorSolver::prepare_any() { return prepare_with(Pivots::any); }

/// The matrix alone may not be positive definite where it is with the terms beside it: an enclosed fluid holds a wall
/// that could not hold itself.
bool FactorSolver::prepare() {
  prepare_with(K_.beside().empty() ? Pivots::positive : Pivots::any);
  return definite_;
}

/// Shifts start small, since those that are larger than need be shorten every step, and come down again.
bool FactorSolver::prepare_shifted() {
  constexpr double kLargest = 1e3, kDown = 0.1, kUp = 4;
  const BlockMatrix& shift_from = K_.material_part(Entries::diagonal);
  for (shift_ = std::max(kSmallestShift, kDown * shift_); shift_ < kLargest; shift_ *= kUp)
    if (cholesky().factorize(K_.matrix(), Pivots::positive, shift_, &shift_from)) {
      renew_terms();
      definite_ = false;
      shifted_ = true;
      return true;
    }
  return false;
}

bool FactorSolver::preconditions() {
  follow_pattern();
  return definite_ && cholesky_ && cholesky_->negative_pivots() == 0;
}

void FactorSolver::renew_terms_of_preconditioner() {
  K_.beside().prepare([&](std::span<const double> g, std::span<double> z) { cholesky_->precondition(g, z); });
}

void FactorSolver::precondition(std::span<const double> b, std::span<double> x) {
  cholesky_->precondition(b, x);
  K_.beside().correct(b, x);
}

void FactorSolver::apply_inverse(std::span<const double> b, std::span<double> x) {
  cholesky_->solve(b, x);
  K_.beside().correct(b, x);
}

LinearReport FactorSolver::solve(std::span<const double> b, std::span<double> x, double /*rough*/) {
  apply_inverse(b, x);
  if (shifted_) finish_shifted(b, x);
  LinearReport report;
  report.negative = negative_;
  report.usable = std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  return report;
}

/// Where the smallest shift is enough, a few soft directions alone are indefinite, and a slender body has softer ones
/// beside them: conjugate gradients with the shifted factor as a preconditioner give those their full step, and stop
/// at the first direction of negative curvature, which they take as far as if it were as stiff upwards.
void FactorSolver::finish_shifted(std::span<const double> b, std::span<double> x) {
  constexpr CgOptions kOptions{30, 1e-6};
  if (shift_ > kSmallestShift) return;
  const CpuVectors& vectors = K_.vectors();
  CpuVectors::Vector result;
  const CgReport cg = conjugate_gradients(
      vectors, [&](const auto& p, auto& Ap) { K_.apply_free(p, Ap); },
      [&](const auto& r, auto& z) {
        apply_inverse(r, z);
        return vectors.dot(r, z);
      },
      CpuVectors::Vector(b.begin(), b.end()), result, kOptions, NegativeCurvature::reflected);
  const double descent = vectors.dot(b, result);  // else the shifted solution stays
  if (cg.status != CgStatus::not_finite && std::isfinite(descent) && descent > 0)
    std::copy(result.begin(), result.end(), x.begin());
}

bool FactorSolver::solve_refined(std::span<const double> b, std::span<double> x) {
  constexpr double kSpoilt = 1e-2;
  rest_.assign(b.begin(), b.end());
  correction_.resize(b.size());
  apply_inverse(rest_, x);
  K_.apply_free(x, correction_);
  for (std::size_t i = 0; i < b.size(); ++i) rest_[i] -= correction_[i];
  apply_inverse(rest_, correction_);
  double squared = 0, change = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    squared += x[i] * x[i];
    change += correction_[i] * correction_[i];
    x[i] += correction_[i];
  }
  return std::isfinite(squared) && std::sqrt(change) <= kSpoilt * std::sqrt(squared);
}

}  // namespace fascia
