// Steps whose directions a factor of an earlier tangent preconditions, beside those with factors of their own.
#include "fascia/stepper.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fascia::old_factors_test {
namespace {

using test::copied;
using test::driven_block;

double apart(const Rows& a, const Rows& b) {
  const std::vector<double> of_a = copied(a), of_b = copied(b);
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < of_b.size(); ++i) {
    largest = std::max(largest, std::abs(of_b[i]));
    difference = std::max(difference, std::abs(of_a[i] - of_b[i]));
  }
  return difference / largest;
}

/// Where a driver leads, and where a step is suddenly a hundredth or a hundred times as long.
TEST(OldFactors, FollowBoundariesAndStepsOfAnyLength) {
  for (const SolverKind kind : {SolverKind::implicit_euler, SolverKind::newmark, SolverKind::midpoint}) {
    Scene scene = driven_block(kind);
    scene.bodies[0].frames = CountedSamples{120, 1};
    scene.bodies[0].points = CountedSamples{1200, 1};
    Stepper kept(scene);
    scene.solver.linear = LinearMethod::cholesky;
    Stepper exact(scene);
    double time = 0;
    int iterations = 0;
    for (const double dt : {0.01, 0.01, 0.01, 1e-4, 1e-4, 0.01, 0.01, 0.02, 1e-6, 0.01}) {
      time += dt;
      const RigidMotion motion{{{0.1 * time, 0, 0}}, {{0, 5 * time, 2 * time}}, {{0.02, 0.02, 0}}};
      kept.set_motion(0, motion);
      exact.set_motion(0, motion);
      const StepReport of_kept = kept.step(dt), of_exact = exact.step(dt);
      ASSERT_TRUE(of_exact.converged) << of_exact.message;
      ASSERT_TRUE(of_kept.converged) << of_kept.message;
      EXPECT_EQ(of_exact.linear_iterations, 0);
      iterations += of_kept.linear_iterations;
      EXPECT_LE(of_kept.newton_iterations, of_exact.newton_iterations + 2) << time;
      EXPECT_LT(apart(kept.displacements(), exact.displacements()), 1e-5) << time;
    }
    EXPECT_GT(iterations, 5);  // old factors did serve
  }
}

}  // namespace
}  // namespace fascia::old_factors_test
