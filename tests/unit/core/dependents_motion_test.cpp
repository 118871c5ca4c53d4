#include "assembly/actions/actions.hpp"
#include "core/body/body_surface.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/modes.hpp"
#include "core/run/path_following.hpp"
#include "core/step/dependents.hpp"
#include "tests/support/dependent_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

/// What solvers make of dependent nodes: equilibria, paths, modes and motions.
namespace fascia::dependents_motion_test {
namespace {

using namespace test;

/// With inertia on the hosts.
std::unique_ptr<CoupledModel> moving_model(const std::string& name, double stiffness_damping = 0,
                                           double mass_damping = 0) {
  auto built = coupled_model(name, stiffness_damping, mass_damping);
  move_inertia_to_hosts(built->model);
  return built;
}

/// Forces on every node, and torques and couples on frames: on dependent nodes too.
void add_loads(Model& model, double size, bool torques = false) {
  std::mt19937 random(3);
  DeadLoad load;
  for (int i = 0; i < model.node_count(); ++i) {
    NodeLoad n{i, random_vector(random, size), {}, {}};
    if (model.kind(i) != FrameKind::vertex) {
      n.couple = skew(random_vector(random, 0.1 * size)) + Mat3d::diagonal(0.1 * size);
      if (torques) n.torque = random_vector(random, 0.1 * size);
    }
    load.nodes.push_back(n);
  }
  model.loads.push_back(load);
}

/// All of the lowest hosts: of the body that others stick in its bottom, else the frame.
void hold_hosts(Model& model) {
  std::vector<char> hosts(at(model.node_count()), 0);
  for (const DependentNode& d : model.points.dependents)
    for (const int host : d.hosts) hosts[at(host)] = 1;
  for (const DependentNode& d : model.points.dependents) hosts[at(d.node)] = 0;
  double lowest = 1e9;
  for (int i = 0; i < model.node_count(); ++i)
    if (hosts[at(i)] != 0) lowest = std::min(lowest, model.rest_position[at(i)][2]);
  const bool frame = hosts.back() != 0;
  for (int i = frame ? model.node_count() - 1 : 0; i < model.node_count(); ++i) {
    if (hosts[at(i)] == 0 || (!frame && model.rest_position[at(i)][2] > lowest + 0.2)) continue;
    FrameConstraint c;
    c.node = i;
    c.translations = c.rotations = 3;
    c.whole = true;
    model.constraints.push_back(c);
  }
}

SolverSettings tight() {
  SolverSettings settings;
  settings.tolerance = 1e-12;
  return settings;
}

bool same(const State& a, const State& b) {
  return a.u == b.u && a.v == b.v && std::ranges::equal(a.D.values(), b.D.values()) &&
         std::ranges::equal(a.Q_dot.values(), b.Q_dot.values());
}

/// Every dependent node is where its hosts put it, and as fast.
void expect_placed(const Model& model, const State& state) {
  State again = state;
  place_dependents(model.points, again);
  place_dependent_rates(model.points, again);
  EXPECT_TRUE(same(again, state));
}

class DependentMotionTest : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(, DependentMotionTest, testing::ValuesIn(kWaysToDepend), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// The step's energy, loads and inertia on dependent nodes, and its slope along Newton's direction.
TEST_P(DependentMotionTest, GradientOfAStepIsThatOfItsEnergy) {
  const auto built = moving_model(GetParam(), 0, 3);
  Model& model = built->model;
  add_loads(model, 30);
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State start = random_state(model, 0.01, 0.2);
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
  const DirectionReport d = system.direction();
  system.save();
  const double h = 1e-5;
  system.apply(h);
  const double plus = system.evaluate().energy;
  system.restore();
  system.apply(-h);
  const double minus = system.evaluate().energy;
  const double error = std::abs((plus - minus) / (2 * h) - d.slope) / std::abs(d.slope);
  std::printf("%-28s step energy against its gradient: %.1e\n", GetParam().c_str(), error);
  EXPECT_LT(error, 1e-7);
}

/// Only the exact tangent ends quadratically; Cholesky and CG agree; a path goes through the same equilibria.
TEST_P(DependentMotionTest, EquilibriaAreFoundQuadratically) {
  const auto built = coupled_model(GetParam());
  Model& model = built->model;
  hold_hosts(model);
  model.points.springs.push_back({0, 500, model.rest_position[0], model.rest_position[0] + Vec3d{{0, 0.2, 0.1}}, {}});
  add_loads(model, GetParam().ends_with("affine grid") ? 0.05 : GetParam().starts_with("tetrahedra") ? 1.0 : 0.02);
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, tight());
  system.begin_step(State::at_rest(model), 0);
  system.set_factors(std::vector<double>{1.0});
  std::vector<double> residuals;
  Evaluation e = system.evaluate();
  while (!e.converged() && residuals.size() < 30) {
    residuals.push_back(e.residual);
    const DirectionReport d = system.direction();
    ASSERT_TRUE(d.usable) << d.trouble;
    system.apply(std::min(1.0, 0.8 / std::max(d.largest_rotation, 1e-300)));
    e = system.evaluate();
  }
  EXPECT_TRUE(e.converged()) << e.excess;
  std::printf("%-28s residuals:", GetParam().c_str());
  for (const double r : residuals) std::printf(" %.1e", r);
  std::printf(" %.1e\n", e.residual);
  EXPECT_LT(residuals.size(), 15u);
  State direct;
  system.finish_step(1, direct);
  expect_placed(model, direct);

  SolverSettings with_cg = tight();
  with_cg.linear = LinearMethod::cg;
  with_cg.cg.tolerance = 1e-10;
  MechanicalSystem other(model, pool, with_cg);
  State state = State::at_rest(model);
  RunReport report = run_statics(other, state, kRamp, with_cg, {1}, nullptr);
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    difference = std::max(difference, norm(state.u[i] - direct.u[i]));
    size = std::max(size, norm(direct.u[i]));
  }
  EXPECT_LT(difference, 1e-7 * size);

