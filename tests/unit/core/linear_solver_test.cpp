// A linear solver of the caller's own takes the place of conjugate gradients and of Cholesky's factor: in Newton's
// method, beside loads without a potential, and where stability is asked for.
#include "core/linear/cg.hpp"
#include "core/run/drivers.hpp"
#include "core/tangent/cg_solver.hpp"
#include "core/tangent/preconditioners.hpp"
#include "core/tangent/stability.hpp"
#include "core/tangent/tangent_operator.hpp"
#include "tests/support/statics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <array>
#include <cmath>
#include <cstdio>

namespace fascia::linear_solver_test {
namespace {

using namespace test;

/// A dense inverse, from products alone.
class DenseSolver final : public LinearSolver {
 public:
  struct Counts {
    int prepared = 0, solves = 0;
  };
  DenseSolver(TangentOperator& K, Counts& counts) : K_(K), counts_(counts) {}

  bool prepare() override {
    ++counts_.prepared;
    const std::size_t n = K_.filter().size();
    std::vector<double> e(n), column(n);
    free_.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (!K_.filter().is_fixed(i)) free_.push_back(i);
    const auto m = static_cast<Eigen::Index>(free_.size());
    Eigen::MatrixXd dense(m, m);
    for (Eigen::Index j = 0; j < m; ++j) {
      e.assign(n, 0);
      e[free_[static_cast<std::size_t>(j)]] = 1;
      K_.apply_free(e, column);
      for (Eigen::Index i = 0; i < m; ++i) dense(i, j) = column[free_[static_cast<std::size_t>(i)]];
    }
    factor_.compute(dense);
    negative_ =
        static_cast<int>((Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues().array() < 0).count());
    return negative_ == 0;
  }

  LinearReport solve(std::span<const double> b, std::span<double> x, double) override {
    ++counts_.solves;
    const auto m = static_cast<Eigen::Index>(free_.size());
    Eigen::VectorXd rhs(m);
    for (Eigen::Index i = 0; i < m; ++i) rhs[i] = b[free_[static_cast<std::size_t>(i)]];
    const Eigen::VectorXd y = factor_.solve(rhs);
    std::fill(x.begin(), x.end(), 0.0);
    for (Eigen::Index i = 0; i < m; ++i) x[free_[static_cast<std::size_t>(i)]] = y[i];
    LinearReport report;
    report.negative = negative_;
    return report;
  }

  bool iterates() const override { return false; }

