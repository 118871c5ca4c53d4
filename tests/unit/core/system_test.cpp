#include "core/run/drivers.hpp"
#include "core/run/implicit_stepper.hpp"
#include "core/run/modes.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/structure/inertia.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::system_test {
namespace {

using namespace test;

/// Loads and inertia of a time step against differences of their energy, with mass damping.
TEST(MechanicalSystem, GradientOfAStepIsThatOfItsEnergy) {
  BlockOptions o;
  o.mass_damping = 3;
  o.stiffness_damping = 0.01;
  BuiltModel built = block(o);
  add_gravity(built.model, {{1, -9.81, 2}});
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  State start = random_state(built.model, 0.01, 0.2);
  std::mt19937 random(5);
  for (Vec3d& v : start.v) v = random_vector(random, 1);
  for (std::size_t i = 0; i < start.Q_dot.size(); ++i)
    start.Q_dot[i] = skew(random_vector(random, 2)) * (Mat3d::identity() + start.D[i]);
  system.set_factors(std::vector<double>{0.7});
  system.begin_step(start, 0.02);
  system.evaluate();
  system.direction();
  system.apply(0.3);  // any place that is neither the start nor the end
  system.evaluate();
  const std::vector<double> g(system.gradient().begin(), system.gradient().end());
  const DirectionReport d = system.direction();
  system.save();
  const double h = 1e-5;
  system.apply(h);
  const double plus = system.evaluate().energy;
  system.restore();
  system.apply(-h);
  const double minus = system.evaluate().energy;
  const double error = std::abs((plus - minus) / (2 * h) - d.slope) / std::abs(d.slope);
  std::printf("step energy against its gradient: %.1e\n", error);
  EXPECT_LT(error, 1e-7);
}

/// Newton on a smooth problem ends quadratically, which only an exact tangent gives.
TEST(MechanicalSystem, NewtonConvergesQuadratically) {
  BlockOptions o;
  o.grid = {5, 3, 3};
  o.size = {{2, 0.5, 0.5}};
  BuiltModel built = block(o);
  hold_face(built.model);
  add_gravity(built.model, {{0, -0.03, 0.01}});
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  system.begin_step(State::at_rest(built.model), 0);
  system.set_factors(std::vector<double>{1.0});
  std::vector<double> residuals;
  for (int i = 0; i < 12; ++i) {
    const Evaluation e = system.evaluate();
    residuals.push_back(e.relative);
    if (e.relative < 1e-11) break;
    system.direction();
    system.apply(1);
  }
  bool quadratic = false;
  for (std::size_t i = 1; i + 1 < residuals.size(); ++i)
    quadratic = quadratic ||
                (residuals[i] < 1e-3 && residuals[i] > 1e-6 && residuals[i + 1] < 1e3 * residuals[i] * residuals[i]);
  EXPECT_TRUE(quadratic);
  EXPECT_LT(residuals.back(), 1e-9);
}

TEST(RigidMotion, HasNoEnergyAndNoForce) {
  for (const bool half : {true, false}) {
    BlockOptions o;
    o.half_blend = half;
    o.grid = {4, 3, 3};
    o.rotation = rotation_about(normalized(Vec3d{{1, 2, 3}}), 0.7);
    o.translation = {{3, -1, 2}};
    const BuiltModel built = block(o);
    const double scale = o.young;
    ThreadPool pool(1);
    CpuExecutor executor(built.model.points, pool);
    std::vector<double> g(static_cast<std::size_t>(built.model.dof_count()));
    for (const double angle : {1e-3, 1.0, 3.0}) {
      const State state =
          rigid_state(built.model, rotation_increment(normalized(Vec3d{{2, -1, 1}}) * angle), {{10, 20, -5}});
      const InternalEnergy energy = executor.gradient(state, {}, g);
      EXPECT_LT(energy.total(), 1e-12 * scale);
      EXPECT_LT(test::norm(g), 1e-12 * scale * 10);
    }
  }
}

TEST(InternalForces, AreInEquilibriumInEveryState) {
  const BuiltModel built = block();
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  const State state = random_state(built.model, 0.05, 0.5);
  std::vector<double> g(static_cast<std::size_t>(built.model.dof_count()));
  executor.gradient(state, {}, g);
  Vec3d force, moment;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const Vec3d f{{g[6 * i], g[6 * i + 1], g[6 * i + 2]}}, t{{g[6 * i + 3], g[6 * i + 4], g[6 * i + 5]}};
    force += f;
    moment += t + cross(built.model.rest_position[i] + state.u[i], f);
  }
  EXPECT_LT(norm(force), 1e-12 * test::norm(g));
  EXPECT_LT(norm(moment), 1e-12 * test::norm(g));
}

