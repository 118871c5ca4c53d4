#include "fascia/stepper.hpp"

#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/index.hpp"
#include "core/run/drivers.hpp"
#include "fascia/scene_file.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fascia::stepper_test {

using test::copied;
using test::same_bits;

namespace {

/// Bodies of each kind, tied to one another, damped, and loaded by what grows and what turns.
Scene mixed_scene(const std::string& solver) {
  return app::parse_scene_text(R"(
[world]
gravity = [0, 0, -9.81]
over = 0.05
[materials.tissue]
young = "15 kPa"
poisson = 0.4
damping = { mass = 1, stiffness = "1 ms" }
[bodies.block]
model = "meshless"
domain = { box = { min = [0, 0, 0], max = [0.04, 0.04, 0.06] } }
frames = { grid = [2, 2, 3] }
density = 1000
material = "tissue"
[bodies.liver]
model = "tetrahedra"
domain = { box = { min = [0.04, 0, 0], max = [0.08, 0.04, 0.06], cells = [2, 2, 2] } }
density = 1000
material = "tissue"
[bodies.wall]
model = "shell"
domain = { rectangle = { origin = [0, 0, 0.06], edge_u = [0.04, 0, 0], edge_v = [0, 0.04, 0], cells = [2, 2] } }
thickness = "2 mm"
density = 1000
material = { young = "40 kPa", poisson = 0.3 }
[[constraints]]
body = "block"
where = { box = { min = [-1, -1, -0.001], max = [1, 1, 0.001] } }
move = { translate = [0, 0.004, 0], rotate = { axis = [0, 0, 1], angle = 0.2, center = [0.02, 0.02, 0] } }
over = 0.1
[[constraints]]
body = "liver"
where = { box = { min = [-1, -1, -0.001], max = [1, 1, 0.001] } }
fix = "all"
[[constraints]]
body = "wall"
where = { nearest = [0, 0, 0.06] }
fix = "all"
[couplings.tie]
kind = "spring"
body = "wall"
where = "all"
point = [0.02, 0.02, 0.1]
stiffness = 5
[[loads]]
body = "wall"
where = "all"
pressure = "10 Pa"
[probes.tip]
body = "block"
quantity = "displacement"
at = [0.02, 0.02, 0.06]
[probes.held]
body = "block"
quantity = "force"
where = { box = { min = [-1, -1, -0.001], max = [1, 1, 0.001] } }
)" + solver,
                               "mixed.toml", {});
}

struct RunEnd {
  std::vector<double> u, v, held;
};

std::vector<double> flat(const std::vector<Vec3d>& rows) {
  std::vector<double> out;
  for (const Vec3d& row : rows) out.insert(out.end(), row.v, row.v + 3);
  return out;
}

/// The run that the program makes of a scene.
RunEnd run_of(Scene scene) {
  const Simulation s = build_simulation(std::move(scene));
  ThreadPool pool(s.scene.solver.threads);
  const SolverSettings settings = settings_of(s.scene.solver);
  MechanicalSystem system(s.model, pool, settings);
  State state = s.initial;
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  const RunReport report = s.scene.solver.kind == SolverKind::statics
                               ? run_statics(system, state, factors, settings, {s.scene.solver.load_steps}, {})
                               : run_implicit(system, state, factors, settings, dynamics_of(s.scene.solver),
                                              [](const StepInfo&, const State&, MechanicalSystem&) { return true; });
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  return {flat(state.u), flat(state.v), {}};
}

class SchemesOfStepper : public testing::TestWithParam<const char*> {};

