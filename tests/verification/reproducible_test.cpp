// Results have the same bits for any number of threads, by the program and by the library.
#include "fascia/scene_file.hpp"
#include "fascia/simulate.hpp"
#include "tests/support/scene_run.hpp"
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <ostream>

namespace fascia::test::reproducible_test {
namespace {

struct Case {
  const char* name;
  std::string scene;
  Settings settings;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Threads : public ::testing::TestWithParam<Case> {};

TEST_P(Threads, OneAndTwoGiveTheSameBits) {
  const Case& c = GetParam();
  const SceneRun one(c.scene, c.settings, {"--threads", "1"}), two(c.scene, c.settings, {"--threads", "2"});
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one.summary()["threads"], 1);
  EXPECT_EQ(two.summary()["threads"], 2);
  EXPECT_EQ(one.summary()["probes"].dump(), two.summary()["probes"].dump());
  EXPECT_EQ(one.bytes("probes.csv"), two.bytes("probes.csv"));
  EXPECT_EQ(one.difference_to(two), "");
  std::printf("%s: probes and fields identical\n", c.name);
}

/// Most cases here are solved by the library in a test's own process: it gives the program's numbers.
TEST_P(Threads, TheLibraryGivesTheProgramsBits) {
  const Case& c = GetParam();
  const SceneRun program(c.scene, c.settings, {"--threads", "2"});
  const SolvedScene library(c.scene, c.settings, 2);
  ASSERT_TRUE(program.ok() && library.ok());
  EXPECT_EQ(program.columns(), library.columns());
  EXPECT_EQ(program.history(), library.history());
  EXPECT_EQ(program.summary()["probes"].dump(), library.summary()["probes"].dump());
  std::size_t row = 0;
  Scene scene = read_scene_file(source_dir() / "scenes" / (c.scene + ".toml"), c.settings);
  scene.solver.threads = 2;
  const RunOutcome embedded = simulate(scene, [&](const RunState& state) {
    std::vector<double> values{state.time()};
    for (const Probe& probe : scene.probes)
      for (const double value : state.probe(probe.name)) values.push_back(value);
    std::vector<double> expected = row < program.history().size() ? program.history()[row] : std::vector<double>{};
    if (scene.solver.time_step_automatic && !expected.empty()) expected.pop_back();
    EXPECT_EQ(values, expected) << "row " << row;
    ++row;
    return true;
  });
  EXPECT_EQ(row, program.history().size());
  EXPECT_TRUE(embedded.done) << embedded.message;
  EXPECT_EQ(embedded.newton_iterations, program.newton_iterations());
  for (const char* key : {"status", "message", "convergence", "bodies", "couplings", "steps", "newton_iterations",
                          "linear_iterations", "residual", "warnings", "doubts"})
    EXPECT_EQ(program.summary()[key], library.summary()[key]) << key;
}

INSTANTIATE_TEST_SUITE_P(
    All, Threads,
    ::testing::Values(Case{"cholesky", "soft_cantilever", {"solver.linear.kind='cholesky'"}},
                      Case{"cg", "soft_cantilever", {"bodies.beam.frames.grid=[9,3,3]", "solver.linear.kind='cg'"}},
                      Case{"dynamics", "struck_beam", {"solver.steps=40"}}, Case{"immersed", "traction_free_ends", {}},
                      Case{"modes", "free_modes", {}}, Case{"path", "snap_through", {}},
                      Case{"explicit", "explicit_cantilever", {"solver.time_step='auto'"}},
                      Case{"coupled", "ligament_springs", {}},
                      Case{"scattered", "scattered_cantilever", {"bodies.beam.frames.poisson_disk=1.0"}}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace
}  // namespace fascia::test::reproducible_test