TEST(InternalEnergy, DoesNotChangeUnderASuperposedRotation) {
  const BuiltModel built = block();
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  const State state = random_state(built.model, 0.05, 0.5);
  const Mat3d D = rotation_increment({{0.4, -1.1, 0.8}});
  State turned = state;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    turned.u[i] = state.u[i] + D * (built.model.rest_position[i] + state.u[i]);
    turned.D[i] = compose_increments(D, state.D[i]);
  }
  std::vector<double> g(static_cast<std::size_t>(built.model.dof_count()));
  const double before = executor.gradient(state, {}, g).total(), after = executor.gradient(turned, {}, g).total();
  EXPECT_NEAR(after, before, 1e-12 * before);
}

TEST(Results, CgAgreesWithCholesky) {
  BlockOptions o;
  o.grid = {12, 4, 4};
  o.size = {{4, 1, 1}};
  BuiltModel built = block(o);
  hold_face(built.model);
  add_gravity(built.model, {{0, -0.5, 0}});
  State ends[6];
  int k = 0;
  for (const auto& [method, preconditioner] : {std::pair{LinearMethod::cholesky, PreconditionerKind::automatic},
                                               std::pair{LinearMethod::cg, PreconditionerKind::block_jacobi},
                                               std::pair{LinearMethod::cg, PreconditionerKind::jacobi},
                                               std::pair{LinearMethod::cg, PreconditionerKind::cholesky},
                                               std::pair{LinearMethod::cg, PreconditionerKind::none},
                                               std::pair{LinearMethod::cg, PreconditionerKind::multigrid}}) {
    ThreadPool pool(2);
    SolverSettings settings;
    settings.linear = method;
    settings.preconditioner = preconditioner;
    settings.cg.max_iterations = 5000;
    MechanicalSystem system(built.model, pool, settings);
    ends[k] = State::at_rest(built.model);
    EXPECT_EQ(run_statics(system, ends[k], kRamp, settings, {}, nullptr).status, RunStatus::converged);
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < ends[0].u.size(); ++i) {
      largest = std::max(largest, norm(ends[0].u[i]));
      difference = std::max(difference, norm(ends[k].u[i] - ends[0].u[i]));
    }
    EXPECT_LT(difference, 1e-6 * largest);
    ++k;
  }
}

TEST(FreeBody, HasExactlySixZeroModes) {
  for (const GridWeightKind weights : {GridWeightKind::trilinear, GridWeightKind::linear}) {
    for (const std::array<int, 3> grid : {std::array{4, 3, 3}, std::array{3, 3, 2}, std::array{2, 2, 2}}) {
      BlockOptions o;
      o.grid = grid;
      o.weights = weights;
      const BuiltModel built = block(o);
      ThreadPool pool(1);
      const Modes modes = natural_modes(built.model, pool, 8);
      ASSERT_TRUE(modes.converged);
      EXPECT_LT(modes.frequency[5], 1e-4 * modes.frequency[6]) << grid[0] << grid[1] << grid[2];
    }
  }
}

