// Conjugate gradients where the matrix is indefinite.
#include "core/linear/cg.hpp"
#include "core/linear/vectors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fascia::cg_test {
namespace {

struct Solved {
  CgReport report;
  std::vector<double> x;
};

/// A diagonal matrix, without a preconditioner.
Solved solve(const std::vector<double>& diagonal, const std::vector<double>& b, NegativeCurvature negative,
             const CgOptions& options = {100, 1e-12}) {
  ThreadPool pool(1);
  const CpuVectors space(pool);
  Solved solved;
  solved.report = conjugate_gradients(
      space,
      [&](const std::vector<double>& p, std::vector<double>& Ap) {
        for (std::size_t i = 0; i < p.size(); ++i) Ap[i] = diagonal[i] * p[i];
      },
      [&](const std::vector<double>& r, std::vector<double>& z) {
        z = r;
        return space.dot(r, z);
      },
      b, solved.x, options, negative);
  return solved;
}

TEST(ConjugateGradients, StopBeforeADirectionOfNegativeCurvature) {
  const Solved first = solve({1, -0.5}, {0, 1}, NegativeCurvature::stops);
  EXPECT_EQ(first.report.status, CgStatus::negative_curvature);
  EXPECT_DOUBLE_EQ(first.x[1], 1) << "at the first iteration it is the preconditioned right-hand side";
}

TEST(ConjugateGradients, ReflectADirectionOfNegativeCurvature) {
  const Solved soft = solve({1, -0.5}, {0, 1}, NegativeCurvature::reflected);
  EXPECT_EQ(soft.report.status, CgStatus::negative_curvature);
  EXPECT_DOUBLE_EQ(soft.x[1], 2) << "as far as a stiffness of 0.5 lets it go";
  // A descent direction whatever part of it is negative.
  for (const double share : {0.1, 0.5, 1.0, 5.0}) {
    const Solved mixed = solve({3, 1, -0.2}, {1, 0.3, share}, NegativeCurvature::reflected);
    EXPECT_GT(mixed.x[0] + 0.3 * mixed.x[1] + share * mixed.x[2], 0) << share;
  }
}

TEST(ConjugateGradients, ADirectionWithoutStiffnessKeepsTheStepFinite) {
  for (const double stiffness : {0.0, 1e-300, -1e-300, 1e-12, -1e-12}) {
    const Solved flat = solve({1, stiffness}, {0, 1}, NegativeCurvature::reflected);
    EXPECT_TRUE(std::isfinite(flat.x[1])) << stiffness;
    EXPECT_LE(flat.x[1], 1.0001e4) << stiffness;
  }
}

TEST(ConjugateGradients, ADefiniteMatrixIsSolvedAlikeEitherWay) {
  for (const NegativeCurvature negative : {NegativeCurvature::stops, NegativeCurvature::reflected}) {
    const Solved solved = solve({4, 2, 0.5}, {1, 1, 1}, negative);
    EXPECT_EQ(solved.report.status, CgStatus::converged);
    EXPECT_NEAR(solved.x[0], 0.25, 1e-12);
    EXPECT_NEAR(solved.x[2], 2, 1e-12);
  }
}

/// Ends as at a limit where too much is left, with what it has; and not where enough is gone, or nobody looks.
TEST(ConjugateGradients, EndEarlyWhereNothingIsGained) {
  std::vector<double> diagonal(40), b(40, 1.0);
  for (std::size_t i = 0; i < diagonal.size(); ++i) diagonal[i] = static_cast<double>(1 + i * i);
  const Solved whole = solve(diagonal, b, NegativeCurvature::stops);
  ASSERT_EQ(whole.report.status, CgStatus::converged);
  CgOptions options{100, 1e-12};
  options.look = 3;
  options.hope = 1e-6;
  const Solved ended = solve(diagonal, b, NegativeCurvature::stops, options);
  EXPECT_EQ(ended.report.status, CgStatus::limit);
  EXPECT_EQ(ended.report.iterations, 3);
  EXPECT_NE(ended.x[0], 0);
  options.hope = 1e6;
  EXPECT_EQ(solve(diagonal, b, NegativeCurvature::stops, options).x, whole.x);
}

/// An aim beyond the tolerance costs iterations and need not be reached.
TEST(ConjugateGradients, GoOnToTheirAimAsFarAsTheirLimitLetsThem) {
  std::vector<double> diagonal(40), b(40, 1.0);
  for (std::size_t i = 0; i < diagonal.size(); ++i) diagonal[i] = static_cast<double>(1 + i * i);
  CgOptions options{100, 1e-3};
  const CgReport rough = solve(diagonal, b, NegativeCurvature::stops, options).report;
  options.aim = 1e-9;
  const CgReport fine = solve(diagonal, b, NegativeCurvature::stops, options).report;
  EXPECT_GT(fine.iterations, rough.iterations);
  EXPECT_LE(fine.relative_residual, 1e-9);
  options.max_iterations = rough.iterations + 1;
  const CgReport limited = solve(diagonal, b, NegativeCurvature::stops, options).report;
  EXPECT_EQ(limited.status, CgStatus::converged);
  EXPECT_EQ(limited.iterations, rough.iterations + 1);
  options.max_iterations = rough.iterations - 1;
  EXPECT_EQ(solve(diagonal, b, NegativeCurvature::stops, options).report.status, CgStatus::limit);
  options.aim = 1;  // no farther than that
  options.max_iterations = 100;
  EXPECT_EQ(solve(diagonal, b, NegativeCurvature::stops, options).report.iterations, rough.iterations);
}

}  // namespace
}  // namespace fascia::cg_test
