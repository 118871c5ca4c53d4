// A factor of a tangent before preconditions a few iterations, whose products go from block to block: what is solved is
// the present tangent's system, and in implicit dynamics few factors are made.
#include "core/run/drivers.hpp"
#include "core/tangent/cg_solver.hpp"
#include "core/tangent/kept_factor.hpp"
#include "core/tangent/preconditioners.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace fascia::old_factor_test {
namespace {

using namespace test;

/// Nodes up to there along x are held.
BuiltModel held_and_falling(BuiltModel built, double x = 0) {
  Model& model = built.model;
  for (int node = 0; node < model.node_count(); ++node) {
    if (model.rest_position[static_cast<std::size_t>(node)][0] > x + 1e-9) continue;
    FrameConstraint held;
    held.node = node;
    held.translations = held.rotations = 3;
    model.constraints.push_back(held);
  }
  add_gravity(built.model, {{0, -2, 0.3}});
  return built;
}

BuiltModel falling_block(std::array<int, 3> grid = {5, 2, 2}, double young = 1e4) {
  BlockOptions o;
  o.grid = grid;
  o.size = {{3, 1, 1}};
  o.young = young;
  return held_and_falling(block(o));
}

/// Tangents of states that go from one to another, each with a term beside its matrix.
struct Tangents {
  explicit Tangents(const Model& model) : executor(model.points, pool), filter(model), K(model, executor, filter) {}

  Linearization& at(const Model& model, double rotation, double term) {
    std::vector<double> g(static_cast<std::size_t>(model.dof_count()));
    const State state = random_state(model, 0.05 * rotation, rotation);
    executor.gradient(state, {}, g);
    executor.linearize(state, {}, Tangent::material, lin);
    RankOne beside{term, random_direction(model, 7)};
    lin.loads.volumes.push_back(beside);
    K.take(lin);
    return lin;
  }

  ThreadPool pool{2};
  CpuExecutor executor;
  DofFilter filter;
  TangentOperator K;
  Linearization lin;
};

double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double v : x) most = std::max(most, std::abs(v));
  return most;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
  return largest(difference) / largest(b);
}

/// On planes that are not along the axes, too: constraint axes are not those of the world.
TEST(TangentOperator, HasTheSameProductsBeforeAndAfterItIsAssembled) {
  BuiltModel built = falling_block();
  FrameConstraint slides;
  slides.node = built.model.node_count() - 1;
  slides.translations = 1;
  slides.translation_axes = rotation_about(normalized(Vec3d{{1, 2, -1}}), 0.7);
  built.model.constraints.push_back(slides);
  Tangents tangents(built.model);
  tangents.at(built.model, 0.1, 1e3);
  const std::vector<double> x = random_direction(built.model);
  std::vector<double> by_blocks(x.size()), by_matrix(x.size());
  tangents.K.apply(x, by_blocks);
  tangents.K.matrix();
  tangents.K.apply(x, by_matrix);
  EXPECT_LT(apart(by_blocks, by_matrix), 1e-12);
}

TEST(OldFactor, SolvesWithThePresentTangentAndTheTermsBesideIt) {
  const BuiltModel built = falling_block();
  Tangents tangents(built.model);
  FactorSolver kept(tangents.K), own(tangents.K);
  OldFactor old(tangents.K, kept);
  CgSolver cg(tangents.K, {}, kept);
  std::vector<double> b = random_direction(built.model), x(b.size()), exact(b.size());
  tangents.filter.clear_fixed(b);
  EXPECT_FALSE(old.is_kept());
  for (int k = 0; k < 4; ++k) {
    tangents.at(built.model, 0.02 * k, std::pow(10.0, k));
    EXPECT_EQ(old.is_kept(), k > 0);
    ASSERT_TRUE(old.prepare());
    const LinearReport report = cg.solve_by(old, b, x, {50, 1e-12});
    ASSERT_TRUE(report.usable && !report.unsolved);
    EXPECT_LE(report.iterations, k == 0 ? 2 : 14);
    old.took(report.iterations);
    ASSERT_TRUE(own.prepare());
    own.solve(b, exact);
    EXPECT_LT(apart(x, exact), 1e-9) << k;
  }
}