TEST(Inertia, OfARigidMotionIsExact) {
  BlockOptions o;
  o.grid = {3, 4, 2};
  o.size = {{1, 2, 0.5}};
  o.rotation = rotation_about(normalized(Vec3d{{1, 1, 0}}), 0.4);
  const BuiltModel built = block(o);
  const Vec3d v{{1, 2, 3}}, w{{0.3, -2, 1}}, about{{0.2, 0.1, -0.4}};
  const Vec3d center = o.rotation * Vec3d{{0.5, 1, 0.25}};
  Momentum sum;
  for (std::size_t i = 0; i < built.model.inertia.size(); ++i) {
    const Vec3d& X = built.model.rest_position[i];
    const Momentum m =
        momentum_of(built.model.inertia[i], X, Mat3d::identity(), v + cross(w, X - center), skew(w), about);
    sum.linear += m.linear;
    sum.angular += m.angular;
    sum.kinetic_energy += m.kinetic_energy;
    sum.mass += m.mass;
  }
  const double mass = o.density * 1 * 2 * 0.5;
  const Vec3d principal{{mass * (4 + 0.25) / 12, mass * (1 + 0.25) / 12, mass * (1 + 4) / 12}};
  const Vec3d w_local = transpose(o.rotation) * w;
  Vec3d spin_local;
  for (int a = 0; a < 3; ++a) spin_local[a] = principal[a] * w_local[a];
  const Vec3d spin = o.rotation * spin_local;
  const double kinetic = 0.5 * mass * squared_norm(v) + 0.5 * dot(w, spin);
  EXPECT_NEAR(sum.mass, mass, 1e-12 * mass);
  EXPECT_NEAR(sum.kinetic_energy, kinetic, 1e-12 * kinetic);
  EXPECT_LT(norm(sum.linear - v * mass), 1e-12 * mass * norm(v));
  EXPECT_LT(norm(sum.angular - (spin + cross(center - about, v * mass))), 1e-12 * norm(spin) * 10);
}

/// Implicit Euler from rest: −g h² n (n + 1) / 2, no strain, one Newton iteration a step.
TEST(ImplicitEuler, FreeFallIsExactForTheScheme) {
  for (const double h : {1e-6, 1e-3, 0.05}) {
    BuiltModel built = block();
    add_gravity(built.model, {{0, 0, -9.81}});
    ThreadPool pool(1);
    SolverSettings settings;
    settings.tolerance = 1e-13;  // down to the rounding floor
    MechanicalSystem system(built.model, pool, settings);
    State state = State::at_rest(built.model);
    const int n = 20;
    const RunReport report =
        run_implicit(system, state, kAlways, settings, {TimeScheme::implicit_euler, h, n}, nullptr);
    EXPECT_EQ(report.status, RunStatus::converged) << report.message;
    EXPECT_LE(report.newton_iterations, n);
    const double expected = -9.81 * h * h * n * (n + 1) / 2;
    for (const Vec3d& u : state.u) EXPECT_NEAR(u[2], expected, 1e-12 * std::abs(expected));
    EXPECT_LT(system.internal_energy().elastic, 1e-20 * 1e4);
  }
}

/// A step starts where the one before it ended, whose elastic energy is known: a system that forgot it evaluates once
/// more, and ends at the same.
TEST(ImplicitEuler, EvaluatesNoStateTwice) {
  BlockOptions o;
  o.stiffness_damping = 0.01;
  for (const bool affine : {false, true}) {
    o.affine = affine;
    BuiltModel built = block(o);
    add_gravity(built.model, {{0, 3, -9.81}});
    FrameConstraint held;
    held.translations = held.rotations = 3;
    held.whole = affine;
    built.model.constraints.push_back(held);
    ThreadPool pool(2);
    const SolverSettings settings;
    MechanicalSystem system(built.model, pool, settings), anew(built.model, pool, settings);
    State state = State::at_rest(built.model), other = state;
    ImplicitStepper stepper(system, settings, TimeScheme::implicit_euler);
    for (int step = 1; step <= 6; ++step) {
      RunReport run, run_anew;
      const long before = CpuExecutor::evaluations();
      stepper.step(state, kAlways, 0.01 * step, 0.01, run);
      const long between = CpuExecutor::evaluations();
      ASSERT_EQ(run.status, RunStatus::converged) << run.message;
      anew.forget_steps(anew.reached_factors(), anew.reached_pressures());
      ImplicitStepper(anew, settings, TimeScheme::implicit_euler).step(other, kAlways, 0.01 * step, 0.01, run_anew);
      EXPECT_EQ(between - before, CpuExecutor::evaluations() - between - (step == 1 ? 0 : 1)) << "step " << step;
      EXPECT_EQ(run.newton_iterations, run_anew.newton_iterations);
      for (std::size_t i = 0; i < state.u.size(); ++i) EXPECT_EQ(state.u[i], other.u[i]) << "node " << i;
    }
  }
}

}  // namespace
}  // namespace fascia::system_test
