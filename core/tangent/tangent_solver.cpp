#include "core/tangent/tangent_solver.hpp"

#include "core/base/parallel_copy.hpp"
#include "core/tangent/whole_tangent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {

namespace {

constexpr int kRoundsOfFactor = 4, kRoundsOfCg = 1;

/// Up to here a shifted factor takes seconds at most, whatever the shape.
constexpr int kShiftedDofs = 15000;

/// Products that an iteration with levels is worth.
constexpr double kCycle = 6;

/// A tangent that nothing changes is never indefinite, but it may be singular: that shows without many digits.
constexpr double kRoughOfLinear = 1e-2;

/// Inverse iteration with a solver that was prepared.
SoftestDirection softest_by(LinearSolver& solver, const TangentOperator& K, int rounds) {
  const double rough = K.model().is_linear() ? kRoughOfLinear : 0;
  const auto solve = [&](std::span<const double> b, std::span<double> x) {
    const LinearReport report = solver.solve(b, x, rough);
    const int negative = std::max(report.negative, report.trouble.empty() ? 0 : 1);
    return TangentProbe{report.usable && (!report.unsolved || negative > 0), negative};
  };
  return softest_direction(K.model(), K.filter(), solve, rounds);
}

}  // namespace

TangentSolver::TangentSolver(const Model& model, CpuExecutor& executor, const DofFilter& filter,
                             const LinearSettings& settings)
    : settings_(settings),
      filter_(filter),
      K_(model, executor, filter),
      factor_(K_),
      cg_(K_, settings, factor_),
      kept_factor_(K_, factor_, cg_),
      own_(settings.own ? settings.own(K_) : nullptr) {}

void TangentSolver::begin_afresh() {
  direct_.reset();
  factor_.begin_afresh();
  kept_factor_.begin_afresh();
  kept_by_cost_.reset();
  cg_.begin_afresh();
  if (own_) own_ = settings_.own(K_);
}

void TangentSolver::expect_inertia(bool expected) {
  if (inertia_ == expected) return;
  inertia_ = expected;
  direct_.reset();
  kept_factor_.begin_afresh();
  kept_by_cost_.reset();
  cg_.begin_afresh();
}

/// In dynamics, where tangents change little from step to step. Where Newton's method asks for all digits a factor of
/// the tangent itself gives them.
bool TangentSolver::keeps_factor() const {
  return guessed() && inertia_ && keeps_ && settings_.precision == Precision::full;
}

bool TangentSolver::gives_way_to_kept_factor(double iterations) {
  return keeps_factor() && blocks_go_first() && kept_factor_.takes_less_than_blocks(iterations);
}

/// What the user said of preconditioners or iterations is not for them to overrule.
bool TangentSolver::blocks_go_first() const {
  return guessed() && inertia_ && filter_.free_count() > kDirectDofsWithInertia &&
         settings_.cg.max_iterations >= kEnoughForBulk && settings_.preconditioner == PreconditionerKind::automatic;
}

bool TangentSolver::direct() {
  if (cg_.hands_over()) direct_ = true;
  if (direct_) return *direct_;
  if (own_ || blocks_go_first())
    direct_ = !kept_by_cost_ && gives_way_to_kept_factor(0);  // where assembling alone takes longer
  else if (!guessed())
    direct_ = settings_.linear == LinearMethod::cholesky;
  else
    direct_ = settings_.preconditioner == PreconditionerKind::automatic &&
              (filter_.free_count() <= kDirectDofs || factor_is_small());
  if (*direct_ && blocks_go_first()) kept_by_cost_ = true;
  return *direct_;
}

bool TangentSolver::factor_is_small() {
  return !factor_.takes_more_than(kFlopsPerNumber * factor_.matrix_numbers()) && factor_.order().moderate();
}