TEST_P(SchemesOfStepper, StepsAreThoseOfARun) {
  const std::string solver = "[solver]\nkind = \"" + std::string(GetParam()) + "\"\ntime_step = 0.01\nsteps = 10\n";
  const RunEnd run = run_of(mixed_scene(solver));
  Stepper stepper(mixed_scene(solver));
  const Rows u = stepper.displacements(), v = stepper.velocities();
  for (int step = 1; step <= 10; ++step) {
    const StepReport report = stepper.step(step * 0.01 - stepper.time());
    ASSERT_TRUE(report.converged) << report.message;
  }
  EXPECT_NEAR(stepper.time(), 0.1, 1e-15);
  // Lengths of steps differ in their last bits, as 10 × 0.01 and the sum of ten do.
  const std::vector<double> stepped = copied(u), velocity = copied(v);
  ASSERT_EQ(stepped.size(), run.u.size());
  double largest = 0, apart = 0, fastest = 0, apart_v = 0;
  for (std::size_t i = 0; i < run.u.size(); ++i) {
    largest = std::max(largest, std::abs(run.u[i]));
    apart = std::max(apart, std::abs(run.u[i] - stepped[i]));
    fastest = std::max(fastest, std::abs(run.v[i]));
    apart_v = std::max(apart_v, std::abs(run.v[i] - velocity[i]));
  }
  EXPECT_LE(apart, 1e-11 * largest);
  EXPECT_LE(apart_v, 1e-9 * fastest);
}

/// Steps of a length whose multiples are exact: the same bits.
TEST_P(SchemesOfStepper, StepsAreThoseOfARunBitForBit) {
  const std::string solver =
      "[solver]\nkind = \"" + std::string(GetParam()) + "\"\ntime_step = 0.0078125\nsteps = 10\n";
  const RunEnd run = run_of(mixed_scene(solver));
  Stepper stepper(mixed_scene(solver));
  for (int step = 0; step < 10; ++step) ASSERT_TRUE(stepper.step(0.0078125).converged);
  EXPECT_TRUE(same_bits(copied(stepper.displacements()), run.u));
  EXPECT_TRUE(same_bits(copied(stepper.velocities()), run.v));
}
INSTANTIATE_TEST_SUITE_P(All, SchemesOfStepper, testing::Values("implicit-euler", "bdf2", "newmark", "midpoint"),
                         [](const auto& scheme) {
                           std::string name = scheme.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

TEST(StepperOf, StaticsGoesOnInTheLoadFactor) {
  const std::string solver = "[solver]\nkind = \"static\"\nload_steps = 4\n";
  const RunEnd run = run_of(mixed_scene(solver));
  Stepper stepper(mixed_scene("[solver]\nkind = \"static\"\nload_steps = 1\n"));
  for (int step = 0; step < 4; ++step) {
    const StepReport report = stepper.step(0.25);
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_TRUE(report.stable);
  }
  EXPECT_EQ(stepper.time(), 1);
  const std::vector<double> u = copied(stepper.displacements());
  double largest = 0, apart = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    largest = std::max(largest, std::abs(run.u[i]));
    apart = std::max(apart, std::abs(run.u[i] - u[i]));
  }
  EXPECT_LE(apart, 1e-9 * largest);
}

class ViewsOf : public testing::TestWithParam<const char*> {};

TEST_P(ViewsOf, StayWhereTheyAre) {
  test::take_host_as_device();
  Scene scene = test::driven_block(SolverKind::implicit_euler);
  scene.solver.backend = GetParam();
  Stepper stepper(scene);
  const Rows views[] = {stepper.displacements(), stepper.velocities(), stepper.positions(),
                        stepper.rotations(),     stepper.forces(),     stepper.surface_points(0)};
  const std::vector<double> before = copied(views[2]);
  const Snapshot start = stepper.snapshot();
  for (int step = 0; step < 5; ++step) {
    ASSERT_TRUE(stepper.step(0.01).converged);
    stepper.probe("force");
    if (step == 2) stepper.restore(start);
  }
  const Rows again[] = {stepper.displacements(), stepper.velocities(), stepper.positions(),
                        stepper.rotations(),     stepper.forces(),     stepper.surface_points(0)};
  for (std::size_t k = 0; k < std::size(views); ++k) EXPECT_EQ(views[k].data, again[k].data) << k;
  ASSERT_EQ(views[2].rows, stepper.node_count());
  for (int i = 0; i < views[2].rows; ++i)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(views[2][i][k], before[3 * at(i) + k] + views[0][i][k], 1e-15);
  EXPECT_LT(views[2][stepper.node_count() - 1][2], before.back());  // it sags
}
INSTANTIATE_TEST_SUITE_P(All, ViewsOf, testing::Values("cpu", "cuda"));

TEST(StepperOf, ForcesAreWhatProbesSay) {
  Scene scattered = test::driven_block(SolverKind::implicit_euler);
  scattered.bodies[0].frames = CountedSamples{40, 1};
  for (const Scene& scene :
       {test::driven_block(SolverKind::implicit_euler), test::driven_tetrahedra(SolverKind::midpoint), scattered}) {
    Stepper stepper(scene);
    const Rows forces = stepper.forces();
    for (int step = 0; step < 3; ++step) ASSERT_TRUE(stepper.step(0.01).converged);
    std::vector<double> sum(3);
    for (int i = 0; i < forces.rows; ++i)
      for (std::size_t k = 0; k < 3; ++k) sum[k] += forces[i][k];
    const std::vector<double> probe = stepper.probe("force");
    ASSERT_EQ(probe.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], probe[k], 1e-12 * std::abs(probe[2]));
    EXPECT_GT(probe[2], 0.1);
  }
}

