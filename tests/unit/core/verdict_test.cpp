// What counts as converged: the judgement of parts, and Newton's method where rounding or a detour is in its way.
#include "core/solver/newton.hpp"
#include "core/structure/parts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace fascia::verdict_test {
namespace {

constexpr double kTolerance = 1e-8;

PartForces part(double residual, double load, double reaction, double rounding) {
  PartForces f;
  f.residual = residual * residual;
  f.load = load * load;
  f.reaction = reaction * reaction;
  f.rounding = rounding;
  return f;
}

Evaluation judged(std::vector<PartForces> parts, std::vector<int> whole) {
  Evaluation e;
  judge(parts, whole, kTolerance, e);
  return e;
}

/// The same part of a body that a boundary motion drives.
PartForces driven(PartForces f) {
  f.driven = true;
  return f;
}

TEST(Verdict, ToleranceRefersToWhatActs) {
  EXPECT_TRUE(judged({part(0.9e-8, 1, 0, 0)}, {0}).converged());
  EXPECT_FALSE(judged({part(1.1e-8, 1, 0, 0)}, {0}).converged());
  EXPECT_FALSE(judged({part(1.1e-8, 1, 100, 0)}, {0}).converged()) << "bending makes reactions larger than its load";
  EXPECT_TRUE(judged({driven(part(0.9e-6, 1, 100, 0))}, {0}).converged());
  EXPECT_FALSE(judged({driven(part(1.1e-6, 1, 100, 0))}, {0}).converged());
  EXPECT_TRUE(judged({part(0.9e-6, 0, 100, 0)}, {0}).converged()) << "nothing loads it";
}

/// Reactions of 1e9 N allow 10 N, which is more than all of the load.
TEST(Verdict, ReactionsNeverExcuseMoreThanAShareOfTheLoad) {
  EXPECT_TRUE(judged({driven(part(0.9e-4, 1, 1e9, 0))}, {0}).converged());
  EXPECT_FALSE(judged({driven(part(1.1e-4, 1, 1e9, 0))}, {0}).converged());
}

TEST(Verdict, RoundingNeverExcusesMoreThanAShareOfTheLoad) {
  EXPECT_TRUE(judged({part(0.9e-4, 1, 0, 10)}, {0}).converged());
  EXPECT_FALSE(judged({part(1.1e-4, 1, 0, 10)}, {0}).converged());
}

/// A body that was moved rigidly and rests: its reactions are rounding.
/// The residual is within the rounding of the only part, which is less than a tenth of its loads.
TEST(Verdict, SaysWhereRoundingIsAllThereIs) {
  EXPECT_TRUE(judged({part(1e-3, 1, 0, 1e-2)}, {0}).within_rounding);
  EXPECT_FALSE(judged({part(1e-3, 1, 0, 1e-4)}, {0}).within_rounding);
  EXPECT_FALSE(judged({part(1e-3, 1, 0, 0.2)}, {0}).within_rounding);
  EXPECT_FALSE(judged({part(1e-3, 1, 0, 1e-2), part(0, 1, 0, 0)}, {0, 0}).within_rounding) << "another part";
  EXPECT_FALSE(judged({part(2e-3, 0, 10, 1e-2)}, {0}).within_rounding) << "nothing loads it";
}

TEST(Verdict, WhereNothingActsRoundingIsEnough) {
  const Evaluation e = judged({part(1e-9, 0, 1e-9, 1e-8)}, {0});
  EXPECT_TRUE(e.converged());
  EXPECT_TRUE(e.by_rounding);
  EXPECT_FALSE(judged({part(1e-7, 0, 1e-9, 1e-8)}, {0}).converged());
}

TEST(Verdict, MomentumIsMoreThanRounding) {
  PartForces f = part(0.5, 0, 0, 1);
  f.momentum = f.inertia = 1;
  EXPECT_TRUE(judged({f}, {0}).converged());
  f.adrift = true;
  EXPECT_FALSE(judged({f}, {0}).converged());
}

/// Bone of 1e6 N and a strand that weighs 1 N: the bone's tolerance is 0.01 N.
TEST(Verdict, ASoftPartIsJudgedByItsOwnLoad) {
  const PartForces bone = driven(part(1e-5, 10, 1e6, 0));
  EXPECT_TRUE(judged({bone, part(0.9e-4, 1, 0, 0)}, {0, 0}).converged());
  EXPECT_FALSE(judged({bone, part(1.1e-4, 1, 0, 0)}, {0, 0}).converged());
  EXPECT_NEAR(judged({bone, part(1.1e-4, 1, 0, 0)}, {0, 0}).left_of_load, 1.1e-4, 1e-15);
  EXPECT_FALSE(judged({bone, part(0.9e-4, 1, 0, 0)}, {0, 1}).converged()) << "another whole has its own tolerance";
}

/// A chain of springs from rigid to soft, three nodes each, by points whose influence is their gradient.
PointSet chain(const std::vector<double>& young) {
  PointSetBuilder builder;
  for (std::size_t k = 0; k < young.size(); ++k) {
    PointSample p;
    p.volume = 1;
    p.mu = 0.5 * young[k];
    p.influences = {{0.5, {{-1, 0, 0}}, {}, {}}, {0.5, {{1, 0, 0}}, {}, {}}};
    const std::array<int, 2> nodes{static_cast<int>(k), static_cast<int>(k) + 1};
    builder.add_points(nodes, std::array{p}, 0.1, {Law::st_venant_kirchhoff, Stabilization::none, false});
  }
  return std::move(builder).finish(std::vector<FrameKind>(young.size() + 1, FrameKind::vertex));
}

TEST(Parts, AJumpInStiffnessDividesAWhole) {
  const PointSet set = chain({1e10, 1e10, 1e4, 1e4});
  EXPECT_EQ(set.node_part, (std::vector<int>{0, 0, 0, 1, 1})) << "the node between is as stiff as the stiffer side";
  EXPECT_EQ(set.part_whole, (std::vector<int>{0, 0}));
  EXPECT_EQ(set.part_length.size(), 2U);
  for (const double length : set.part_length) EXPECT_DOUBLE_EQ(length, 0.1);
}

TEST(Parts, AGradualChangeDoesNot) {
  EXPECT_EQ(chain({1e10, 1e8, 1e6, 1e4}).part_whole.size(), 1U);
  EXPECT_EQ(chain({1e10, 1.1e7}).part_whole.size(), 1U);
}

/// One unknown with the force f(x) and the tangent k(x).
struct OneSpring {
  using Function = double (*)(double);
  Function force, tangent;
  double noise = 0;  ///< that rounding leaves
  bool has_potential = false;
  double x = 0, saved = 0, d = 0;
  int evaluations = 0;