/// One that needs many iterations goes, and so does one that needs a few more than at first many times.
TEST(OldFactor, GoesWhereItIsOutOfDate) {
  const BuiltModel built = falling_block();
  Tangents tangents(built.model);
  FactorSolver factor(tangents.K);
  OldFactor old(tangents.K, factor);
  tangents.at(built.model, 0, 1);
  ASSERT_TRUE(old.prepare());
  EXPECT_FALSE(old.took(OldFactor::kMostIterations + 1));
  EXPECT_FALSE(old.is_kept());
  ASSERT_TRUE(old.prepare());
  int solves = 0;
  for (bool kept = old.took(2); kept && solves < 1000; ++solves) kept = old.took(6);
  EXPECT_GT(solves, 5);
  EXPECT_LT(solves, 10);
  ASSERT_TRUE(old.prepare());
  for (int solve = 0; solve < 1000; ++solve) ASSERT_TRUE(old.took(3));
  old.forget();
  EXPECT_FALSE(old.is_kept());
}

/// A factor that was shifted, or of a tangent that is not definite, preconditions nothing.
TEST(OldFactor, IsOfADefiniteTangent) {
  const BuiltModel built = falling_block();
  Tangents tangents(built.model);
  FactorSolver factor(tangents.K);
  OldFactor old(tangents.K, factor);
  Linearization& lin = tangents.at(built.model, 0.05, 1);
  ASSERT_TRUE(old.prepare());
  EXPECT_TRUE(old.is_kept());
  for (double& d : lin.node_blocks) d -= 1e6;
  const Relinearize itself = [&](TamerTangent) -> const Linearization& { return lin; };
  tangents.K.take(lin, &itself);
  EXPECT_FALSE(factor.prepare());
  EXPECT_FALSE(old.is_kept());
  EXPECT_FALSE(old.prepare());
}

struct Fallen {
  State end;
  RunReport report;
  SolverChoice choice;
};

Fallen fallen(const Model& model, TimeScheme scheme, LinearMethod linear, int steps) {
  ThreadPool pool(2);
  SolverSettings settings;
  settings.linear = linear;
  MechanicalSystem system(model, pool, settings);
  Fallen run{State::at_rest(model), {}, {}};
  run.report = run_implicit(system, run.end, kAlways, settings, {scheme, 0.02, steps}, {});
  EXPECT_EQ(run.report.status, RunStatus::converged) << run.report.message;
  run.choice = system.linear().choice();
  return run;
}

void expect_near(const State& a, const State& b, double tolerance) {
  double most = 0, difference = 0;
  for (std::size_t i = 0; i < b.u.size(); ++i) {
    most = std::max(most, norm(b.u[i]));
    difference = std::max(difference, norm(a.u[i] - b.u[i]));
  }
  EXPECT_LT(difference, tolerance * most);
}