 private:
  TangentOperator& K_;
  Counts& counts_;
  std::vector<std::size_t> free_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
  int negative_ = 0;
};

/// With the solver of its own, and with Cholesky's factor; the counts are those of the first.
DenseSolver::Counts expect_equal(const Model& model) {
  DenseSolver::Counts counts;
  SolverSettings own, usual;
  usual.linear = LinearMethod::cholesky;
  own.own = [&](TangentOperator& K) { return std::make_unique<DenseSolver>(K, counts); };
  const Solved a = solved(model, own), b = solved(model, usual);
  EXPECT_EQ(a.run.newton_iterations, b.run.newton_iterations);
  EXPECT_EQ(a.run.stability.known, b.run.stability.known);
  EXPECT_EQ(a.run.stability.unstable, b.run.stability.unstable);
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < a.end.u.size(); ++i) {
    largest = std::max(largest, norm(b.end.u[i]));
    difference = std::max(difference, norm(a.end.u[i] - b.end.u[i]));
  }
  EXPECT_LT(difference, 1e-9 * largest);
  return counts;
}

BuiltModel held_block() {
  BlockOptions o;
  o.grid = {6, 2, 2};
  o.size = {{4, 1, 1}};
  BuiltModel built = block(o);
  hold_face(built.model);
  return built;
}

TEST(LinearSolver, OfTheCallerTakesThePlaceOfOurs) {
  BuiltModel built = held_block();
  add_gravity(built.model, {{0, -0.5, 0.2}});
  const DenseSolver::Counts counts = expect_equal(built.model);
  EXPECT_GT(counts.prepared, 3);
  EXPECT_GE(counts.solves, counts.prepared);
}

TEST(LinearSolver, OfTheCallerPreconditionsWhatLoadsWithoutAPotentialAdd) {
  BuiltModel built = held_block();
  const int last = built.model.node_count() - 1;
  built.model.followers.push_back({0, {{0, 30, 10}}, {}, {last}, {1.0}, {{}}, {}});
  const DenseSolver::Counts counts = expect_equal(built.model);
  EXPECT_GT(counts.solves, 2 * counts.prepared);  // GMRES takes several
}

/// A column that gravity bends far past its critical load meets indefinite tangents on the way.
TEST(LinearSolver, OfTheCallerNeedNotKnowIndefiniteTangents) {
  BlockOptions o;
  o.grid = {10, 2, 2};
  o.size = {{8, 1, 1}};
  BuiltModel built = block(o);
  hold_face(built.model);
  add_gravity(built.model, {{-0.05, 0.0005, 0}});
  const DenseSolver::Counts counts = expect_equal(built.model);
  EXPECT_LT(counts.solves, counts.prepared);  // some were not taken
}

/// Levels are kept from tangent to tangent: a cycle multiplies with the one that is solved with, from the first on.
TEST(LinearSolver, KeptLevelsTakeProductsWithThePresentTangent) {
  BuiltModel built = held_block();
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  const DofFilter filter(built.model);
  LinearSettings settings;
  settings.preconditioner = PreconditionerKind::multigrid;
  const auto dofs = static_cast<std::size_t>(built.model.dof_count());
  std::vector<Linearization> tangents(2);
  std::vector<double> b(dofs);
  for (std::size_t k = 0; k < tangents.size(); ++k) {
    const State state = random_state(built.model, 0.01 * static_cast<double>(1 + k), 0.05);
    executor.gradient(state, {}, b);
    executor.linearize(state, {}, Tangent::material, tangents[k]);
  }
  filter.clear_fixed(b);
  std::vector<std::vector<double>> found;
  for (const bool assembled_before : {false, true}) {
    TangentOperator K(built.model, executor, filter);
    FactorSolver factor(K);
    CgSolver solver(K, settings, factor);
    std::vector<double>& x = found.emplace_back(dofs);
    for (const Linearization& tangent : tangents) {
      K.take(tangent);
      if (assembled_before) K.matrix();
      solver.prepare();
      const LinearReport report = solver.solve(b, x);
      EXPECT_TRUE(report.usable && !report.unsolved) << report.trouble;
    }
    EXPECT_NE(solver.levels(), nullptr);
  }
  EXPECT_EQ(found[0], found[1]);
}

/// Held in axes of the world, or in others; with a term beside the matrix, or without.
TEST(LinearSolver, LoopsThatDoSeveralThingsSolveAsLoopsOfTheirOwn) {
  for (const bool turned : {false, true}) {
    BuiltModel built = held_block();
    if (turned) {
      FrameConstraint& first = built.model.constraints.front();
      first.translation_axes = rotation_about(normalized(Vec3d{{1, 1, 2}}), 0.9);
      first.translations = 2;
    }
    ThreadPool pool(2);
    CpuExecutor executor(built.model.points, pool);
    const DofFilter filter(built.model);
    ASSERT_EQ(filter.turns(), turned);
    Linearization tangent;
    std::vector<double> b(static_cast<std::size_t>(built.model.dof_count()));
    executor.gradient(random_state(built.model, 1e-3, 0.01), {}, b);
    executor.linearize(random_state(built.model, 1e-3, 0.01), {}, Tangent::material, tangent);
    filter.clear_fixed(b);
    for (const bool beside : {false, true}) {
      if (beside) tangent.loads.volumes.push_back({10 / dot(b, b), b});
      TangentOperator K(built.model, executor, filter);
      FactorSolver factor(K);
      K.take(tangent);
      std::vector<double> next = b, rounded(b.size()), product(b.size());
      const double power = K.apply_free_next(b, -0.5, next, rounded, true);
      K.apply_free(next, product);
      EXPECT_NEAR(power, dot(next, rounded), 1e-13 * norm(next) * norm(rounded));
      for (std::size_t i = 0; i < b.size(); ++i) {
        EXPECT_EQ(next[i], b[i] - 0.5 * b[i]);
        rounded[i] -= product[i];
      }
      EXPECT_LT(norm(rounded), 1e-6 * norm(product));
      for (const PreconditionerKind kind :
           {PreconditionerKind::none, PreconditionerKind::jacobi, PreconditionerKind::block_jacobi}) {
        LinearSettings settings;
        settings.preconditioner = kind;
        settings.cg = {2000, 1e-10};
        CgSolver solver(K, settings, factor);
        solver.prepare();
        std::vector<double> x(b.size()), expected(b.size());
        const LinearReport found = solver.solve(b, x);
        const auto M = preconditioner_of(kind, K, factor);
        ASSERT_TRUE(M->prepare());
        const CgReport report = conjugate_gradients(
            K.vectors(), [&](const auto& p, auto& Ap) { K.apply_free(p, Ap); },
            [&](const auto& r, auto& z) { return M->apply(r, z); }, b, expected, settings.cg);
        EXPECT_EQ(report.status, CgStatus::converged);
        EXPECT_FALSE(found.unsolved);
        EXPECT_NEAR(found.iterations, report.iterations, 2 + 0.02 * report.iterations);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] -= expected[i];
        EXPECT_LT(norm(x), 1e-8 * norm(expected)) << turned << beside;
      }
    }
  }
}