SolverChoice TangentSolver::choice() {
  SolverChoice made;
  made.direct = direct_.value_or(true);
  made.preconditioner = cg_.preconditioner();
  if (cg_.levels() != nullptr) made.levels = cg_.levels()->level_sizes();
  made.factors = kept_factor_.factors();
  made.old = kept_factor_.solves();
  const EliminationOrder* order = factor_.known_order();
  if (order == nullptr) return made;
  made.flops = order->flops;
  made.numbers = order->numbers;
  made.flops_per_number = order->flops / factor_.matrix_numbers();
  return made;
}

bool TangentSolver::gives_way_to_factor(long iterations) {
  const int limit = settings_.cg.max_iterations;
  return guessed() && limit >= kEnoughForBulk && iterations >= limit && factor_.fits();
}

bool TangentSolver::factor_is_cheap(long made) {
  constexpr double kSpeedup = 10, kShare = 0.1;
  constexpr int kAlways = 5000;  // less than a second, whatever the shape
  if (settings_.preconditioner == PreconditionerKind::cholesky || filter_.free_count() <= kAlways) return true;
  const double product = (cg_.levels() != nullptr ? kCycle : 1) * 2.0 * factor_.matrix_numbers();
  return !factor_.takes_more_than(kSpeedup * kShare * static_cast<double>(made) * product) && factor_.fits();
}

/// @param whole  with what is beside the symmetric part
void TangentSolver::set_right_side(std::span<const double> prescribed, std::span<const double> b, bool whole) {
  copy_into(K_.pool(), b, rhs_);
  if (!prescribed.empty()) {
    product_.resize(b.size());
    if (whole)
      K_.apply_whole(prescribed, product_);
    else
      K_.apply(prescribed, product_);
    for (std::size_t i = 0; i < b.size(); ++i) rhs_[i] -= product_[i];
  }
  filter_.clear_fixed(rhs_);
  of_gradient_ = 1;
  if (prescribed.empty()) return;
  double gradient = 0, right_side = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!filter_.is_fixed(i)) gradient += b[i] * b[i];
    right_side += rhs_[i] * rhs_[i];
  }
  if (right_side > 0) of_gradient_ = std::sqrt(gradient / right_side);
}

void TangentSolver::take_prescribed(std::span<const double> prescribed, std::span<double> x) const {
  for (std::size_t i = 0; i < prescribed.size(); ++i)
    if (filter_.is_fixed(i)) x[i] = prescribed[i];
}

TangentReport TangentSolver::solve(const Linearization& lin, std::span<const double> prescribed,
                                   std::span<const double> b, std::span<double> x, const Relinearize& relinearize) {
  K_.take(lin, &relinearize);
  factor_is_current_ = false;
  const struct Lent {
    TangentOperator& K;
    ~Lent() { K.forget_tamer(); }
  } lent{K_};
  TangentReport report;
  std::optional<TangentReport> exact;
  if (filter_.free_count() == 0) {
    std::fill(x.begin(), x.end(), 0.0);
  } else {
    if (!K_.symmetric()) {
      set_right_side(prescribed, b, true);
      exact = solve_unsymmetric(x);
      if (!exact) K_.take(lin, &relinearize);
    }
    if (!exact) set_right_side(prescribed, b, false);
    report = exact ? *exact : descend(x);
  }
  if (!report.usable) return report;
  if (!std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); })) {
    report.usable = false;
    report.trouble = "the linear solver returned a number that is not finite";
    return report;
  }
  take_prescribed(prescribed, x);
  return report;
}