  state = State::at_rest(model);
  MechanicalSystem followed(model, pool, tight());
  PathSettings path;
  path.load_steps = 4;
  report = run_path(followed, state, kRamp, tight(), path, nullptr);
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  difference = 0;
  for (std::size_t i = 0; i < state.u.size(); ++i) difference = std::max(difference, norm(state.u[i] - direct.u[i]));
  EXPECT_LT(difference, 1e-6 * size);
}

/// Forces on dependent nodes balance what the hosts carry: those of a chain's end show in all of it.
TEST(DependentForces, AreThoseThatHostsCarry) {
  CoupledModel built;
  const int base = built.add_frame({}, 1), arm = built.add_frame({{1, 0, 0}}, 1), tip = built.add_frame({{2, 0, 0}}, 1);
  built.weld(tip, arm);
  built.weld(arm, base);
  built.finish();
  FrameConstraint c;
  c.node = base;
  c.translations = c.rotations = 3;
  built.model.constraints = {c};
  add_node_load(built.model, tip, {{0, 0, -3}}, {{5, 0, 0}});
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  system.begin_step(State::at_rest(built.model), 0);
  system.set_factors(std::vector<double>{1.0});
  system.evaluate();
  ASSERT_EQ(built.model.points.dependents[0].node, arm);
  const std::vector<double> forces(system.dependent_forces().begin(), system.dependent_forces().end());
  EXPECT_EQ(forces, (std::vector<double>{0, 0, 3, -5, -3, 0, 0, 0, 3, -5, 0, 0}));
  const std::vector<double> reaction(system.gradient().begin(), system.gradient().begin() + 6);
  EXPECT_EQ(reaction, (std::vector<double>{0, 0, 3, -5, -6, 0}));
}

TEST_P(DependentMotionTest, FreeBodiesHaveSixZeroModes) {
  const auto built = moving_model(GetParam());
  ThreadPool pool(1);
  const Modes modes = natural_modes(built->model, pool, 8);
  ASSERT_TRUE(modes.converged);
  std::printf("%-28s modes 6 and 7: %.1e and %.3g Hz\n", GetParam().c_str(), modes.frequency[5], modes.frequency[6]);
  EXPECT_LT(modes.frequency[5], 1e-4 * modes.frequency[6]);
}

/// Free tumbling: linear momentum stays with every scheme, spin with the midpoint rule and central differences, but
/// where vertices host (they take no moments from what sticks in them).
TEST_P(DependentMotionTest, MomentumStays) {
  const auto built = moving_model(GetParam());
  const Model& model = built->model;
  State start = spinning_state(model, {{0.2, -0.4, 0.74}}, {{0.3, 0.2, 0}});
  place_dependent_rates(model.points, start);
  const Momentum first = total_momentum(model, start);
  ThreadPool pool(1);
  for (const TimeScheme scheme : {TimeScheme::implicit_euler, TimeScheme::midpoint}) {
    MechanicalSystem system(model, pool, tight());
    State state = start;
    const RunReport report = run_implicit(system, state, kAlways, tight(), {scheme, 0.05, 20}, nullptr);
    ASSERT_EQ(report.status, RunStatus::converged) << report.message;
    expect_placed(model, state);
    const Momentum last = total_momentum(model, state);
    const double linear = norm(last.linear - first.linear) / norm(first.linear);
    const double spin = norm(last.angular - first.angular) / norm(first.angular);
    std::printf("%-28s %s: momentum %.1e, spin %.1e\n", GetParam().c_str(),
                scheme == TimeScheme::midpoint ? "midpoint" : "implicit Euler", linear, spin);
    EXPECT_LT(linear, 1e-9);
    if (scheme == TimeScheme::midpoint) {
      EXPECT_LT(spin, 1e-9);
    }
  }
  MechanicalSystem system(model, pool, {});
  State state = start;
  const double dt = 0.5 * stable_time_step(system);
  const RunReport report = run_explicit(system, state, kAlways, {dt, 200, {}}, nullptr);
  ASSERT_EQ(report.status, RunStatus::converged) << report.message;
  expect_placed(model, state);
  const Momentum last = total_momentum(model, state);
  EXPECT_LT(norm(last.linear - first.linear), 1e-11 * norm(first.linear));
  std::printf("%-28s explicit: spin %.1e\n", GetParam().c_str(),
              norm(last.angular - first.angular) / norm(first.angular));
}

/// Explicit and implicit runs meet with the square of the step, with loads on all nodes, both dampings (of which the
/// frame has none: hosts are damped unevenly) and follower forces. Schemes of second order agree.
TEST_P(DependentMotionTest, ExplicitAndImplicitAgree) {
  const auto built = moving_model(GetParam(), 1e-4, 2);
  Model& model = built->model;
  add_loads(model, 3, true);
  const DependentNode& last = model.points.dependents.back();
  if (model.kind(last.node) != FrameKind::vertex)
    model.followers.push_back({0, {{0, 2, 1}}, {}, {last.node}, {1.0}, {{}}, {}});
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, tight()), other(model, pool, tight());
  const double end = 0.2, limit = stable_time_step(system);
  const int few = static_cast<int>(std::ceil(end / (0.1 * limit)));
  const auto error_of = [&](TimeScheme scheme, int steps) {
    State by_explicit = State::at_rest(model), by_implicit = by_explicit;
    RunReport report = run_explicit(system, by_explicit, kAlways, {end / steps, steps, {}}, nullptr);
    EXPECT_EQ(report.status, RunStatus::converged) << report.message;
    report = run_implicit(other, by_implicit, kAlways, tight(), {scheme, end / steps, steps}, nullptr);
    EXPECT_EQ(report.status, RunStatus::converged) << report.message;
    double difference = 0, speed = 0;
    for (std::size_t i = 0; i < by_implicit.u.size(); ++i) {
      difference = std::max(
          {difference, norm(by_explicit.u[i] - by_implicit.u[i]) / end, norm(by_explicit.v[i] - by_implicit.v[i])});
      speed = std::max(speed, norm(by_implicit.v[i]));
    }
    return difference / speed;
  };
  const double coarse = error_of(TimeScheme::newmark, few), fine = error_of(TimeScheme::newmark, 2 * few),
               midpoint = error_of(TimeScheme::midpoint, few), bdf2 = error_of(TimeScheme::bdf2, few);
  std::printf("%-28s %d steps: newmark %.1e (half the step: %.1e), midpoint %.1e, bdf2 %.1e\n", GetParam().c_str(), few,
              coarse, fine, midpoint, bdf2);
  EXPECT_LT(coarse, 0.01);
  EXPECT_LT(fine, 0.35 * coarse);
  EXPECT_LT(midpoint, 0.02);
  EXPECT_LT(bdf2, 0.05);
}

