#include "core/run/path_following.hpp"
#include "core/run/path_measure.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cstdio>

namespace fascia::path_test {
namespace {

using namespace test;

/// Equilibrium at a load factor, by load control.
State equilibrium(const Model& model, double lambda) {
  ThreadPool pool(1);
  SolverSettings settings;
  settings.tolerance = 1e-12;
  MechanicalSystem system(model, pool, settings);
  State state = State::at_rest(model);
  const FactorFunction factors = [&](double t) { return std::vector<double>(zero_factors(model).size(), t * lambda); };
  const RunReport report = run_statics(system, state, factors, settings, {}, nullptr);
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  return state;
}

/// d_f against differences of equilibria: displacements of the nodes, and what no equilibrium has, d_r.
void expect_tangent_of_path(const char* name, const Model& model) {
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  const double lambda = 0.6, h = 1e-4;
  system.begin_step(equilibrium(model, lambda), 0);
  const std::size_t n = zero_factors(model).size();
  system.set_factors(std::vector<double>(n, lambda));
  system.evaluate();
  const PathDirections d =
      system.path_directions(std::vector<double>(n, lambda + h), std::vector<double>(n, lambda - h), 2 * h);
  ASSERT_TRUE(d.usable);
  EXPECT_EQ(d.unstable, 0);
  const State ahead = equilibrium(model, lambda + h), behind = equilibrium(model, lambda - h);
  const Translations translations(model);
  double squared = 0;
  for (int i = 0; i < model.node_count(); ++i)
    squared += squared_norm((ahead.u[at(i)] - behind.u[at(i)]) * (0.5 / h) - translations.translation(d.d_f, i));
  const double error = std::sqrt(squared) / translations.norm(d.d_f);
  std::printf("%s: d_f against differences of equilibria %.1e, d_r %.1e\n", name, error,
              translations.norm(d.d_r) / translations.norm(d.d_f));
  EXPECT_LT(error, 1e-6);
  EXPECT_LT(translations.norm(d.d_r), 1e-8 * translations.norm(d.d_f));
}

TEST(Path, TangentIsThatOfTheEquilibria) {
  BlockOptions o;
  o.grid = {4, 2, 2};
  o.size = {{1, 0.3, 0.3}};
  for (const bool affine : {false, true}) {
    o.affine = affine;
    BuiltModel built = block(o);
    hold_face(built.model);
    add_gravity(built.model, {{1, -3, 2}});
    expect_tangent_of_path(affine ? "affine" : "rigid", built.model);
  }
}

/// The numbers of negative pivots and of negative eigenvalues, and solutions of an indefinite system.
TEST(Path, IndefiniteFactorCountsAndSolves) {
  BlockOptions o;
  o.grid = {3, 2, 2};
  BuiltModel built = block(o);
  hold_face(built.model);
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  system.begin_step(State::at_rest(built.model), 0);
  system.evaluate();
  system.direction();
  const BlockMatrix& matrix = system.linear().tangent().matrix();
  const DofFilter& filter = system.filter();
  const auto n = static_cast<Eigen::Index>(filter.size());
  for (const double shift : {0.0, -0.1, -0.3, -0.7}) {
    BlockCholesky factor(matrix, filter);
    ASSERT_TRUE(factor.factorize(matrix, Pivots::any, shift, &matrix));
    // The inverse by columns, whose eigenvalues have the signs of the matrix's.
    std::vector<int> free;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!filter.is_fixed(static_cast<std::size_t>(i))) free.push_back(static_cast<int>(i));
    const auto m = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd inverse(m, m);
    std::vector<double> b(filter.size()), x(filter.size());
    for (Eigen::Index c = 0; c < m; ++c) {
      b.assign(b.size(), 0);
      b[at(free[at(static_cast<int>(c))])] = 1;
      factor.solve(b, x);
      for (Eigen::Index r = 0; r < m; ++r) inverse(r, c) = x[at(free[at(static_cast<int>(r))])];
    }
    EXPECT_LT((inverse - inverse.transpose()).norm(), 1e-8 * inverse.norm());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(inverse);
    int negative = 0;
    for (Eigen::Index k = 0; k < m; ++k) negative += eigen.eigenvalues()[k] < 0 ? 1 : 0;
    EXPECT_EQ(factor.negative_pivots(), negative) << shift;
    EXPECT_EQ(negative > 0, shift < -0.05) << shift;
  }
}

/// A cubic through values and slopes: exact for a cubic.
TEST(Path, LoadCurveIsTheCubic) {
  const auto f = [](double s) { return 1 - 3 * s + 5 * s * s - 4 * s * s * s; };
  const auto slope = [](double s) { return -3 + 10 * s - 12 * s * s; };
  const LoadCurve curve{f(0), slope(0), f(1), slope(1)};
  for (const double s : {0.1, 0.45, 0.8}) {
    EXPECT_NEAR(curve.value(s), f(s), 1e-14);
    EXPECT_NEAR(curve.slope(s), slope(s), 1e-14);
  }
  const LoadCurve hill{0, 4, 0, -4};  // 4 s (1 − s)
  EXPECT_TRUE(hill.has_extremum());
  EXPECT_NEAR(hill.extremum(), 0.5, 1e-12);
  EXPECT_NEAR(hill.first_at(0.75), 0.25, 1e-12);
  EXPECT_GT(hill.first_at(1.01), 1);
}

/// The controlled displacement of a point between turned frames against differences.
TEST(Path, ControlledDisplacementHasItsDerivative) {
  for (const bool affine : {false, true}) {
    BlockOptions o;
    o.affine = affine;
    const BuiltModel built = block(o);
    const Attachment place = built.bodies[0].attach({{0.4, 0.3, 0.9}});
    const ControlledPoint point{place.nodes, place.influences, {{0.6, 0, -0.8}}, {}};
    const State state = random_state(built.model, 0.1, 0.5);
    std::vector<double> d(at(built.model.dof_count()));
    std::mt19937 random(3);
    for (double& v : d) v = random_vector(random, 1)[0];
    const double h = 1e-5;
    const double difference = (controlled_displacement(point, moved(built.model, state, d, h)) -
                               controlled_displacement(point, moved(built.model, state, d, -h))) /
                              (2 * h);
    EXPECT_NEAR(controlled_rate(point, built.model, state, d), difference, 1e-8);
  }
}

}  // namespace
}  // namespace fascia::path_test