double largest_difference(const State& a, const State& b) {
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    largest = std::max(largest, norm(b.u[i]));
    difference = std::max(difference, norm(a.u[i] - b.u[i]));
  }
  return difference / largest;
}

/// Conjugate gradients with each precision, and a tolerance that leaves the difference to it.
std::array<SolverSettings, 2> double_and_mixed() {
  std::array<SolverSettings, 2> settings;
  for (SolverSettings& s : settings) {
    s.linear = LinearMethod::cg;
    s.tolerance = 1e-10;
  }
  settings[1].precision = Precision::mixed;
  return settings;
}

TEST(LinearSolver, MixedPrecisionEndsAtTheSameEquilibrium) {
  BuiltModel built = held_block();
  add_gravity(built.model, {{0, -0.5, 0.2}});
  const auto [exactly, rounded] = double_and_mixed();
  const Solved a = solved(built.model, exactly), b = solved(built.model, rounded);
  EXPECT_NE(b.run.linear_iterations, a.run.linear_iterations);
  EXPECT_LT(largest_difference(b.end, a.end), 1e-9);
}

TEST(LinearSolver, MixedPrecisionGoesTheSameWayInTime) {
  BuiltModel built = held_block();
  add_gravity(built.model, {{0, -0.5, 0.2}});
  State ends[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const SolverSettings settings = double_and_mixed()[k];
    ThreadPool pool(2);
    MechanicalSystem system(built.model, pool, settings);
    ends[k] = State::at_rest(built.model);
    const RunReport run = run_implicit(system, ends[k], kAlways, settings, {TimeScheme::newmark, 0.05, 10}, nullptr);
    EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  }
  const double difference = largest_difference(ends[1], ends[0]);
  EXPECT_LT(difference, 1e-9);
  EXPECT_GT(difference, 0);
}

/// A beam six hundred times as long as thick: rounded to 32 bits, its softest directions may have any stiffness.
TEST(LinearSolver, MixedPrecisionGoesBackWhereRoundingMakesATangentIndefinite) {
  BlockOptions o;
  o.grid = {12, 2, 2};
  o.size = {{12, 0.02, 0.02}};
  BuiltModel built = block(o);
  hold_face(built.model);
  ThreadPool pool(2);
  CpuExecutor executor(built.model.points, pool);
  const DofFilter filter(built.model);
  std::vector<double> b(static_cast<std::size_t>(built.model.dof_count())), x = b;
  const State state = random_state(built.model, 1e-3, 0.01);
  executor.gradient(state, {}, b);
  Linearization tangent;
  executor.linearize(state, {}, Tangent::material, tangent);
  TangentOperator K(built.model, executor, filter);
  FactorSolver factor(K);
  b = smooth_motion(built.model);
  filter.clear_fixed(b);
  K.take(tangent);
  const auto iterations = [&](CgSolver& solver) {
    const LinearReport report = solver.solve(b, x);
    EXPECT_TRUE(report.usable && !report.unsolved) << report.trouble;
    EXPECT_EQ(report.negative, 0);
    return report.iterations;
  };
  LinearSettings settings;
  settings.preconditioner = PreconditionerKind::block_jacobi;
  settings.cg = {100000, 1e-6};
  CgSolver exact(K, settings, factor);
  settings.precision = Precision::mixed;
  CgSolver rounded(K, settings, factor);
  const int in_double = iterations(exact), at_first = iterations(rounded);
  std::printf("thin beam: iterations %d, and %d with those in 32 bits before\n", in_double, at_first);
  EXPECT_GT(at_first, in_double);
  EXPECT_EQ(iterations(rounded), in_double);
}

TEST(LinearSolver, NothingIsPreparedWhereNothingIsFree) {
  BuiltModel built = held_block();
  for (int node = 0; node < built.model.node_count(); ++node) {
    FrameConstraint c;
    c.node = node;
    c.translations = c.rotations = 3;
    if (static_cast<std::size_t>(node) >= built.model.constraints.size()) built.model.constraints.push_back(c);
    built.model.constraints[static_cast<std::size_t>(node)] = c;
  }
  DenseSolver::Counts counts;
  SolverSettings own;
  own.own = [&](TangentOperator& K) { return std::make_unique<DenseSolver>(K, counts); };
  solved(built.model, own);
  EXPECT_EQ(counts.prepared, 0);
}

}  // namespace
}  // namespace fascia::linear_solver_test
