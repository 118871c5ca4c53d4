// GMRES of unsymmetric matrices, with preconditioners that change and with rounds that begin anew.
#include "core/linear/gmres.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace fascia::gmres_test {
namespace {

using Vector = std::vector<double>;

/// A matrix with a right-hand side; the preconditioner is another matrix.
struct Problem {
  Eigen::MatrixXd A, M;
  Vector b;

  explicit Problem(int n, double antisymmetric)
      : A(n, n), M(Eigen::MatrixXd::Zero(n, n)), b(static_cast<std::size_t>(n)) {
    std::mt19937 random(4);
    const auto number = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) A(i, j) = antisymmetric * number() + (i == j ? 3 + i : 0);
    for (int i = 0; i < n; ++i) M(i, i) = A(i, i);
    for (double& value : b) value = number();
  }
  Eigen::Map<const Eigen::VectorXd> map(const Vector& v) const {
    return {v.data(), static_cast<Eigen::Index>(v.size())};
  }
  void multiply(const Vector& z, Vector& w) const {
    const Eigen::VectorXd product = A * map(z);
    std::copy(product.begin(), product.end(), w.begin());
  }
  void precondition(const Vector& v, Vector& z) const {
    const Eigen::VectorXd solved = M.partialPivLu().solve(map(v));
    std::copy(solved.begin(), solved.end(), z.begin());
  }
  double residual(const Vector& x) const { return (A * map(x) - map(b)).norm() / map(b).norm(); }
};

struct Solved {
  GmresReport report;
  Vector x;
};

template <class Precondition>
Solved solve(const Problem& problem, const Precondition& precondition, const GmresOptions& options) {
  ThreadPool pool(1);
  Solved out;
  out.report = flexible_gmres(
      CpuVectors(pool), [&](const Vector& z, Vector& w) { problem.multiply(z, w); }, precondition, problem.b, out.x,
      options);
  return out;
}

TEST(Gmres, SolvesInAsManyIterationsAsThereAreUnknowns) {
  const Problem problem(12, 2);
  const auto none = [](const Vector& v, Vector& z) {
    z = v;
    return true;
  };
  const Solved solved = solve(problem, none, {});
  EXPECT_TRUE(solved.report.converged);
  EXPECT_LE(solved.report.iterations, 12);
  EXPECT_LT(problem.residual(solved.x), 1e-10);
  EXPECT_NEAR(solved.report.relative_residual, problem.residual(solved.x), 1e-14);
}

/// A change of rank two takes three iterations, whatever the size.
TEST(Gmres, IterationsCountWhatThePreconditionerLeavesOut) {
  Problem problem(40, 0);
  problem.M = problem.A;
  problem.A(3, 7) += 5;
  problem.A(7, 3) -= 5;
  const Solved solved = solve(problem,
                              [&](const Vector& v, Vector& z) {
                                problem.precondition(v, z);
                                return true;
                              },
                              {});
  EXPECT_TRUE(solved.report.converged);
  EXPECT_LE(solved.report.iterations, 3);
}

TEST(Gmres, BeginsAnewAndTakesAPreconditionerThatChanges) {
  const Problem problem(60, 0.4);
  int call = 0;
  GmresOptions options;
  options.restart = 5;
  const Solved solved = solve(
      problem,
      [&](const Vector& v, Vector& z) {
        problem.precondition(v, z);
        for (double& value : z) value *= 1 + 0.5 * (++call % 3);
        return true;
      },
      options);
  EXPECT_TRUE(solved.report.converged) << solved.report.relative_residual;
  EXPECT_GT(solved.report.iterations, 5);
  EXPECT_LT(problem.residual(solved.x), 1e-9);
}

TEST(Gmres, KeepsWhatItHasWhereItCannotGoOn) {
  const Problem problem(30, 1);
  int call = 0;
  const Solved ended = solve(problem,
                             [&](const Vector& v, Vector& z) {
                               problem.precondition(v, z);
                               return ++call <= 6;
                             },
                             {});
  EXPECT_FALSE(ended.report.converged);
  EXPECT_EQ(ended.report.iterations, 6);
  EXPECT_LT(problem.residual(ended.x), 1);
  EXPECT_NEAR(ended.report.relative_residual, problem.residual(ended.x), 1e-14);

  Problem spoilt = problem;
  spoilt.b[3] = std::numeric_limits<double>::quiet_NaN();
  const auto none = [](const Vector& v, Vector& z) {
    z = v;
    return true;
  };
  EXPECT_FALSE(solve(spoilt, none, {}).report.converged);
  spoilt.b.assign(30, 0.0);
  const Solved nothing = solve(spoilt, none, {});
  EXPECT_TRUE(nothing.report.converged);
  EXPECT_EQ(nothing.x, Vector(30, 0.0));
}

}  // namespace
}  // namespace fascia::gmres_test