/// Tangents that change so much that no factor serves another one: none is kept for a while, and then again.
TEST(KeptFactor, RestsWhereFactorsServeNothing) {
  const BuiltModel built = falling_block();
  Tangents tangents(built.model);
  FactorSolver factor(tangents.K);
  CgSolver cg(tangents.K, {}, factor);
  KeptFactor kept(tangents.K, factor, cg);
  std::vector<double> b = random_direction(built.model), x(b.size());
  tangents.filter.clear_fixed(b);
  tangents.at(built.model, 0.05, 1);
  for (int k = 0; k < 8; ++k) {
    EXPECT_FALSE(kept.rests());
    ASSERT_TRUE(factor.prepare());
    kept.renewed();
  }
  EXPECT_TRUE(kept.rests());
  int waited = 0;
  while (!kept.solve(b, x, 1e-6).usable && waited < 1000) ++waited;
  EXPECT_GT(waited, 10);
  EXPECT_LT(waited, 100);
  EXPECT_FALSE(kept.rests());
  EXPECT_EQ(kept.factors(), 8);
  EXPECT_EQ(kept.solves(), 1);
  for (int k = 0; k < 100; ++k) {  // those that serve never rest
    ASSERT_TRUE(factor.prepare());
    kept.renewed();
    for (int solve = 0; solve < 5; ++solve) ASSERT_TRUE(kept.solve(b, x, 1e-6).usable);
  }
  EXPECT_FALSE(kept.rests());
  for (int k = 0; k < 16; ++k) kept.renewed();
  EXPECT_TRUE(kept.rests());
  kept.begin_afresh();  // what was seen before counts no longer
  for (int k = 0; k < 7; ++k) {
    EXPECT_FALSE(kept.rests());
    kept.renewed();
  }
  EXPECT_FALSE(kept.rests());
}

/// Scattered frames: most of a step would go into assembling them.
BuiltModel falling_cloud() {
  BlockOptions o;
  o.size = {{1, 1, 1}};
  o.young = 1e4;
  return held_and_falling(build_cloud(scattered_spec(o, 0.25, 3)), 0.1);
}

/// Kept factors take the place of blocks; Newton's method takes as many iterations, and the end is the same.
TEST(KeptFactor, ServesManySolvesOfScatteredFrames) {
  const BuiltModel built = falling_cloud();
  ASSERT_GT(built.model.free_dof_count(), TangentSolver::kDirectDofsWithInertia);
  const Fallen exact = fallen(built.model, TimeScheme::bdf2, LinearMethod::cholesky, 5),
               kept = fallen(built.model, TimeScheme::bdf2, LinearMethod::automatic, 5);
  std::printf("%d unknowns: %d factors, %d solves with old ones, Newton's iterations %d and %d\n",
              built.model.free_dof_count(), kept.choice.factors, kept.choice.old, kept.report.newton_iterations,
              exact.report.newton_iterations);
  EXPECT_EQ(exact.choice.old, 0);
  EXPECT_EQ(exact.report.linear_iterations, 0);
  EXPECT_TRUE(kept.choice.direct);
  EXPECT_GT(kept.choice.old, 3 * kept.choice.factors);
  EXPECT_LE(kept.report.newton_iterations, exact.report.newton_iterations + 2);
  expect_near(kept.end, exact.end, 1e-6);
}

/// Such factors cost next to nothing, and tell whether a tangent is definite.
TEST(KeptFactor, IsNotTakenForFewUnknownsThatAreSoonAssembled) {
  const BuiltModel built = falling_block({3, 2, 2}, 1e5);
  ASSERT_LE(built.model.free_dof_count(), TangentSolver::kDirectDofsWithInertia);
  const Fallen small = fallen(built.model, TimeScheme::newmark, LinearMethod::automatic, 20);
  EXPECT_TRUE(small.choice.direct);
  EXPECT_EQ(small.choice.old, 0);
  EXPECT_EQ(small.report.linear_iterations, 0);
}

/// Statics, where a load step changes the tangent more, take a factor for each: the end of a limit point is judged by
/// it.
TEST(OldFactor, IsNotTakenInStatics) {
  const BuiltModel built = falling_block({9, 4, 4}, 1e5);
  ASSERT_GT(built.model.free_dof_count(), TangentSolver::kDirectDofsWithInertia);
  ThreadPool pool(2);
  MechanicalSystem system(built.model, pool, {});
  State end = State::at_rest(built.model);
  const RunReport run = run_statics(system, end, kRamp, {}, {}, {});
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  EXPECT_EQ(system.linear().choice().old, 0);
  EXPECT_EQ(run.linear_iterations, 0);
}

}  // namespace
}  // namespace fascia::old_factor_test
