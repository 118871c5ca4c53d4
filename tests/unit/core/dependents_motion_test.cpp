#include "core/solver/dependents.hpp"
#include "core/solver/explicit_dynamics.hpp"
#include "core/solver/modes.hpp"
#include "core/solver/path_following.hpp"
#include "tests/support/dependent_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

/// What solvers make of dependent nodes: equilibria, paths, modes and motions.
namespace fascia {
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

/// All of one node that depends on none.
void hold_first_host(Model& model) {
  FrameConstraint c;
  std::vector<char> depends(at(model.node_count()), 0);
  for (const DependentNode& d : model.points.dependents) depends[at(d.node)] = 1;
  for (const DependentNode& d : model.points.dependents)
    for (const int host : d.hosts)
      if (depends[at(host)] == 0) c.node = host;
  c.translations = c.rotations = 3;
  c.whole = true;
  model.constraints.assign(1, c);
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
  hold_first_host(model);
  model.points.springs.push_back({0, 500, model.rest_position[0], model.rest_position[0] + Vec3d{{0, 0.2, 0.1}}, {}});
  add_loads(model, GetParam().starts_with("shell") || GetParam() == "chain" ? 0.02 : 1.0);
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
  const State direct = system.finish_step(1);
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
  State start = spinning_state(model, {{1, -2, 3.7}}, {{0.3, 0.2, 0}});
  place_dependent_rates(model.points, start);
  const Momentum first = total_momentum(model, start);
  ThreadPool pool(1);
  for (const TimeScheme scheme : {TimeScheme::implicit_euler, TimeScheme::midpoint}) {
    MechanicalSystem system(model, pool, tight());
    State state = start;
    const RunReport report = run_implicit(system, state, kAlways, tight(), {scheme, 0.01, 20}, nullptr);
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

/// Explicit and implicit runs of second order meet, with loads on all nodes, both dampings and follower forces.
TEST_P(DependentMotionTest, ExplicitAndImplicitAgree) {
  const auto built = moving_model(GetParam(), 1e-4, 2);
  Model& model = built->model;
  add_loads(model, 3, true);
  const DependentNode& last = model.points.dependents.back();
  if (model.kind(last.node) != FrameKind::vertex)
    model.followers.push_back({0, {{0, 2, 1}}, {}, {last.node}, {1.0}, {{}}, {}});
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, tight());
  State start = State::at_rest(model);
  const double end = 0.02, limit = stable_time_step(system);
  const int steps = static_cast<int>(std::ceil(end / (0.25 * limit)));
  State explicit_end = start, implicit_end = start;
  RunReport report = run_explicit(system, explicit_end, kAlways, {end / steps, steps, {}}, nullptr);
  ASSERT_EQ(report.status, RunStatus::converged) << report.message;
  MechanicalSystem other(model, pool, tight());
  report = run_implicit(other, implicit_end, kAlways, tight(), {TimeScheme::newmark, end / steps, steps}, nullptr);
  ASSERT_EQ(report.status, RunStatus::converged) << report.message;
  double difference = 0, size = 0, speed_difference = 0, speed = 0;
  for (std::size_t i = 0; i < start.u.size(); ++i) {
    difference = std::max(difference, norm(explicit_end.u[i] - implicit_end.u[i]));
    size = std::max(size, norm(implicit_end.u[i]));
    speed_difference = std::max(speed_difference, norm(explicit_end.v[i] - implicit_end.v[i]));
    speed = std::max(speed, norm(implicit_end.v[i]));
  }
  std::printf("%-28s %d steps, difference %.1e, of velocities %.1e\n", GetParam().c_str(), steps, difference / size,
              speed_difference / speed);
  EXPECT_LT(difference, 0.02 * size);
  EXPECT_LT(speed_difference, 0.1 * speed);
}

TEST_P(DependentMotionTest, SameBitsWithTwoThreads) {
  const auto built = moving_model(GetParam());
  add_loads(built->model, 3);
  const State start = spinning_state(built->model, {{1, -2, 3.7}}, {{0.3, 0.2, 0}});
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
}  // namespace fascia