TEST(StepperOf, ASceneFileIsStepped) {
  Stepper stepper(read_scene_file(test::source_dir() / "scenes/struck_beam.toml"));
  EXPECT_TRUE(stepper.step(0.01).converged);
  EXPECT_THROW(read_scene_file("no_such_scene.toml"), FileError);
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(StepperOf, RefusedCallsChangeNothing) {
  Stepper stepper(test::driven_block(SolverKind::implicit_euler));
  ASSERT_TRUE(stepper.step(0.01).converged);
  const std::vector<double> u = copied(stepper.displacements());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { stepper.step(0); }), "a step of 0 s; must be above 0");
  EXPECT_EQ(refusal([&] { stepper.step(nan); }), "a step of nan s; must be above 0");
  EXPECT_EQ(refusal([&] { stepper.driver("hand"); }), "no constraint names a driver \"hand\"; set Constraint::driver");
  EXPECT_EQ(refusal([&] { stepper.set_motion(1, {}); }), "there is no driver number 1; the scene has 1");
  EXPECT_EQ(refusal([&] {
              stepper.set_motion(0, {.rotation = {{0, nan, 0}}});
            }),
            "the motion of the driver \"foot\" has a number that is not finite");
  EXPECT_EQ(refusal([&] { stepper.body("liver"); }), "there is no body \"liver\" in the scene");
  EXPECT_EQ(refusal([&] { stepper.surface_points(7); }), "there is no body number 7; the scene has 1");
  EXPECT_EQ(refusal([&] { stepper.probe("tip"); }), "the scene has no probe \"tip\"");
  EXPECT_EQ(refusal([&] { stepper.restore({}); }), "an empty snapshot; take one with snapshot()");
  Stepper other(test::driven_block(SolverKind::implicit_euler));
  EXPECT_EQ(refusal([&] { stepper.restore(other.snapshot()); }), "a snapshot of another stepper; take one of this one");
  EXPECT_TRUE(same_bits(copied(stepper.displacements()), u));
  EXPECT_EQ(stepper.time(), 0.01);
}

