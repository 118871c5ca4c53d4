// Which linear solver the program chooses by itself, in statics and in dynamics, and that its answers are the factor's.
#include "core/run/drivers.hpp"
#include "core/tangent/tangent_solver.hpp"
#include "tests/support/models.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fascia::chosen_solver_test {
namespace {

using namespace test;

/// A block that is held at one end and falls.
BuiltModel falling(std::array<int, 3> grid, const Vec3d& size, double young) {
  BlockOptions o;
  o.young = young;
  o.grid = grid;
  o.size = size;
  BuiltModel built = block(o);
  hold_face(built.model);
  add_gravity(built.model, {{0, -2, 0.3}});
  return built;
}
BuiltModel cube() { return falling({6, 6, 6}, {{1, 1, 1}}, 1e4); }
BuiltModel beam() { return falling({40, 2, 2}, {{40, 1, 1}}, 1e11); }

struct Chosen {
  State end;
  RunReport run;
  SolverChoice choice;
};

Chosen run(const Model& model, const SolverSettings& settings, bool dynamics) {
  ThreadPool pool(2);
  MechanicalSystem system(model, pool, settings);
  Chosen out{State::at_rest(model), {}, {}};
  DynamicsSettings steps;
  steps.time_step = 0.01;
  steps.steps = 5;
  out.run = dynamics ? run_implicit(system, out.end, kRamp, settings, steps, {})
                     : run_statics(system, out.end, kRamp, settings, {}, {});
  EXPECT_EQ(out.run.status, RunStatus::converged) << out.run.message;
  EXPECT_GT(model.free_dof_count(), TangentSolver::kDirectDofsWithInertia);
  out.choice = system.linear().choice();
  return out;
}

/// Both runs solve to 1e-8 of what acts.
void expect_as_by_factor(const Model& model, const Chosen& chosen, bool dynamics) {
  SolverSettings direct;
  direct.linear = LinearMethod::cholesky;
  const Chosen exact = run(model, direct, dynamics);
  EXPECT_TRUE(exact.choice.direct);
  EXPECT_EQ(exact.run.linear_iterations, 0);
  // Where a step is all but linear, one direction of a factor's is enough, and of conjugate gradients two are.
  EXPECT_LE(chosen.run.newton_iterations, 2 * exact.run.newton_iterations);
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < exact.end.u.size(); ++i) {
    largest = std::max(largest, norm(exact.end.u[i]));
    difference = std::max(difference, norm(exact.end.u[i] - chosen.end.u[i]));
  }
  EXPECT_LT(difference, 1e-7 * largest);
}

/// No factor is made there, nor even thought of.
TEST(ChosenSolver, TriesBlocksFirstInDynamics) {
  const BuiltModel built = cube();
  const Chosen chosen = run(built.model, {}, true);
  EXPECT_FALSE(chosen.choice.direct);
  EXPECT_TRUE(chosen.choice.levels.empty());
  EXPECT_EQ(chosen.choice.flops, 0);
  EXPECT_GT(chosen.run.linear_iterations, chosen.run.newton_iterations);
  expect_as_by_factor(built.model, chosen, true);
}

/// The blocks of a slender body gain nothing in a few iterations, once.
TEST(ChosenSolver, TakesAFactorInDynamicsWhereThatIsCheaper) {
  const BuiltModel built = beam();
  const Chosen chosen = run(built.model, {}, true);
  EXPECT_TRUE(chosen.choice.direct);
  EXPECT_GT(chosen.run.linear_iterations, 0);
  EXPECT_LE(chosen.run.linear_iterations, BlocksOrLevels({}).patience());
  expect_as_by_factor(built.model, chosen, true);
}

/// Conjugate gradients go on to Newton's tolerance where nothing is left for a second direction.
TEST(ChosenSolver, TakesOneDirectionAStepOfALinearModel) {
  ElementOptions o;
  o.formulation = ElementFormulation::linear;
  o.cells = {8, 6, 5};
  o.distortion = 0;
  ElementModel built = element_model(o);
  hold_face(built.model);
  add_gravity(built.model, {{0, -2, 0.3}});
  const Chosen chosen = run(built.model, {}, true);
  EXPECT_FALSE(chosen.choice.direct);
  EXPECT_EQ(chosen.run.newton_iterations, 5);
  expect_as_by_factor(built.model, chosen, true);
}

TEST(ChosenSolver, FactorisesSmallModelsInStatics) {
  BuiltModel built = cube();
  const Chosen chosen = run(built.model, {}, false);
  EXPECT_TRUE(chosen.choice.direct);
  EXPECT_EQ(chosen.run.linear_iterations, 0);
}

/// A limit of iterations would cut blocks short.
TEST(ChosenSolver, LeavesWhatTheUserSaidToAFactor) {
  SolverSettings few;
  few.cg.max_iterations = 100;
  EXPECT_TRUE(run(cube().model, few, true).choice.direct);
}

/// A preconditioner is of conjugate gradients: who names one asks for these.
TEST(ChosenSolver, TakesThePreconditionerThatTheUserNames) {
  const BuiltModel built = cube();
  SolverSettings asked;
  for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::multigrid}) {
    asked.preconditioner = kind;
    const Chosen chosen = run(built.model, asked, false);
    EXPECT_FALSE(chosen.choice.direct);
    EXPECT_EQ(chosen.choice.preconditioner, kind);
    EXPECT_GT(chosen.run.linear_iterations, 0);
    if (kind == PreconditionerKind::multigrid) expect_as_by_factor(built.model, chosen, false);
  }
  const SolverChoice in_dynamics = run(built.model, asked, true).choice;
  EXPECT_FALSE(in_dynamics.direct);
  EXPECT_EQ(in_dynamics.preconditioner, PreconditionerKind::multigrid);
}

}  // namespace
}  // namespace fascia::chosen_solver_test