/// A host that a boundary turns takes along what is welded to it, and all that hangs there, without strain.
TEST(DependentMotion, FollowsAHostThatIsTurned) {
  const auto built = coupled_model("tetrahedra on a frame");
  Model& model = built->model;
  hold_hosts(model);
  model.constraints[0].translation_motion = model.constraints[0].rotation_motion = {0, 0, 0};
  PrescribedMotion motion;
  motion.axis = normalized(Vec3d{{1, 2, 1}});
  motion.angle = 2;
  motion.translation = {{0.3, 0, 0.1}};
  model.motions.push_back(motion);
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, tight());
  State state = State::at_rest(model);
  const RunReport report = run_statics(system, state, kRamp, tight(), {}, nullptr);
  ASSERT_EQ(report.status, RunStatus::converged) << report.message;
  expect_placed(model, state);
  for (std::size_t i = 0; i < state.u.size(); ++i)
    EXPECT_LT(norm(state.u[i] - motion.displacement(model.rest_position[i], 1)), 1e-10);
}

/// Pressure, an enclosed fluid and a hydrostatic part on a surface of which nodes depend.
TEST(DependentMotion, SurfaceLoadsActOnHosts) {
  for (const char* name : {"tetrahedra in a rigid grid", "tetrahedra in an affine grid", "tetrahedra in tetrahedra"}) {
    const auto built = coupled_model(name);
    Model& model = built->model;
    hold_hosts(model);
    SurfaceLoad load = surface_of(*built->bodies[1], built->bodies[1]->faces());
    load.pressure = 200;
    load.bulk_modulus = 2e4;
    load.volume = 1.05 * load.rest_volume;
    load.weight = {{30, -50, 100}};
    model.surfaces.push_back(load);
    ThreadPool pool(1);
    MechanicalSystem system(model, pool, tight());
    system.begin_step(State::at_rest(model), 0);
    system.set_factors(std::vector<double>{1.0});
    std::vector<double> residuals;
    Evaluation e = system.evaluate();
    while (!e.converged() && residuals.size() < 30) {
      residuals.push_back(e.residual);
      const DirectionReport d = system.direction();
      ASSERT_TRUE(d.usable) << d.trouble;
      system.save();
      const double h = 1e-4;
      system.apply(h);
      const double plus = system.evaluate().energy;
      system.restore();
      system.apply(-h);
      const double minus = system.evaluate().energy;
      system.restore();
      system.evaluate();
      if (residuals.size() < 3) {
        EXPECT_NEAR((plus - minus) / (2 * h), d.slope, 1e-5 * std::abs(d.slope)) << name;
      }
      system.apply(1);
      e = system.evaluate();
    }
    std::printf("%-28s residuals:", name);
    for (const double r : residuals) std::printf(" %.1e", r);
    std::printf(" %.1e\n", e.residual);
    EXPECT_TRUE(e.converged()) << name;
    EXPECT_LT(residuals.size(), 9u) << name;
  }
}

TEST_P(DependentMotionTest, SameBitsWithTwoThreads) {
  const auto built = moving_model(GetParam());
  add_loads(built->model, 3);
  const State start = spinning_state(built->model, {{0.2, -0.4, 0.74}}, {{0.3, 0.2, 0}});
  std::vector<State> ends;
  for (const int threads : {1, 2}) {
    ThreadPool pool(threads);
    MechanicalSystem system(built->model, pool, {});
    State state = start;
    run_implicit(system, state, kAlways, {}, {TimeScheme::midpoint, 0.01, 3}, nullptr);
    ends.push_back(state);
    state = start;
    run_explicit(system, state, kAlways, {0.3 * stable_time_step(system), 20, {}}, nullptr);
    ends.push_back(state);
  }
  EXPECT_TRUE(same(ends[0], ends[2]));
  EXPECT_TRUE(same(ends[1], ends[3]));
}

}  // namespace
}  // namespace fascia::dependents_motion_test
