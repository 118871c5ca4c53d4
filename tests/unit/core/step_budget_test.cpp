#include "core/solver/newton.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace fascia {
namespace {

/// Hours, so that what the test itself takes is nothing beside them.
constexpr double kHour = 3600;

StepBudget known_budget() {
  StepBudget budget(kHour);
  budget.begin(true);
  budget.took_start(0.05 * kHour);
  budget.took_evaluation(0.1 * kHour);
  budget.took_direction(0.5 * kHour, 0.3 * kHour, 300);
  budget.took_end(0.05 * kHour);
  return budget;
}

TEST(StepBudget, GivesConjugateGradientsWhatTheRestOfAStepLeaves) {
  const StepBudget budget = known_budget();  // 0.95 − 0.2 − 0.1 − 0.05 = 0.6, of which an iteration takes 0.001
  EXPECT_NEAR(budget.cg_iterations(), 600, 2);
  EXPECT_TRUE(budget.holds_iteration());
  EXPECT_TRUE(budget.holds_evaluation());
}

TEST(StepBudget, HasNoLimitWhileItLearns) {
  StepBudget budget(1e-9);
  budget.begin(false);
  budget.took_direction(1, 0.5, 10);
  EXPECT_EQ(budget.cg_iterations(), kAsManyAsNeeded);
  EXPECT_TRUE(budget.holds_iteration());
  budget.begin(true);
  EXPECT_EQ(budget.cg_iterations(), 1) << "one at least, for else nothing would ever move";
  EXPECT_FALSE(budget.holds_iteration());
  EXPECT_FALSE(budget.holds_evaluation());
}

TEST(StepBudget, IsCarefulAfterALongPartAndForgetsItSlowly) {
  StepBudget budget = known_budget();
  budget.took_evaluation(0.8 * kHour);
  EXPECT_FALSE(budget.holds_iteration());
  budget.took_evaluation(0.1 * kHour);
  EXPECT_FALSE(budget.holds_iteration()) << "it may come again";
  for (int k = 0; k < 30; ++k) budget.took_evaluation(0.1 * kHour);
  EXPECT_TRUE(budget.holds_iteration());
}

TEST(StepBudget, KnowsTheShortestStep) {
  StepBudget budget = known_budget();
  EXPECT_NEAR(budget.least() / kHour, 0.05 + 0.2 + 0.001 + 0.1 + 0.05, 1e-12);
  budget.forget();
  EXPECT_EQ(budget.least(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(budget.seconds(), kHour);
}

/// f(x) = 0 of one unknown, with a boundary that arrives after some steps.
struct OneEquation {
  using Function = double (*)(double);
  Function f, slope;
  double x = 0;
  int arrives_after = 0;
  double saved = 0, d = 0;
  int most = 0;  ///< iterations that the last direction was given

  Evaluation evaluate() const {
    Evaluation e;
    PartForces forces;
    forces.residual = f(x) * f(x);  // squares
    forces.load = 64;
    judge(std::array{forces}, std::array{0}, 1e-10, e);
    e.energy_scale = 1;
    return e;
  }
  DirectionReport direction(int most_iterations) {
    most = most_iterations;
    d = -f(x) / slope(x);
    DirectionReport report;
    report.linear_iterations = 1;
    return report;
  }
  static double largest_step(double wanted) { return wanted; }
  void apply(double step) {
    x += step * d;
    --arrives_after;
  }
  void save() { saved = x; }
  void restore() { x = saved; }
  bool has_prescribed_increment() const { return arrives_after > 0; }
  static bool conservative() { return true; }
  static bool compares_energies() { return false; }
};

/// x³ − 8 from x = 6, on which Newton's method takes some seven iterations.
OneEquation cubic() {
  return {[](double x) { return x * x * x - 8; }, [](double x) { return 3 * x * x; }, 6};
}

StepBudget spent_budget() {
  StepBudget spent(1e-9);
  spent.begin(true);
  return spent;
}

TEST(StepBudget, EndsNewtonsMethodAfterOneIterationAtLeast) {
  const SolverSettings settings;
  OneEquation cut = cubic(), whole = cubic();
  StepBudget spent = spent_budget();
  Newton newton(cut, settings, {}, &spent);
  const NewtonReport report = newton.solve();
  EXPECT_EQ(report.status, NewtonStatus::out_of_time);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LT(cut.x, 6) << "what it found is kept";
  EXPECT_GT(report.last.relative, 1e-3) << "and what is left is told";

  StepBudget ample(kHour);
  ample.begin(true);
  EXPECT_EQ(Newton(whole, settings, {}, &ample).solve().status, NewtonStatus::converged);
  EXPECT_NEAR(whole.x, 2, 1e-9);
  EXPECT_GT(whole.most, 1000);
}

/// Newton's method on 8 atan(x) from x = 3 leads to ever larger x.
TEST(StepBudget, LeavesTimeForAShorterStepWhereAFullOneLeadsNowhere) {
  OneEquation arc{[](double x) { return 8 * std::atan(x); }, [](double x) { return 8 / (1 + x * x); }, 3};
  StepBudget spent = spent_budget();
  const NewtonReport report = Newton(arc, SolverSettings{}, {}, &spent).solve();
  EXPECT_EQ(report.status, NewtonStatus::out_of_time);
  EXPECT_TRUE(report.progress);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LT(std::abs(arc.x), 3);

  // Nor does any shorter one here: the slope has the wrong sign.
  OneEquation wrong{[](double x) { return 8 * std::atan(x); }, [](double) { return -1.0; }, 3};
  spent = spent_budget();
  const NewtonReport stuck = Newton(wrong, SolverSettings{}, {}, &spent).solve();
  EXPECT_EQ(stuck.status, NewtonStatus::out_of_time);
  EXPECT_FALSE(stuck.progress) << "which is told";
  EXPECT_EQ(wrong.x, 3);
}

/// A residual that falls by less than half, and is small enough all the same.
TEST(StepBudget, LeavesAStateThatConvergedAsItIs) {
  OneEquation near{[](double x) { return x < 0.5 ? 1.2e-9 : 0.7e-9; },
                   [](double x) { return x < 0.5 ? -1.2e-9 : -0.7e-9; }};
  StepBudget spent = spent_budget();
  const NewtonReport report = Newton(near, SolverSettings{}, {}, &spent).solve();
  EXPECT_EQ(report.status, NewtonStatus::converged);
  EXPECT_EQ(near.x, 1);
}

TEST(StepBudget, WaitsForABoundaryToArrive) {
  OneEquation moved = cubic();
  moved.arrives_after = 4;
  StepBudget spent = spent_budget();
  const NewtonReport report = Newton(moved, SolverSettings{}, {}, &spent).solve();
  EXPECT_EQ(report.status, NewtonStatus::out_of_time);
  EXPECT_EQ(report.iterations, 4);
  EXPECT_FALSE(moved.has_prescribed_increment());
}

}  // namespace
}  // namespace fascia
