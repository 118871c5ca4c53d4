#include "tests/robustness/scene_runs.hpp"

namespace fascia::path_runs_test {

// Static paths as scripts meet them: what is refused before anything is computed, and what a path that ends early says.
namespace {

using namespace fascia::test;

/// Half of a von Mises truss (scenes/snap_through.toml), pushed with 100 N; its limit load is 59.56 N.
constexpr const char* kBar = R"([bodies.bar]
model = "meshless"
domain = { line = { from = [0, 0, 0], to = [1, 0.1, 0] } }
radius = "10 cm"
density = 1000
material = { young = "10 MPa", poisson = 0.3 }
frames = { grid = [2] }

[[constraints]]
body = "bar"
where = { nearest = [0, 0, 0] }
fix = ["x", "y", "z", "rx", "ry"]

[[constraints]]
body = "bar"
where = { nearest = [1, 0.1, 0] }
fix = ["x", "z", "rx", "ry"]

[[loads]]
body = "bar"
where = { nearest = [1, 0.1, 0] }
total_force = [0, -100, 0]

[solver]
control = "arc-length"

[probes.guide]
body = "bar"
at = [1, 0.1, 0]
quantity = "displacement"

[output]
every_steps = 1
)";

class PathRuns : public SceneRuns {
 protected:
  ProgramResult run(const std::string& scene) const {
    write("scene.toml", scene);
    return fascia({"run", "scene.toml", "--output", "out"});
  }
  void expect_refused(const std::string& scene, const std::string& place, const std::string& says) const {
    const ProgramResult result = run(scene);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
  void expect_stopped(const std::string& scene, const std::string& says) const {
    const ProgramResult result = run(scene);
    EXPECT_EQ(result.status, 3) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(summary("out")["status"], "not-converged");
    EXPECT_NE(std::string(summary("out")["message"]).find(says), std::string::npos);
  }
  int rows() const { return static_cast<int>(lines_of(read_text(folder_ / "out" / "probes.csv")).size()) - 1; }
};

const char* const kControl = "control = \"arc-length\"";

TEST_F(PathRuns, RefusesWhatItCannotFollow) {
  expect_refused(
      with(kBar, kControl,
           "control = \"displacement\"\ncontrolled = { body = \"bar\", at = [2, 0.1, 0], direction = [0, 1, 0] }"),
      "solver.controlled.at", "outside body \"bar\"");
  expect_refused(with(kBar, "-100, 0]", "-100, 0]\nprofile = \"smooth\""), "loads[0]", "smooth");
}

TEST_F(PathRuns, ThatNothingDrivesSaySo) {
  expect_stopped(with(kBar, "[0, -100, 0]", "[0, 0, 0]"), "no load or motion that grows with the load factor");
  expect_stopped(
      with(kBar, kControl,
           "control = \"displacement\"\ncontrolled = { body = \"bar\", at = [1, 0.1, 0], direction = [1, 0, 0] }"),
      "do not move the controlled point along its direction");
}

/// A warning of the end is printed, once.
TEST_F(PathRuns, SayOnceWhatTheyPassed) {
  const ProgramResult result = run(kBar);
  ASSERT_EQ(result.status, 0);
  const std::string passed = "limit point passed at load factor 0.595643";
  const std::size_t first = result.err.find(passed);
  EXPECT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find(passed, first + 1), std::string::npos) << result.err;
}

TEST_F(PathRuns, ThatEndEarlyKeepWhatTheyHave) {
  expect_stopped(with(kBar, kControl, "control = \"arc-length\"\nmax_steps = 5"), "max_steps was reached");
  EXPECT_EQ(rows(), 5);
  EXPECT_EQ(summary("out")["steps"], 5);
  EXPECT_EQ(std::string(summary("out")["warnings"][0]).find("limit point passed at load factor 0.595643"), 0u);
}

/// Past a limit point the load factor falls; ParaView's times are the steps.
TEST_F(PathRuns, TimesOfThePvdAreSteps) {
  ASSERT_EQ(run(kBar).status, 0);
  const std::string pvd = read_text(folder_ / "out" / "scene.pvd");
  for (int step = 1; step <= rows(); ++step)
    EXPECT_NE(pvd.find("timestep=\"" + std::to_string(step) + "\""), std::string::npos) << pvd;
}

/// Few iterations a step keep load control from leaping to the far side.
TEST_F(PathRuns, LoadControlNamesTheLimitPoint) {
  const std::string load = "control = \"load\"\nnewton = { max_iterations = 5 }";
  expect_stopped(with(kBar, kControl, load), "use control = \"arc-length\" to follow it");
  // Too few iterations are no limit point.
  const ProgramResult result =
      run(with(with(kBar, kControl, "newton = { max_iterations = 1 }"), "[0, -100, 0]", "[0, 100, 0]"));
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(result.err.find("limit point"), std::string::npos) << result.err;
}

}  // namespace

}  // namespace fascia::path_runs_test