/// A foot that goes through the block: no step can be taken, and the block stays as it was.
TEST(StepperOf, AStepThatFailsLeavesTheState) {
  Scene scene = test::driven_tetrahedra(SolverKind::implicit_euler);
  scene.solver.newton_max_iterations = 3;
  Stepper stepper(scene);
  ASSERT_TRUE(stepper.step(1e-3).converged);
  const std::vector<double> u = copied(stepper.displacements());
  stepper.set_motion(0, {.translation = {{0, 0, 40}}});
  const StepReport failed = stepper.step(1e-3);
  EXPECT_FALSE(failed.converged);
  EXPECT_NE(failed.message.find("try a smaller time_step"), std::string::npos) << failed.message;
  EXPECT_TRUE(same_bits(copied(stepper.displacements()), u));
  EXPECT_EQ(stepper.time(), 1e-3);
  EXPECT_EQ(stepper.motion(0).translation[2], 0);
  EXPECT_TRUE(stepper.step(1e-3).converged);  // the foot stayed where it was
}

/// An end above the tolerance, or inside out, is told.
TEST(StepperOf, DoubtfulEndsAreTold) {
  Scene scene = test::driven_tetrahedra(SolverKind::statics);
  scene.solver.newton_max_iterations = 1;
  scene.solver.on_limit = OnLimit::proceed;
  Stepper stepper(scene);
  stepper.set_motion(0, {.rotation = {{0.3, 0, 0}}});
  const StepReport report = stepper.step(1);
  EXPECT_TRUE(report.converged && report.at_limit);
  EXPECT_EQ(stepper.inverted_points(0), 0);
  Scene flat = test::driven_tetrahedra(SolverKind::statics);
  flat.world.gravity = {};
  flat.constraints.push_back(flat.constraints[0]);
  flat.constraints[1].where = in_box({{-1, -1, 0.079}}, {{1, 1, 1}});
  flat.constraints[1].driver = "head";
  Stepper folded(flat);
  folded.set_motion(folded.driver("head"), {.translation = {{0, 0, -0.2}}});
  if (folded.step(1).converged) EXPECT_GT(folded.inverted_points(0), 0);
}

TEST(StepperOf, OtherKindsAreRefused) {
  Scene scene = test::driven_block(SolverKind::central_differences);
  EXPECT_EQ(refusal([&] { Stepper{scene}; }),
            "solver: a stepper does not take explicit dynamics; use statics with control by loads, or an implicit "
            "scheme");
  scene.solver.kind = SolverKind::modes;
  EXPECT_NE(refusal([&] { Stepper{scene}; }).find("modes"), std::string::npos);
}

/// The GPU's steps, in the space of the host.
TEST(StepperOf, AGpuTakesTheSameSteps) {
  test::take_host_as_device();
  for (const SolverKind kind :
       {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark, SolverKind::midpoint, SolverKind::statics}) {
    Scene scene = test::driven_block(kind);
    Stepper own(scene);
    scene.solver.backend = "cuda";
    scene.solver.linear_tolerance = 1e-10;
    Stepper device(scene);
    EXPECT_EQ(device.backend(), Backend::cuda);
    const Rows u = own.displacements(), there = device.displacements();
    const double dt = kind == SolverKind::statics ? 0.2 : 0.01;
    for (int step = 1; step <= 5; ++step) {
      const RigidMotion motion{{{1e-3 * step, 0, 0}}, {{0.02 * step, 0, 0.05 * step}}, {{0.02, 0.02, 0}}};
      own.set_motion(0, motion);
      device.set_motion(0, motion);
      ASSERT_TRUE(own.step(dt).converged);
      ASSERT_TRUE(device.step(dt).converged);
    }
    double largest = 0, apart = 0;
    for (int i = 0; i < u.rows; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        largest = std::max(largest, std::abs(u[i][k]));
        apart = std::max(apart, std::abs(u[i][k] - there[i][k]));
      }
    EXPECT_LE(apart, 1e-7 * largest) << static_cast<int>(kind);
    const std::vector<double> force = own.probe("force"), other = device.probe("force");
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(force[k], other[k], 1e-5 * std::abs(force[2]));
  }
}

}  // namespace

}  // namespace fascia::stepper_test
