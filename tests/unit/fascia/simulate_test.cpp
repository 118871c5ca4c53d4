// Whole runs by one call: they are the program's, of every kind of solution, and end as they are told.
#include "fascia/simulate.hpp"

#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "fascia/run/run_modes.hpp"
#include "fascia/scene_file.hpp"
#include "fascia/stepper.hpp"
#include "tests/support/crushed_cube.hpp"
#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace fascia::simulate_test {
namespace {

Scene scene_of(const std::string& name, const std::vector<std::string>& settings = {}) {
  return read_scene_file(test::source_dir() / "scenes" / (name + ".toml"), settings);
}

TEST(Simulate, AStepperTakesTheSameSteps) {
  const std::vector<std::string> settings{"output={every_steps=1}",
                                          "solver={kind='newmark',time_step=1e-2,steps=5,backend='cpu'}"};
  Stepper stepper(scene_of("settling_beam", settings));
  const double dt = scene_of("settling_beam", settings).solver.time_step;
  int seen = 0;
  const RunOutcome run = simulate(scene_of("settling_beam", settings), [&](const RunState& state) {
    if (state.time() == 0) return true;
    EXPECT_TRUE(stepper.step(dt).converged);
    const Rows a = state.displacements(), b = stepper.displacements();
    EXPECT_EQ(std::vector(a.data, a.data + 3 * a.rows), std::vector(b.data, b.data + 3 * b.rows));
    EXPECT_EQ(state.rest_positions().rows, stepper.node_count());
    EXPECT_EQ(state.velocities().columns, 3);
    ++seen;
    return true;
  });
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  EXPECT_EQ(seen, 5);
  EXPECT_EQ(run.steps, 5);
  EXPECT_EQ(run.backend, Backend::cpu);
}

TEST(Simulate, FollowsPathsPastLimitPoints) {
  std::vector<double> factors;
  const RunOutcome run = simulate(scene_of("snap_through"), [&](const RunState& state) {
    factors.push_back(state.time());
    return true;
  });
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  ASSERT_FALSE(factors.empty());
  EXPECT_EQ(factors.back(), 1.0);
  EXPECT_FALSE(std::is_sorted(factors.begin(), factors.end())) << "it has turned";
  int passed = 0;
  for (const std::string& warning : run.warnings) passed += warning.find("limit point passed") == 0 ? 1 : 0;
  EXPECT_EQ(passed, 2);
}

/// A clamped bar vibrates along its axis as a chain of lumped masses a distance h apart: f = c / (π h) sin((2 m − 1) π
/// h / (4 L)).
TEST(Simulate, FindsModes) {
  const Scene scene = app::parse_scene_text(R"(
[bodies.bar]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1], cells = [10, 1, 1] } }
density = 1000
material = { young = 1e6, poisson = 0 }
[[constraints]]
body = "bar"
where = "all"
fix = ["y", "z"]
[[constraints]]
body = "bar"
where = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }
fix = "all"
[solver]
kind = "modes"
count = 2
[probes.f]
quantity = "frequency"
)",
                                            "bar.toml", {});
  std::vector<double> shown;
  const RunOutcome run = simulate(scene, [&](const RunState& state) {
    EXPECT_EQ(state.time(), static_cast<double>(shown.size() + 1));
    shown.push_back(state.probe("f").at(0));
    return true;
  });
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  ASSERT_EQ(run.frequencies.size(), 2u);
  EXPECT_EQ(shown, run.frequencies);
  constexpr double kPi = std::numbers::pi;
  const double c = std::sqrt(1e6 / 1000);
  for (int m = 1; m <= 2; ++m) {
    const double f = c / (kPi * 0.1) * std::sin((2 * m - 1) * kPi * 0.1 / 4);
    EXPECT_NEAR(run.frequencies[static_cast<std::size_t>(m - 1)], f, 1e-8 * f);
  }
}

/// Torsion of a rod displaces no node: such a mode is shown by turns of at most 0.1 rad, which half a wave has at both
/// ends, and a free turn everywhere.
TEST(Simulate, ShowsModesThatOnlyTurn) {
  struct Shapes final : RunListener {
    std::vector<State> states;
    void save(double, const State& state) override { states.push_back(state); }
    void show(double, const ProbedState&, const ProbeValues&) override {}
  } shapes;
  const Scene scene = app::parse_scene_text(R"(
constraints = [{ body = "rod", where = "all", fix = ["x", "y", "z", "ry", "rz"] }]
[bodies.rod]
model = "meshless"
domain = { line = { from = [0, 0, 0], to = [1, 0, 0] } }
radius = 0.01
density = 7850
material = { young = 2e11, poisson = 0.3 }
frames = { grid = [21] }
[solver]
kind = "modes"
count = 2
)",
                                            "rod.toml", {});
  ThreadPool pool(1);
  EXPECT_FALSE(run_modes(build_simulation(scene), pool, shapes).failed);
  ASSERT_EQ(shapes.states.size(), 2U);
  for (const State& state : shapes.states) {
    for (const std::size_t end : {std::size_t{0}, state.D.size() - 1})  // D = R - 1
      EXPECT_NEAR(std::abs(state.D[end](2, 1)), std::sin(0.1), 1e-6);
    for (const Vec3d& u : state.u) EXPECT_NEAR(u[0], 0, 1e-12);
  }
}

TEST(Simulate, TakesExplicitSteps) {
  double last = -1;
  const RunOutcome run = simulate(scene_of("explicit_cantilever", {"solver.time_step='auto'"}), [&](const RunState& s) {
    EXPECT_GT(s.time(), last);
    last = s.time();
    return true;
  });
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  EXPECT_EQ(last, run.time);
  EXPECT_GT(run.steps, 50);
}

