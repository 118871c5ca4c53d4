#include "core/base/index.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The parts of TangentSolver and MechanicalSystem that ask whether an equilibrium is stable.
namespace fascia {

namespace {

constexpr int kRoundsOfFactor = 4, kRoundsOfCg = 1;

/// Products that an iteration with levels is worth.
constexpr double kCycle = 6;

}  // namespace

bool TangentSolver::factor_is_cheap(long made) {
  constexpr double kSpeedup = 5, kShare = 0.1;
  constexpr int kAlways = 5000;  // less than a second, whatever the shape
  if (settings_.preconditioner == Preconditioner::cholesky || filter_.free_count() <= kAlways) return true;
  const double product =
      (multigrid_ ? kCycle : 1) * 2.0 * static_cast<double>(matrix().value_count()) * (matrix().fills_upper() ? 2 : 1);
  return order().flops <= kSpeedup * kShare * static_cast<double>(made) * product && factor_fits();
}

SoftestDirection TangentSolver::softest(const Linearization& lin, long made, bool current) {
  const bool reusable = current && direct() && solving_ != nullptr && definite_;
  if (!reusable) {
    work_.resize(at(model_.dof_count()));
    assemble(lin, matrix());
    low_rank_.set(lin.low_rank, filter_);
  }
  if (!reusable && !direct() && !factor_is_cheap(made)) {
    const auto solve = [&](std::span<const double> b, std::span<double> x) {
      const TangentReport report = solve_cg(b, x);
      const bool met = !report.trouble.empty();
      const bool settled = report.usable && !report.unsolved;
      return TangentProbe{settled || (report.usable && met), met ? 1 : 0};
    };
    SoftestDirection found = softest_direction(model_, filter_, solve, kRoundsOfCg);
    if (!lin.symmetric() && found.probe.unstable > 0) return {};  // of the symmetric part alone: nothing is known
    // A solve that was cut short has no quotient, and must not pass for one near a limit point.
    if (found.probe.unstable > 0) found.stiffness = -std::numeric_limits<double>::infinity();
    return found;
  }
  int negative = 0;
  if (!reusable) {
    solving_ = &factor();
    definite_ = solving_->factorize(matrix());
    if (!definite_) {
      const std::optional<int> found = factorize_any();
      if (!found) return {};
      solving_ = &*indefinite_;
      negative = *found;
    }
  }
  if (!lin.symmetric()) return softest_unsymmetric(lin, definite_);
  const auto solve = [&](std::span<const double> b, std::span<double> x) {
    solve_with_factor(b, x);
    const bool finite = std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
    return TangentProbe{finite, std::max(0, negative - low_rank_.lifted())};
  };
  return softest_direction(model_, filter_, solve, kRoundsOfFactor);
}

Stability MechanicalSystem::stability(const State& end, long made, bool current) {
  return stability_of(*this, end, State::at_rest(model_), [&](bool at_end) {
    executor_.linearize(state_, history_, Tangent::full, lin_);
    add_node_blocks(lin_);
    return tangent_.softest(lin_, made, current && at_end && settings_.tangent == Tangent::full);
  });
}

}  // namespace fascia
