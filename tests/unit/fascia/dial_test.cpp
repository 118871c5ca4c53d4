// Dials: factors of loads and of gravity that a program sets from step to step. Stop tokens: steps that end early.
#include "app/reader/parse.hpp"
#include "core/base/errors.hpp"
#include "fascia/simulate.hpp"
#include "fascia/stepper.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

namespace fascia::dial_test {

using test::copied;
using test::same_bits;

namespace {

Scene pushed(SolverKind kind) {
  Scene scene = test::driven_block(kind);
  Load push;
  push.body = "block";
  push.where = in_box({{-1, -1, 0.079}}, {{1, 1, 1}});
  push.total_force = Vec3d{{0.05, 0, 0}};
  scene.loads = {push};
  return scene;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  for (const double v : b) scale = std::max(scale, std::abs(v));
  return scale > 0 ? largest / scale : largest;
}

/// A dial that follows a table from step to step is that table, for all schemes and both ways of stepping: between the
/// ends of a step both are straight. Newton's tolerance leaves 1e-8.
TEST(Dials, FollowWhatATableSays) {
  test::take_host_as_device();
  const TableProfile table{{{0, 1}, {0.01, -0.5}, {0.02, 3}, {0.03, 0}, {0.04, 0}, {0.05, 2}}};
  for (const char* backend : {"cpu", "cuda"})
    for (const SolverKind kind :
         {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark, SolverKind::midpoint}) {
      Scene dialled = pushed(kind), scheduled = pushed(kind);
      dialled.solver.backend = scheduled.solver.backend = backend;
      dialled.loads[0].schedule.dial = "push";
      scheduled.loads[0].schedule.profile = table;
      Stepper one(dialled), other(scheduled);
      const int push = one.dial("push");
      for (std::size_t i = 1; i < table.points.size(); ++i) {
        one.set_dial(push, table.points[i][1]);
        ASSERT_TRUE(one.step(0.01).converged);
        ASSERT_TRUE(other.step(0.01).converged);
        EXPECT_EQ(one.dial_value(push), table.points[i][1]);
        EXPECT_LE(apart(copied(one.displacements()), copied(other.displacements())), 1e-7)
            << backend << ' ' << static_cast<int>(kind) << " step " << i;
      }
    }
}

/// One dial turns gravity and a load down together; the statics of what is left is that of a scene with less of both.
TEST(Dials, TurnGravityAndLoadsTogether) {
  Scene dialled = pushed(SolverKind::statics), less = dialled;
  dialled.world.schedule.dial = dialled.loads[0].schedule.dial = "all";
  less.world.gravity *= 0.25;
  less.loads[0].total_force = *less.loads[0].total_force * 0.25;
  Stepper one(dialled), other(less);
  ASSERT_TRUE(one.step(1).converged);
  ASSERT_TRUE(other.step(1).converged);
  const double full = apart(copied(one.displacements()), copied(other.displacements()));
  EXPECT_GT(full, 1);
  one.set_dial(one.dial("all"), 0.25);
  ASSERT_TRUE(one.step(1).converged);
  EXPECT_LE(apart(copied(one.displacements()), copied(other.displacements())), 1e-6);
}

TEST(Dials, GoBackWithSnapshotsAndFailedSteps) {
  Scene scene = pushed(SolverKind::newmark);
  scene.loads[0].schedule.dial = "push";
  Stepper stepper(scene);
  stepper.set_dial(0, 2);
  EXPECT_EQ(stepper.dial_value(0), 1);
  ASSERT_TRUE(stepper.step(0.01).converged);
  stepper.set_dial(0, 4);
  const Snapshot snapshot = stepper.snapshot();
  ASSERT_TRUE(stepper.step(0.01).converged);
  const std::vector<double> u = copied(stepper.displacements());
  stepper.set_dial(0, 1e12);
  EXPECT_FALSE(stepper.step(0.01).converged);
  EXPECT_EQ(stepper.dial_value(0), 4);
  EXPECT_TRUE(same_bits(copied(stepper.displacements()), u));
  stepper.restore(snapshot);
  EXPECT_EQ(stepper.dial_value(0), 2);
  ASSERT_TRUE(stepper.step(0.01).converged);
  EXPECT_EQ(stepper.dial_value(0), 4);
  EXPECT_TRUE(same_bits(copied(stepper.displacements()), u));
}

TEST(Dials, RefuseWhatIsNotThere) {
  Scene scene = pushed(SolverKind::statics);
  scene.loads[0].schedule.dial = "push";
  Stepper stepper(scene);
  EXPECT_THROW(stepper.dial("pull"), InputError);
  EXPECT_THROW(stepper.set_dial(1, 1), InputError);
  EXPECT_THROW(stepper.set_dial(-1, 1), InputError);
  EXPECT_THROW(stepper.dial_value(1), InputError);
  for (const double value : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(stepper.set_dial(0, value), InputError);
}

/// A dial scales a motion that the scene schedules; zero and below turn it round.
TEST(Dials, MultiplyMotions) {
  Scene scene = test::driven_block(SolverKind::statics);
  Constraint& foot = scene.constraints[0];
  foot.driver.clear();
  foot.motion = Motion{{{0.01, 0, 0}}, {{0, 0, 1}}, 0, {}};
  foot.schedule.dial = "table";
  scene.probes[0].at = {Vec3d{{0.02, 0.02, 0}}};
  Stepper stepper(scene);
  ASSERT_TRUE(stepper.step(1).converged);
  EXPECT_NEAR(stepper.probe("top")[0], 0.03, 1e-15);
  for (const double value : {0.0, -2.0, 0.5}) {
    stepper.set_dial(stepper.dial("table"), value);
    ASSERT_TRUE(stepper.step(1).converged);
    EXPECT_NEAR(stepper.probe("top")[0], 0.02 + 0.01 * value, 1e-15);
  }
}

/// A dial where nothing acts that it could multiply.
TEST(Dials, SayWhereTheyDoNothing) {
  Scene held = pushed(SolverKind::statics);
  held.constraints[0].schedule.dial = "foot";
  EXPECT_THROW(Stepper{held}, SceneError);
  Scene weightless = pushed(SolverKind::statics);
  weightless.world.gravity = {};
  weightless.world.schedule.dial = "g";
  EXPECT_THROW(Stepper(weightless).dial("g"), InputError);
}

/// The fluid of a bag cannot be turned down to no volume; one without a volume of its own has nothing to turn.
TEST(Dials, KeepTheVolumesOfFluids) {
  const auto bag = [](const std::string& volume) {
    return app::parse_scene_text(R"(
[bodies.bag]
model = "tetrahedra"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [3, 3, 3] } }
density = 1000
material = { young = "10 kPa", poisson = 0.3 }
fluid = { bulk_modulus = "10 kPa", dial = "fill")" +
                                     volume + R"( }
[[constraints]]
body = "bag"
where = { box = { min = [-1, -1, -0.1], max = [2, 2, 0.1] } }
fix = "all"
)",
                                 "bag.toml", {});
  };
  Scene scene = bag(", volume = 1.1");
  ASSERT_TRUE(scene.bodies[0].fluid);
  Stepper stepper(scene);
  const int fill = stepper.dial("fill");
  stepper.set_dial(fill, -11);
  EXPECT_TRUE(stepper.step(0.5).converged);  // of half of it the loads have grown to
  const std::vector<double> u = copied(stepper.displacements());
  try {
    stepper.step(0.5);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(
        e.what(),
        "the fluid in the body \"bag\" is given a volume of -0.1 m3 at 1; must be above 0: set its dial nearer "
        "to 0");
  }
  EXPECT_EQ(stepper.time(), 0.5);
  EXPECT_TRUE(same_bits(copied(stepper.displacements()), u));
  stepper.set_dial(fill, 1);
  EXPECT_TRUE(stepper.step(0.5).converged);
  ASSERT_FALSE(Stepper(bag("")).warnings().empty());
}