/// Takes K as it is, or where it is indefinite as near to it as a direction of descent needs.
TangentReport TangentSolver::descend(std::span<double> x) {
  if (direct()) return descend_by_kept_factor(x);
  const PreconditionerKind taken = cg_.preconditioner();
  const auto solve = [&]() -> std::optional<TangentReport> {
    LinearSolver& solver = iterative();
    if (!solver.prepare()) return std::nullopt;
    TangentReport report{solver.solve(rhs_, x)};
    if (report.trouble.empty() && report.negative > 0) report.trouble = "the tangent is not positive definite";
    return report;
  };
  std::optional<TangentReport> report = solve();
  if (report && !report->trouble.empty() && !K_.model().tethers.empty()) {
    K_.tame(TamerTangent::without_tethers);
    report = solve();
  }
  if (!report && factor_.fits()) return descend_by_factor(x);
  if (!report) {
    report.emplace();
    report->usable = false;
    report->trouble = "the linear solver does not take the tangent, and a factor of it would be too large";
    return *report;
  }
  if (!report->usable) return *report;
  // Truncated directions lead Newton's method nowhere for long; shifted factors do better.
  const bool bends_down = report->negative > 0 && guessed() && settings_.cg.max_iterations >= kEnoughForBulk &&
                          (filter_.free_count() <= kShiftedDofs || (blocks_go_first() && factor_is_small()));
  const bool ends = report->unsolved && (cg_.hands_over() || gives_way_to_factor(report->iterations));
  if (!bends_down && !ends) {
    const double cost = taken == PreconditionerKind::multigrid ? kCycle : 1;
    if (!kept_by_cost_ && cg_.preconditioner() == taken && gives_way_to_kept_factor(cost * report->iterations)) {
      kept_by_cost_ = direct_ = true;
      kept_factor_.begin_afresh();
    }
    return *report;
  }
  if (ends) direct_ = true;
  const std::vector<double> truncated(x.begin(), x.end());
  TangentReport by_factor = descend_by_factor(x);
  if (!by_factor.usable) {
    std::copy(truncated.begin(), truncated.end(), x.begin());
    return *report;
  }
  by_factor.iterations += report->iterations;
  return by_factor;
}

/// A tangent that is indefinite shows where conjugate gradients meet it, and where the factor is made anew. A factor of
/// a few hundred unknowns tells for certain, and costs next to nothing where assembling does.
TangentReport TangentSolver::descend_by_kept_factor(std::span<double> x) {
  const bool small = filter_.free_count() <= kDirectDofsWithInertia;
  if (!keeps_factor() || (small && !kept_factor_.takes_less_than_blocks(0))) return descend_by_factor(x);
  TangentReport by_old{kept_factor_.solve(rhs_, x, std::max(left_ * of_gradient_, settings_.cg.tolerance))};
  if (by_old.usable) return by_old;
  const bool ends = kept_by_cost_.value_or(false) && kept_factor_.rests();
  if (ends) kept_by_cost_ = direct_ = false;
  TangentReport report = ends ? descend(x) : descend_by_factor(x);
  report.iterations += by_old.iterations;
  return report;
}

TangentReport TangentSolver::descend_by_factor(std::span<double> x) {
  TangentReport report;
  bool ready = factor_.prepare();
  if (!ready && !K_.model().tethers.empty()) {
    K_.tame(TamerTangent::without_tethers);
    ready = factor_.prepare();
  }
  if (!ready) {
    ready = factor_.prepare_shifted();
    report.trouble = ready ? "the tangent was not positive definite (buckling, or parts that nothing holds); it was "
                             "shifted"
                           : "the tangent stays indefinite under every shift";
  }
  report.usable = ready;
  if (ready) factor_.solve(rhs_, x);
  kept_factor_.renewed();
  factor_is_current_ = true;
  return report;
}

