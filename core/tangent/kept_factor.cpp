#include "core/tangent/kept_factor.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

/// A direction that leaves more is none of Newton's method.
constexpr double kMostLeft = 1e-2;

/// What a kept factor is taken to do where nothing is known yet: solves for each, and iterations for each solve. Of
/// shells, tissues and what ties them, swinging or breathing in steps of 1 to 20 ms, one served 10 to 110 solves of 2
/// to 6 iterations; of what spins by 0.1 rad in a step 7 to 15.
constexpr double kServed = 15, kIterations = 5;

/// Nanoseconds that the blocks of a tangent take on one core, about, as an EPYC did.
struct Times {
  double assembly = 0, product = 0;
};
Times times_of(const PointSet& set) {
  Times sum;
  for (int group = 0; group < set.group_count(); ++group) {
    const auto frames = static_cast<double>(set.nodes(group).size());
    sum.assembly += kGroupSize * frames * (150 + 27 * frames);
    sum.product += kGroupSize * frames * 30;
  }
  for (const ElementBlock& block : set.blocks) {
    const double points = 1.0 * block.count * block.points;
    sum.assembly += points * 12 * block.nodes * block.nodes;
    sum.product += points * 13 * block.nodes;
  }
  for (const ShellBlock& shell : set.shells) {
    sum.assembly += 2600.0 * shell.count;
    sum.product += 420.0 * shell.count;
  }
  return sum;
}
/// Others of these: of a number of an assembled matrix in a product, of a factor's operation, of its number in a solve.
constexpr double kOfMatrixNumber = 0.1, kOfFactorOperation = 1. / 30, kOfFactorNumber = 1.5;

}  // namespace

LinearReport KeptFactor::solve(std::span<const double> b, std::span<double> x, double tolerance) {
  LinearReport report;
  report.usable = false;
  if (rest_ > 0 && --rest_ == 0) recent_factors_ = recent_solves_ = 0;
  if (rest_ > 0 || !old_.is_kept()) return report;
  CgOptions options;
  options.max_iterations = OldFactor::kMostIterations;
  options.tolerance = std::min(tolerance, kMostLeft);
  options.look = OldFactor::kMostIterations / 2;  // where half of the digits are not there, all will not be in time
  options.hope = std::sqrt(options.tolerance);
  old_.prepare();
  report = cg_.solve_by(old_, b, x, options);
  report.usable = report.usable && report.negative == 0 && !report.unsolved;
  if (!report.usable) {
    old_.forget();
    return report;
  }
  old_.took(report.iterations);
  ++solves_;
  ++recent_solves_;
  return report;
}

bool KeptFactor::takes_less_than_blocks(double iterations) {
  constexpr double kClearly = 0.6, kWorthIt = 1e6;  // a millisecond of assembling
  const Times times = times_of(K_.model().points);
  if (times.assembly < kWorthIt) return false;
  const double product = 2 * kOfMatrixNumber * factor_.matrix_numbers();
  const double left =
      kClearly * (times.assembly + iterations * product) - times.assembly / kServed - kIterations * times.product;
  const double least = kIterations * kOfFactorNumber * factor_.matrix_numbers() / 2;  // those below the diagonal
  if (left <= least || factor_.takes_more_than(left * kServed / kOfFactorOperation)) return false;
  const EliminationOrder& order = factor_.order();
  const double taken = kOfFactorOperation * order.flops / kServed + kIterations * kOfFactorNumber * order.numbers;
  return taken < left && factor_.fits();
}

void KeptFactor::renewed() {
  constexpr int kFew = 8, kMany = 16, kWorthIt = 3, kRest = 30;
  ++factors_;
  old_.renewed();
  if (!old_.is_kept()) return;  // shifted, or indefinite: it was not to serve others
  if (++recent_factors_ > kMany) {
    recent_factors_ /= 2;
    recent_solves_ /= 2;
  }
  if (rest_ == 0 && recent_factors_ >= kFew && recent_solves_ < kWorthIt * recent_factors_) rest_ = kRest;
}

}  // namespace fascia