TEST(Simulate, EndsWhereItIsTold) {
  int seen = 0;
  const RunOutcome run = simulate(scene_of("settling_beam", {"output={every_steps=1}", "solver.backend='cpu'"}),
                                  [&](const RunState&) { return ++seen < 3; });
  EXPECT_EQ(run.status, RunStatus::interrupted);
  EXPECT_EQ(seen, 3);
}

TEST(Simulate, NoProbeIsANumberThatIsNone) {
  const Scene scene = app::parse_scene_text(std::string(test::kCrushedCube) + test::kStressProbe, "cube.toml", {});
  double last = -1;
  const RunOutcome run = simulate(scene, [&](const RunState& state) {
    for (const double value : state.probe("s")) EXPECT_TRUE(std::isfinite(value));
    last = state.time();
    return true;
  });
  EXPECT_EQ(run.status, RunStatus::diverged);
  EXPECT_NE(run.message.find("not finite"), std::string::npos) << run.message;
  EXPECT_GT(last, 0.9);
}

TEST(Simulate, MistakesAreSentences) {
  EXPECT_THROW(simulate(scene_of("settling_beam"), [](const RunState& s) { return !s.probe("nothing").empty(); }),
               InputError);
  EXPECT_THROW(simulate(Scene{}), SceneError);
  Scene scene = scene_of("settling_beam");
  scene.bodies.at(0).density = -1;
  EXPECT_THROW(simulate(scene), SceneError);
}

TEST(Simulate, IsToldToEndAtAnyState) {
  int seen = 0;
  const auto first = [&](const RunState&) { return ++seen < 1; };
  EXPECT_EQ(simulate(scene_of("explicit_cantilever"), first).status, RunStatus::interrupted);
  EXPECT_EQ(seen, 1) << "the start";
  seen = 0;
  EXPECT_EQ(simulate(scene_of("free_modes"), first).status, RunStatus::interrupted);
  EXPECT_EQ(seen, 1);
  seen = 0;
  EXPECT_EQ(simulate(scene_of("snap_through"), first).status, RunStatus::interrupted);
  EXPECT_EQ(seen, 1);
}

TEST(Simulate, WhatTheCallerThrowsLeavesIt) {
  struct Own {};
  for (const char* scene : {"settling_beam", "explicit_cantilever", "snap_through", "free_modes"})
    EXPECT_THROW(simulate(scene_of(scene), [](const RunState&) -> bool { throw Own{}; }), Own) << scene;
}

/// Also where it is of a type that a run itself ends by.
TEST(Simulate, AStateErrorOfTheCallerLeavesItToo) {
  EXPECT_THROW(simulate(scene_of("settling_beam"), [](const RunState&) -> bool { throw StateError("mine"); }),
               StateError);
}

TEST(Simulate, StepsFollowFromTheDuration) {
  Scene scene = scene_of("settling_beam", {"solver.backend='cpu'"});
  scene.solver.time_step = 0.01;
  scene.solver.steps = 0;
  scene.solver.duration = 0.035;
  const RunOutcome run = simulate(scene);
  EXPECT_TRUE(run.done) << run.message;
  EXPECT_EQ(run.steps, 4);
  EXPECT_EQ(run.time, 0.035);
}

/// A run refuses what a reader of files refuses.
TEST(Simulate, WhatARunLacksIsNamed) {
  struct Case {
    const char* said;
    std::function<void(Scene&)> spoil;
  };
  const Case cases[] = {
      {"time_step = 0 s", [](Scene& s) { s.solver.time_step = 0; }},
      {"time_step = nan s", [](Scene& s) { s.solver.time_step = NAN; }},
      {"a number of steps", [](Scene& s) { s.solver.duration.reset(), s.solver.steps = 0; }},
      {"duration = -1 s", [](Scene& s) { s.solver.duration = -1; }},
      {"at most 1e+09", [](Scene& s) { s.solver.duration = 1, s.solver.time_step = 1e-12; }},
      {"for explicit dynamics alone", [](Scene& s) { s.solver.time_step_automatic = true; }},
      {"needs a duration",
       [](Scene& s) {
         s.solver.kind = SolverKind::central_differences;
         s.solver.time_step_automatic = true;
         s.solver.duration.reset();
       }},
      {"one of statics", [](Scene& s) { s.solver.control = StaticControl::arc_length; }},
      {"asks for 0 modes", [](Scene& s) { s.solver.kind = SolverKind::modes, s.solver.modes = 0; }},
      {"max_steps = 0",
       [](Scene& s) {
         s.solver.kind = SolverKind::statics;
         s.solver.control = StaticControl::arc_length;
         s.solver.max_steps = 0;
       }},
      {"needs a displacement to control",
       [](Scene& s) { s.solver.kind = SolverKind::statics, s.solver.control = StaticControl::displacement; }},
      {"is on the body \"orgn\", which is not there",
       [](Scene& s) {
         s.solver.kind = SolverKind::statics, s.solver.control = StaticControl::displacement;
         s.solver.controlled = ControlledDisplacement{"orgn", {}, {}, {{1, 0, 0}}, {}};
       }},
      {"an estimate of errors", [](Scene& s) { s.output.estimate = EstimateBy::finer; }},
  };
  for (const Case& c : cases) {
    Scene scene = scene_of("settling_beam");
    c.spoil(scene);
    try {
      simulate(scene);
      ADD_FAILURE() << c.said;
    } catch (const SceneError& e) {
      EXPECT_NE(std::string(e.what()).find(c.said), std::string::npos) << c.said << ": " << e.what();
    }
  }
}

}  // namespace
}  // namespace fascia::simulate_test