  Evaluation evaluate() {
    ++evaluations;
    Evaluation e;
    const double sign = evaluations % 2 == 0 ? 1 : -1;
    judge(std::array{part(std::abs(force(x)) + sign * 0.5 * noise, 1, 0, noise)}, std::array{0}, kTolerance, e);
    e.energy_scale = 1;
    e.strain_energy = strain_energy;
    return e;
  }
  DirectionReport direction(int /*most_iterations*/) {
    d = -force(x) / tangent(x);
    DirectionReport report;
    report.slope = force(x) * d;
    report.unsolved = unsolved;
    report.linear_residual = left;
    report.trouble = trouble;
    return report;
  }
  bool unsolved = false;  ///< conjugate gradients end at their limit
  double strain_energy = 0;
  std::string trouble;
  double left = 0;  ///< of the right-hand side, by conjugate gradients
  static double largest_step(double wanted) { return wanted; }
  void apply(double step) { x += step * d; }
  void save() { saved = x; }
  void restore() { x = saved; }
  bool has_prescribed_increment() const { return false; }
  bool conservative() const { return has_potential; }
  bool compares_energies() const { return has_potential; }
};

NewtonReport solve(OneSpring& system, int iterations) {
  SolverSettings settings;
  settings.max_iterations = iterations;
  Newton newton(system, settings);
  return newton.solve();
}

TEST(NewtonVerdict, SaysThatTheToleranceWasMet) {
  OneSpring system{[](double x) { return x + x * x * x - 1; }, [](double x) { return 1 + 3 * x * x; }};
  const NewtonReport r = solve(system, 50);
  EXPECT_EQ(r.status, NewtonStatus::converged);
  EXPECT_EQ(r.convergence, Convergence::tolerance);
  EXPECT_NEAR(system.x, 0.6823278038280193, 1e-8);
}

TEST(NewtonVerdict, TellsEachIteration) {
  OneSpring system{[](double x) { return x + x * x * x - 1; }, [](double x) { return 1 + 3 * x * x; }};
  std::vector<IterationInfo> told;
  SolverSettings settings;
  settings.iterating = [&](const IterationInfo& i) { told.push_back(i); };
  Newton newton(system, settings, {4, 0.5});
  const NewtonReport r = newton.solve();
  ASSERT_EQ(static_cast<int>(told.size()), r.iterations);
  for (int k = 0; k < r.iterations; ++k) {
    const IterationInfo& i = told[static_cast<std::size_t>(k)];
    EXPECT_EQ(i.step, 4);
    EXPECT_EQ(i.time, 0.5);
    EXPECT_EQ(i.iteration, k + 1);
    EXPECT_EQ(i.tolerance, settings.tolerance);
    EXPECT_GT(i.relative, k == 0 ? 0.1 : 0.0);
  }
  EXPECT_LT(told.back().relative, told.front().relative);
}

/// arctan overshoots and diverges from x = 2: what is kept at the limit is no worse than the start.
TEST(NewtonVerdict, KeepsTheBestStateWhereItGivesUp) {
  OneSpring system{[](double x) { return std::atan(x - 2); }, [](double x) { return 1 / (1 + (x - 2) * (x - 2)); }};
  for (const int iterations : {1, 2, 3, 4}) {
    system.x = 0;
    const NewtonReport r = solve(system, iterations);
    EXPECT_LE(r.last.residual, std::atan(2.0) + 1e-15) << iterations;
  }
}

/// A residual of 1e-6 of the load that no step reduces, of which the estimate of rounding knows nothing.
TEST(NewtonVerdict, StagnationNearTheSolutionIsSaid) {
  OneSpring system{[](double x) { return x - 1 + (x > 0.999 ? 1e-6 : 0.0); }, [](double) { return 1.0; }};
  system.force = [](double x) { return std::abs(x - 1) < 1e-3 ? 1e-6 : x - 1; };
  system.has_potential = true;
  const NewtonReport r = solve(system, 50);
  EXPECT_EQ(r.status, NewtonStatus::converged);
  EXPECT_EQ(r.convergence, Convergence::stagnation);
  EXPECT_LT(r.iterations, 10);
  system.x = 0;
  system.has_potential = false;
  EXPECT_NE(solve(system, 50).status, NewtonStatus::converged) << "a symmetrised correction says nothing";
}

/// Rounding that goes up and down in a circle, by more than a half each time, is rounding: a tethered body that is
/// moved as a whole, without load.
TEST(NewtonVerdict, RoundingMayGoRoundInACircle) {
  struct Circling {
    int evaluations = 0, steps = 0;
    Evaluation evaluate() {
      const double residual = evaluations == 0 ? 1.0 : evaluations % 2 == 0 ? 3.5e-9 : 8e-9;
      ++evaluations;
      Evaluation e;
      judge(std::array{part(residual, 0, 0, 1e-6)}, std::array{0}, kTolerance, e);
      e.energy_scale = 1e-9;
      return e;
    }
    static DirectionReport direction(int /*most_iterations*/) {
      DirectionReport report;
      report.slope = -1e-10;
      return report;
    }
    static double largest_step(double wanted) { return wanted; }
    void apply(double) { ++steps; }
    static void save() {}
    static void restore() {}
    static bool has_prescribed_increment() { return false; }
    static bool conservative() { return true; }
    static bool compares_energies() { return true; }
  } system;
  const SolverSettings settings;
  Newton newton(system, settings);
  const NewtonReport r = newton.solve();
  EXPECT_EQ(r.status, NewtonStatus::converged);
  EXPECT_EQ(r.convergence, Convergence::rounding);
  EXPECT_LE(system.steps, 8);
}

/// A first, large correction that leaves 1e-6 of itself, which is within the rounding floor.
TEST(NewtonVerdict, RoundingIsNotReachedByALargeCorrection) {
  OneSpring system{[](double x) { return x - 1; }, [](double x) { return x == 0 ? 1 - 1e-6 : 1.0; }, 1e-5};
  const NewtonReport r = solve(system, 50);
  EXPECT_EQ(r.status, NewtonStatus::converged);
  EXPECT_EQ(r.convergence, Convergence::rounding);
  EXPECT_GE(r.iterations, 2);
  EXPECT_NEAR(system.x, 1, 1e-15) << "the second correction takes away what the first left";
}

/// A residual that rounding keeps at a hundredth of the load, a hundred times what it may excuse by itself: where a
/// factor's correction gains next to no strain energy, the answer is as good as numbers can make it.
TEST(NewtonVerdict, RoundingAloneIsConvergedWhereCorrectionsGainNothing) {
  OneSpring system{[](double x) { return std::abs(x - 1) < 2e-2 ? 1e-2 : x - 1; }, [](double) { return 1e10; }, 3e-2};
  system.x = 1.01;
  system.has_potential = true;
  system.strain_energy = 1.1;  // the correction gains 1e-14
  const NewtonReport r = solve(system, 50);
  EXPECT_EQ(r.status, NewtonStatus::converged);
  EXPECT_EQ(r.convergence, Convergence::rounding);
  EXPECT_EQ(r.iterations, 1);
  const auto fails = [](OneSpring changed) {
    changed.x = 1.01;
    return solve(changed, 50).status != NewtonStatus::converged;
  };
  OneSpring large = system, iterated = system, followed = system;
  large.strain_energy = 0.9;
  iterated.left = 1e-10;
  followed.has_potential = false;
  EXPECT_TRUE(fails(large)) << "a correction that still gains energy";
  EXPECT_TRUE(fails(iterated)) << "conjugate gradients leave what is soft";
  EXPECT_TRUE(fails(followed)) << "loads without a potential";
  OneSpring shifted = system;
  shifted.trouble = "it was shifted";
  EXPECT_TRUE(fails(shifted)) << "a tangent that is not definite";
}

/// The same of corrections that are small: what conjugate gradients leave is smooth, so that it sums up to more than
/// rounding of the same norm does. Another correction, which must not lower the residual, says that it is rounding. A
/// factor leaves nothing that another solve would take.
TEST(NewtonVerdict, RoundingAfterConjugateGradientsIsTriedOnceMore) {
  const auto tangent = [](double x) {
    if (x == 0) return 1 + 5e-7;
    return std::abs(x - 1) > 1e-8 ? 1 + 1e-3 : 1.0;
  };
  for (const double left : {0.0, 1e-7}) {
    OneSpring system{[](double x) { return x - 1; }, tangent, 1e-7};
    system.left = left;
    const NewtonReport r = solve(system, 50);
    EXPECT_EQ(r.convergence, Convergence::rounding);
    EXPECT_EQ(r.iterations, left > 0 ? 3 : 2);
    EXPECT_NEAR(system.x, 1, left > 0 ? 1e-15 : 2e-9);
    system.x = 0;
    EXPECT_EQ(solve(system, 2).convergence, Convergence::rounding) << "no iteration is left to try";
  }
}

TEST(NewtonVerdict, StagnationFarFromTheSolutionIsNoConvergence) {
  OneSpring system{[](double x) { return std::abs(x - 1) < 1e-3 ? 1e-3 : x - 1; }, [](double) { return 1.0; }};
  EXPECT_NE(solve(system, 50).status, NewtonStatus::converged);
}

/// A start within the rounding floor is not taken for a solution before an iteration has tried to do better.
TEST(NewtonVerdict, RoundingExcusesOnlyWhatNewtonTriedToReduce) {
  OneSpring system{[](double x) { return x - 1e-5; }, [](double) { return 1.0; }, 1e-4};
  const NewtonReport r = solve(system, 50);
  EXPECT_EQ(r.status, NewtonStatus::converged);
  EXPECT_GE(r.iterations, 1);
  EXPECT_NEAR(system.x, 1e-5, 1e-18);
}

/// A small correction, or a residual within the rounding floor, says nothing where the linear system was not solved.
TEST(NewtonVerdict, DirectionsThatWereNotSolvedForExcuseNothing) {
  OneSpring standing{[](double x) { return std::abs(x - 1) < 1e-3 ? 1e-6 : x - 1; }, [](double) { return 1.0; }};
  standing.unsolved = true;
  const NewtonReport r = solve(standing, 50);
  EXPECT_EQ(r.status, NewtonStatus::unsolved);
  EXPECT_LT(r.iterations, 12);
  OneSpring rounded{[](double) { return 1e-5; }, [](double) { return 1.0; }, 1e-4};
  rounded.unsolved = true;
  EXPECT_EQ(solve(rounded, 50).status, NewtonStatus::unsolved);
  OneSpring exact{[](double x) { return x - 1; }, [](double) { return 1.0; }};
  exact.unsolved = true;
  EXPECT_EQ(solve(exact, 50).status, NewtonStatus::converged);  // its residual says so itself
}

}  // namespace
}  // namespace fascia::verdict_test