/// A step that is told to stop leaves every bit as it was, and what follows is as if it had not been tried: but for the
/// last digits, since factors and preconditioners are made anew.
TEST(StopTokens, LeaveTheStateAsItWas) {
  test::take_host_as_device();
  for (const char* backend : {"cpu", "cuda"})
    for (const SolverKind kind : {SolverKind::statics, SolverKind::bdf2, SolverKind::newmark, SolverKind::midpoint}) {
      Scene scene = pushed(kind);
      scene.solver.backend = backend;
      scene.solver.load_steps = 3;
      scene.solver.newton_tolerance = 1e-11;
      Stepper stepper(scene), other(scene);
      const auto advance = [](Stepper& s) {
        s.set_motion(0, {{{0.001 + s.time() * 0.01, 0, 0}}, {}, {}});
        EXPECT_TRUE(s.step(0.05).converged);
      };
      advance(stepper), advance(other);
      const std::vector<double> u = copied(stepper.displacements()), v = copied(stepper.velocities());
      std::stop_source stop;
      stop.request_stop();
      stepper.set_motion(0, {{{0.02, 0, 0}}, {}, {}});
      const StepReport report = stepper.step(0.05, stop.get_token());
      EXPECT_TRUE(report.stopped);
      EXPECT_FALSE(report.converged);
      EXPECT_EQ(report.message, "stopped before its end, as it was asked to");
      EXPECT_EQ(stepper.time(), 0.05);
      EXPECT_TRUE(same_bits(copied(stepper.displacements()), u) && same_bits(copied(stepper.velocities()), v));
      EXPECT_EQ(stepper.motion(0).translation[0], 0.001);
      advance(stepper), advance(other);
      EXPECT_LE(apart(copied(stepper.displacements()), copied(other.displacements())), 1e-9) << backend;
      EXPECT_LE(apart(copied(stepper.velocities()), copied(other.velocities())), 1e-7) << backend;
    }
}

