// Central differences through scenes: against implicit kinds, the stable step, what ends a run early, what is written.
#include "tests/support/paths.hpp"
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fascia::test::explicit_scenes_test {
namespace {

using Vector = std::array<double, 3>;
using Rows = std::vector<std::vector<double>>;

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

Settings with(Settings settings, const Settings& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

/// The beam of the scene as a meshless body with this domain, thickness or radius, and frames.
Settings meshless(const std::string& rest) {
  return {"bodies.beam={model='meshless',density=1000,material={young=2e6,poisson=0.3}," + rest + "}"};
}

/// The beam in every discretisation.
std::vector<std::pair<std::string, Settings>> discretisations() {
  const std::string box = "domain={box={min=[0,-0.1,-0.1],max=[1,0.1,0.1]}},";
  return {{"tetrahedra", {"bodies.beam.model='tetrahedra'"}},
          {"hexahedra", {}},
          {"rigid frames", meshless(box + "frames={grid=[7,2,2]}")},
          {"affine frames", meshless(box + "frames={grid=[6,2,2],kind='affine'}")},
          {"sheet", meshless("domain={rectangle={origin=[0,-0.1,0],edge_u=[1,0,0],edge_v=[0,0.2,0]}},thickness=0.2,"
                             "frames={grid=[7,2]}")},
          {"line", meshless("domain={line={from=[0,0,0],to=[1,0,0]}},radius=0.1,frames={grid=[11]}")},
          {"scattered", meshless(box + "frames={poisson_disk=0.25}")}};
}

/// Largest distance of the tip in two runs at any saved time, relative to the tip's displacement then.
double apart(const Rows& a, const Rows& b) {
  if (a.size() != b.size() || a.size() < 2) return NAN;
  double most = 0;
  for (std::size_t i = 1; i < a.size(); ++i) {
    EXPECT_NEAR(a[i][0], b[i][0], 1e-12) << "saved at the same times";
    most = std::max(most, std::hypot(a[i][1] - b[i][1], a[i][2] - b[i][2], a[i][3] - b[i][3]) /
                              std::hypot(b[i][1], b[i][2], b[i][3]));
  }
  return most;
}

Rows tip_history(const Settings& body, const std::string& kind, double h) {
  const Settings solver{"solver={kind='" + kind + "',time_step=" + number(h) + ",duration=0.2}", "output.every=0.04"};
  return SolvedScene("explicit_cantilever", with(body, solver), 1).history();
}

/// Within 1 % of every implicit kind at all saved times, in every discretisation.
TEST(ExplicitScenes, AgreesWithImplicitKinds) {
  std::printf("%-14s %9s %16s %12s %12s\n", "body", "step [s]", "implicit Euler", "midpoint", "newmark");
  for (const auto& [name, body] : discretisations()) {
    const double h = name == "scattered" ? 2e-5 : 1e-3;  // the springs that hold scattered material are stiff
    const Rows rows = tip_history(body, "explicit", h);
    const double euler_step = name.ends_with("hedra") ? 1e-4 : 2e-4;
    const double euler = name == "scattered" ? 0 : apart(rows, tip_history(body, "implicit-euler", euler_step));
    const double midpoint = apart(rows, tip_history(body, "midpoint", 2e-3));
    const double newmark = apart(rows, tip_history(body, "newmark", 2e-3));
    std::printf("%-14s %9.0e %16.1e %12.1e %12.1e\n", name.c_str(), h, euler, midpoint, newmark);
    EXPECT_LT(euler, 0.01) << name;
    EXPECT_LT(midpoint, 0.01) << name;
    EXPECT_LT(newmark, 0.01) << name;
  }
}

/// Both are of second order, so the difference is too.
TEST(ExplicitScenes, DifferenceFallsWithTheSquareOfTheStep) {
  std::printf("%-14s %12s %12s %12s %8s\n", "body", "1 ms", "0.5 ms", "0.25 ms", "ratio");
  for (const auto& [name, body] : discretisations()) {
    if (name != "tetrahedra" && name != "hexahedra" && name != "line") continue;
    double d[3];
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-3 / (1 << k);
      d[k] = apart(tip_history(body, "explicit", h), tip_history(body, "midpoint", h));
    }
    std::printf("%-14s %12.2e %12.2e %12.2e %8.2f\n", name.c_str(), d[0], d[1], d[2], d[1] / d[2]);
    EXPECT_NEAR(d[1] / d[2], 4, 0.6) << name;  // the highest modes still count
  }
}

SolvedScene run_with(const Settings& settings) { return SolvedScene::of_file("explicit_cantilever", settings, 1); }

/// A scene with a step far above the limit is refused so.
struct Refusal {
  std::string status, message;
  double limit = NAN;  ///< "above the stable step, LIMIT s"
};

Refusal refusal(const Settings& settings) {
  const SolvedScene run = run_with(with(settings, {"solver.time_step=10"}));
  Refusal r{run.status(), run.message()};
  const std::string before = "above the stable step, ";
  const std::size_t at = r.message.find(before);
  if (at != std::string::npos) r.limit = std::stod(r.message.substr(at + before.size()));
  return r;
}

/// The limit is 0.95 of 2 / omega, where omega is known: a bar that moves along its length only, h / c with its
/// c = sqrt((lambda + 2 mu) / rho), and a free cube of one element, whose fastest motion is the change of its size,
/// omega^2 = 4 E / ((1 - 2 nu) rho a^2).
TEST(ExplicitScenes, StableStepAgainstClosedForms) {
  const double young = 2e6, nu = 0.3, density = 1000;
  const double c = std::sqrt(young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / density);
  const Refusal bar = refusal({"constraints[0]={body='beam',where='all',fix=['y','z']}"});
  const Refusal cube =
      refusal({"bodies.beam.domain.box={min=[0,0,0],max=[0.2,0.2,0.2],cells=[1,1,1]}", "constraints=[]", "probes={}"});
  const double bar_limit = 0.95 * 0.1 / c, cube_limit = 0.95 * 0.2 * std::sqrt((1 - 2 * nu) * density / young);
  std::printf("bar of hexahedra %.4e s, 0.95 h / c = %.4e s\nfree cube %.4e s, closed form %.4e s\n", bar.limit,
              bar_limit, cube.limit, cube_limit);
  EXPECT_NEAR(bar.limit, bar_limit, 1e-3 * bar_limit);  // four digits are printed, and iterated to 1e-4
  EXPECT_NEAR(cube.limit, cube_limit, 1e-3 * cube_limit);
}

/// The beam by formulation, law and remedy, besides its discretisations; all with a small mesh.
std::vector<std::pair<std::string, Settings>> variants() {
  std::vector<std::pair<std::string, Settings>> all = discretisations();
  std::erase_if(all, [](const auto& v) { return v.first.ends_with("hedra"); });
  for (const std::string model : {"tetrahedra", "hexahedra"}) {
    const Settings mesh{"bodies.beam.model='" + model + "'", "bodies.beam.domain.box.cells=[5,1,1]"};
    const auto add = [&](const std::string& name, const Settings& s) {
      all.push_back({model + ", " + name, with(mesh, s)});
    };
    add("plain", {});
    add("neo-Hookean", {"bodies.beam.material.law='neo-hookean'"});
    add("corotational", {"bodies.beam.formulation='corotational'"});
    add("linear", {"bodies.beam.formulation='linear'"});
    add("quadratic", {"bodies.beam.order=2"});
    add("damped", {"bodies.beam.material.damping={mass=1,stiffness=1e-3}"});
    if (model == "hexahedra") continue;
    add("f-bar", {"bodies.beam.locking='f-bar'", "bodies.beam.material.poisson=0.45"});
    add("incompressible", {"bodies.beam.incompressibility=1e6"});
  }
  return all;
}

/// A step above the limit is refused with the limit, which is accepted; just below it 2,000 steps gain no energy.
TEST(ExplicitScenes, StableStepOfEveryKindOfBody) {
  std::printf("%-28s %12s %14s %14s\n", "body", "limit [s]", "least energy", "most energy");
  for (const auto& [name, body] : variants()) {
    const Refusal r = refusal(body);
    EXPECT_EQ(r.status, "refused") << name;
    EXPECT_NE(r.message.find("solver.time_step: 10 s is above the stable step"), std::string::npos) << r.message;
    ASSERT_GT(r.limit, 0) << name << r.message;
    const SolvedScene advised =
        run_with(with(body, {"solver={kind='explicit',steps=1,time_step=" + number(r.limit) + "}"}));
    EXPECT_TRUE(advised.ok()) << name << ": the limit in the message is above the limit\n" << advised.message();
    const SolvedScene run("explicit_cantilever",
                          with(body, {"solver={kind='explicit',steps=2000,time_step=" + number(0.9994 * r.limit) + "}",
                                      "output={every_steps=250}"}),
                          1);
    if (!run.ok()) continue;
    // From the horizontal at rest nothing is gained; the weight's work in a sag by a tenth of the length is the scale.
    const double scale = 1000 * 0.04 * 9.81 * 0.05;
    double least = 0, most = 0;
    for (const auto& row : run.history()) {
      const double energy = row[row.size() - 2];
      least = std::min(least, energy / scale);
      most = std::max(most, energy / scale);
    }
    std::printf("%-28s %12.4e %14.1e %14.1e\n", name.c_str(), r.limit, least, most);
    EXPECT_LT(most, 1e-4) << name;
    if (!name.ends_with("damped")) {
      EXPECT_GT(least, -1e-3) << name;
    }
  }
}

/// Pulled to a multiple of its length the material stiffens, so that the step at rest no longer serves.
TEST(ExplicitScenes, StiffeningMaterialEndsWithAdvice) {
  const SolvedScene run =
      run_with({"loads=[{body='beam',where={box={min=[0.99,-1,-1],max=[1.01,1,1]}},total_force=[1e5,0,0],over=0.2}]",
                "output.every=0.01", "solver.time_step=1.7e-3"});
  const nlohmann::json& summary = run.summary();
  std::printf("%s\n", run.message().c_str());
  EXPECT_NE(run.message().find("the material stiffened: its stable step shrank to"), std::string::npos);
  EXPECT_NE(run.message().find("step "), std::string::npos);
  EXPECT_EQ(summary["status"], "diverged");
  EXPECT_GT(summary["steps"], 10);
  std::printf("steps %d, simulated time %.6f s\n", summary["steps"].get<int>(),
              summary["simulated_time"].get<double>());
  EXPECT_LT(summary["simulated_time"], 0.2);
  const auto tip = SolvedScene::as_vector(summary["probes"]["tip"]["value"]);
  EXPECT_TRUE(std::isfinite(tip[0]));
  EXPECT_GT(tip[0], 0.05) << "what was computed until then";
  EXPECT_GT(run.saved(), 1);
}

/// The same with steps that follow it: they shrink, and the last column of probes.csv says so.
TEST(ExplicitScenes, AutomaticStepsFollowAStiffeningMaterial) {
  const SolvedScene run(
      "explicit_cantilever",
      {"loads=[{body='beam',where={box={min=[0.99,-1,-1],max=[1.01,1,1]}},total_force=[1e5,0,0],over=0.2}]",
       "output.every=0.01", "solver.time_step='auto'"});
  ASSERT_TRUE(run.ok());
  EXPECT_EQ(run.summary()["simulated_time"], 0.2);
  EXPECT_EQ(run.columns().back(), "time_step");
  const Rows rows = run.history();
  ASSERT_EQ(rows.size(), 21U);
  std::printf("%d steps, from %.3e s to %.3e s\n", run.summary()["steps"].get<int>(), rows.front().back(),
              rows.back().back());
  EXPECT_LT(rows.back().back(), 0.6 * rows.front().back());
  const SolvedScene given("explicit_cantilever");
  EXPECT_NE(given.columns().back(), "time_step") << "constant steps have no such column";
}

/// Every kind ends at its duration, whatever the step.
TEST(ExplicitScenes, RunsEndAtTheirDuration) {
  for (const std::string kind : {"implicit-euler", "bdf2", "newmark", "midpoint", "explicit"})
    for (const std::string duration : {"0.0105", "0.01", "0.0007"}) {
      const SolvedScene run("explicit_cantilever",
                            {"bodies.beam.domain.box.cells=[5,1,1]",
                             "solver={kind='" + kind + "',time_step=1e-3,duration=" + duration + "}"});
      ASSERT_TRUE(run.ok());
      EXPECT_EQ(run.summary()["simulated_time"], std::stod(duration)) << kind;
      EXPECT_EQ(run.history().back()[0], std::stod(duration)) << kind;
      EXPECT_EQ(run.summary()["steps"], std::ceil(std::stod(duration) * 1e3 - 1e-9)) << kind;
    }
}

/// Saved times, steps and the like mean the same as for implicit kinds.
TEST(ExplicitScenes, OutputAsOfImplicitKinds) {
  struct Case {
    std::string output, steps;
    std::size_t rows;
  };
  const Case cases[] = {{"output={}", "duration=0.2", 6},
                        {"output={every=0.03}", "duration=0.2", 8},
                        {"output={every_steps=30}", "steps=200", 8},
                        {"output={every_steps=1}", "steps=20", 21},
                        {"output={every=1}", "steps=7", 2}};
  for (const Case& c : cases) {
    Rows rows[2];
    for (int k = 0; k < 2; ++k) {
      const std::string kind = k == 0 ? "explicit" : "midpoint";
      const SolvedScene run("explicit_cantilever", {"bodies.beam.domain.box.cells=[5,1,1]", c.output,
                                                    "solver={kind='" + kind + "',time_step=1e-3," + c.steps + "}"});
      ASSERT_TRUE(run.ok());
      rows[k] = run.history();
      EXPECT_EQ(run.summary()["steps"], std::lround(rows[k].back()[0] / 1e-3)) << c.output;
      EXPECT_NEAR(run.summary()["simulated_time"], rows[k].back()[0], 1e-12);
      EXPECT_GT(run.summary()["seconds"]["step_median"], 0);
      EXPECT_LE(run.summary()["seconds"]["step_median"], run.summary()["seconds"]["step_max"]);
      EXPECT_EQ(run.saved(), static_cast<int>(rows[k].size())) << "as many states as rows";
    }
    ASSERT_EQ(rows[0].size(), c.rows) << c.output;
    ASSERT_EQ(rows[1].size(), c.rows) << c.output;
    for (std::size_t i = 0; i < c.rows; ++i) EXPECT_NEAR(rows[0][i][0], rows[1][i][0], 1e-12) << c.output;
  }
  const SolvedScene automatic("explicit_cantilever", {"solver.time_step='auto'"});
  const double limit = refusal({}).limit;
  EXPECT_NEAR(automatic.summary()["steps"].get<double>(), 5 * std::ceil(0.04 / limit), 0.05 * 0.2 / limit)
      << "about the stable step at rest, in parts of the saved times";
  EXPECT_EQ(automatic.summary()["simulated_time"], 0.2);
}

/// A support that lifts its body against the weight, at once or gently: no false alarm.
TEST(ExplicitScenes, DrivenBodiesAreNotCalledUnstable) {
  for (const std::string profile :
       {"profile='linear',over=0.1", "profile='smooth',over=0.1", "profile={sine={period=0.4}}"}) {
    for (const std::string gravity : {"-9.81", "0", "9.81"}) {
      const SolvedScene run =
          run_with({"constraints[0]={body='beam',where={box={min=[-0.001,-1,-1],max=[0.001,1,1]}},"
                    "move={translate=[0,0,0.05]}," +
                        profile + "}",
                    "world.gravity=[0,0," + gravity + "]", "solver={kind='explicit',time_step=1e-3,steps=150}",
                    "output={every_steps=75}"});
      EXPECT_TRUE(run.ok()) << profile << ", gravity " << gravity << ": " << run.message();
    }
  }
}

}  // namespace
}  // namespace fascia::test::explicit_scenes_test
