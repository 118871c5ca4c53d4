#include "core/solver/newton.hpp"

#include <gtest/gtest.h>

#include <array>
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

/// f(x) = x³ − 8 from x = 6, on which Newton's method takes some seven iterations.
struct Cubic {
  double x = 6, saved = 0, d = 0;
  int most = 0;  ///< iterations that the last direction was given

  Evaluation evaluate() const {
    Evaluation e;
    PartForces forces;
    forces.residual = (x * x * x - 8) * (x * x * x - 8);  // squares
    forces.load = 64;
    judge(std::array{forces}, std::array{0}, 1e-10, e);
    e.energy_scale = 1;
    return e;
  }
  DirectionReport direction(int most_iterations) {
    most = most_iterations;
    d = -(x * x * x - 8) / (3 * x * x);
    DirectionReport report;
    report.linear_iterations = 1;
    return report;
  }
  static double largest_step(double wanted) { return wanted; }
  void apply(double step) { x += step * d; }
  void save() { saved = x; }
  void restore() { x = saved; }
  static bool has_prescribed_increment() { return false; }
  static bool conservative() { return true; }
  static bool compares_energies() { return false; }
};

TEST(StepBudget, EndsNewtonsMethodAfterOneIterationAtLeast) {
  const SolverSettings settings;
  Cubic cut, whole;
  StepBudget spent(1e-9);
  spent.begin(true);
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

}  // namespace
}  // namespace fascia