TEST(StopTokens, InterruptRuns) {
  for (const SolverKind kind : {SolverKind::statics, SolverKind::newmark}) {
    Scene scene = pushed(kind);
    scene.solver.steps = kind == SolverKind::statics ? 0 : 10;
    std::stop_source stop;
    stop.request_stop();
    const RunOutcome run = simulate(scene, {}, stop.get_token());
    EXPECT_EQ(run.status, RunStatus::interrupted);
    EXPECT_FALSE(run.done);
    EXPECT_EQ(run.steps, 0);
    EXPECT_EQ(run.message, "interrupted at 0");
  }
}

/// Explicit runs stop after a step; the state that was reached is shown, whatever the output asks for.
TEST(StopTokens, ShowTheLastState) {
  for (const SolverKind kind : {SolverKind::newmark, SolverKind::central_differences}) {
    Scene scene = pushed(kind);
    scene.constraints[0].driver.clear();
    scene.solver.steps = 1000000;
    scene.solver.time_step = 1e-5;
    scene.output.every = 5;
    std::stop_source stop;
    std::jthread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      stop.request_stop();
    });
    double last = -1;
    const RunOutcome run = simulate(
        scene, [&](const RunState& state) { return last = state.time(), true; }, stop.get_token());
    EXPECT_EQ(run.status, RunStatus::interrupted);
    EXPECT_EQ(run.time, last) << static_cast<int>(kind);
  }
}

/// Another thread ends a run that would take minutes.
TEST(StopTokens, AreHeardFromAnotherThread) {
  Scene scene = pushed(SolverKind::newmark);
  scene.solver.steps = 1000000;
  scene.solver.time_step = 1e-4;
  scene.output.every_steps = 1;
  std::stop_source stop;
  std::atomic<int> seen = 0;
  std::jthread other([&] {
    while (seen < 5) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    stop.request_stop();
  });
  double last = 0;
  const RunOutcome run = simulate(
      scene,
      [&](const RunState& state) {
        ++seen;
        last = state.time();
        return true;
      },
      stop.get_token());
  EXPECT_EQ(run.status, RunStatus::interrupted);
  EXPECT_GE(run.steps, 4);
  EXPECT_NEAR(run.time, last, 1e-12);
  EXPECT_GE(run.newton_iterations, run.steps);
}

}  // namespace

}  // namespace fascia::dial_test