/// None where the symmetric part has no factor, or too much is left. Where conjugate gradients meet negative curvature
/// or their limit a factor takes over, if they were only a guess; else the material part alone, which is definite,
/// preconditions.
std::optional<TangentReport> TangentSolver::solve_unsymmetric(std::span<double> x) {
  TangentReport report;
  const auto solve = [&](LinearSolver& inner, double tolerance) {
    const LinearReport whole = solve_whole(K_, inner, guessed(), rhs_, x, tolerance);
    report.iterations += whole.iterations;
    report.seconds += whole.seconds;
    report.indefinite = report.indefinite || whole.negative > 0;
    report.unsolved = inner.iterates() && whole.unsolved;
    report.residual = inner.iterates() ? whole.residual : 0;
    return whole.usable;
  };
  if (!direct()) {
    LinearSolver& inner = iterative();
    const double tolerance = inner.iterates() ? settings_.cg.tolerance : kDirectTolerance;
    const bool taken = inner.prepare();
    if (taken && solve(inner, tolerance)) return report;
    if ((taken && !guessed()) || !factor_.fits()) {
      report.indefinite = report.indefinite || !taken;
      K_.tame(TamerTangent::material);
      return inner.prepare() && solve(inner, tolerance) ? std::optional(report) : std::nullopt;
    }
    if (guessed()) direct_ = true;
  }
  report.indefinite = false;
  factor_is_current_ = factor_.prepare_any();
  if (!factor_is_current_ || !solve(factor_, kDirectTolerance)) return std::nullopt;
  return report;
}

std::optional<int> TangentSolver::factorize_as_is(const Linearization& lin) {
  K_.take(lin);
  if (filter_.free_count() == 0) return 0;
  if (!factor_.prepare_any()) return std::nullopt;
  if (factor_.negative() == 0 || K_.symmetric()) return factor_.negative();
  const SoftestDirection whole = softest_of_whole(K_, factor_, false);
  return whole.probe.usable ? std::optional(whole.probe.unstable) : std::nullopt;
}

bool TangentSolver::solve_as_is(std::span<const double> prescribed, std::span<const double> b, std::span<double> x) {
  bool solved = true;
  if (filter_.free_count() > 0) {
    set_right_side(prescribed, b, !K_.symmetric());
    solved = K_.symmetric() ? factor_.solve_refined(rhs_, x)
                            : solve_whole(K_, factor_, false, rhs_, x, kDirectTolerance).usable;
  }
  take_prescribed(prescribed, x);
  return solved;
}

SoftestDirection TangentSolver::softest(const Linearization& lin, long made, bool current) {
  cg_.take_exact_products(true);  // the softest stiffness may be as small as what rounding changes
  const struct Lent {
    CgSolver& cg;
    ~Lent() { cg.take_exact_products(false); }
  } lent{cg_};
  const bool reusable = current && direct_.value_or(false) && factor_.definite() && factor_is_current_ && !K_.tamed();
  K_.take(lin);
  const bool factor_first = reusable || direct() || (!own_ && factor_is_cheap(made));
  const bool by_factor = factor_first || !iterative().prepare();
  if (by_factor && !factor_first && !factor_.fits()) return {};
  if (reusable)
    factor_.renew_terms();
  else if (by_factor && !factor_.prepare_any())
    return {};
  LinearSolver& solver = by_factor ? factor_ : iterative();
  const bool definite = by_factor && factor_.definite();
  if (!solver.iterates())
    return K_.symmetric() ? softest_by(solver, K_, kRoundsOfFactor) : softest_of_whole(K_, solver, definite);
  SoftestDirection found = softest_by(solver, K_, kRoundsOfCg);
  if (!K_.symmetric() && found.probe.unstable > 0) return {};  // of the symmetric part alone: nothing is known
  // A solve that was cut short has no quotient, and must not pass for one near a limit point.
  if (found.probe.unstable > 0) found.stiffness = -std::numeric_limits<double>::infinity();
  return found;
}

const Multigrid* TangentSolver::levels(const Linearization& lin, bool material) {
  const Relinearize itself = [&](TamerTangent) -> const Linearization& { return lin; };
  K_.take(lin, &itself);
  const struct Lent {
    TangentOperator& K;
    ~Lent() { K.forget(); }
  } lent{K_};
  cg_.take_frames_alone();
  return cg_.make_levels(material) ? cg_.levels(material) : nullptr;
}

}  // namespace fascia
