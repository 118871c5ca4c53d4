#include "tests/robustness/scene_runs.hpp"
#include "tests/support/column.hpp"

#include <csignal>

namespace fascia::command_line_test {

// What scripts rely on: exit statuses, what goes to which output, options.
namespace {

using namespace fascia::test;

using CommandLine = SceneRuns;

TEST_F(CommandLine, TellsVersionAndHelp) {
  const ProgramResult version = fascia({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_NE(version.out.find("0.1.0"), std::string::npos) << version.out;
  EXPECT_NE(version.out.find("backends: cpu"), std::string::npos) << version.out;
  EXPECT_EQ(version.err, "");

  const ProgramResult help = fascia({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* command : {"run", "check"}) EXPECT_NE(help.out.find(command), std::string::npos) << help.out;
  const ProgramResult run_help = fascia({"run", "--help"});
  EXPECT_EQ(run_help.status, 0);
  for (const char* option : {"--set", "--output", "--backend", "--threads", "--gpus", "--quiet", "--json"}) {
    EXPECT_NE(run_help.out.find(option), std::string::npos) << option;
  }
}

TEST_F(CommandLine, RefusesWrongUse) {
  write("scene.toml", kCantilever);
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"fly"},
                                                       {"run"},
                                                       {"check"},
                                                       {"run", "scene.toml", "--colour"},
                                                       {"run", "scene.toml", "--backend", "abacus"},
                                                       {"run", "scene.toml", "--threads", "two"},
                                                       {"run", "scene.toml", "--threads", "-1"},
                                                       {"run", "scene.toml", "--set"},
                                                       {"run", "scene.toml", "--set", "no_equals_sign"},
                                                       {"run", "scene.toml", "--output"}};
  const auto before = snapshot();
  for (const auto& args : wrong) {
    const ProgramResult result = fascia(args);
    EXPECT_EQ(result.status, 2) << ::testing::PrintToString(args) << "\n" << result.err;
    EXPECT_NE(result.err, "") << ::testing::PrintToString(args);
  }
  EXPECT_EQ(snapshot(), before);
}

TEST_F(CommandLine, RunsAScene) {
  write("my scene.toml", kCantilever);
  const ProgramResult result = fascia({"run", "my scene.toml", "--output", "a result"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json summary = this->summary("a result");
  EXPECT_EQ(summary.at("fascia"), "0.1.0");
  EXPECT_EQ(summary.at("scene"), "my scene.toml");
  EXPECT_EQ(summary.at("status"), "converged");
  EXPECT_EQ(summary.at("backend"), "cpu");
  EXPECT_EQ(summary.at("precision"), "double");
  EXPECT_EQ(summary.at("bodies").at("beam").at("model"), "meshless");
  EXPECT_EQ(summary.at("bodies").at("beam").at("frames"), 12);
  EXPECT_NEAR(summary.at("bodies").at("beam").at("volume").get<double>(), 0.04, 1e-12);
  EXPECT_EQ(summary.at("dofs"), 8 * 6);
  EXPECT_EQ(summary.at("probes").at("tip").at("unit"), "m");
  EXPECT_LT(summary.at("probes").at("tip").at("value").at(1).get<double>(), -0.01);
  EXPECT_NEAR(summary.at("probes").at("weight").at("value").get<double>(), 40.0, 1e-9);
  EXPECT_GT(summary.at("peak_memory_bytes").get<double>(), 1e6);
  for (const char* key : {"setup", "solve", "output", "solve_processor", "step_median", "step_p99", "step_max"}) {
    EXPECT_TRUE(summary.at("seconds").contains(key)) << key;
  }
}

TEST_F(CommandLine, JsonIsAllThatStandardOutputHolds) {
  write("scene.toml", kCantilever);
  const ProgramResult result = fascia({"run", "scene.toml", "--output", "out", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out), summary("out"));

  const ProgramResult wrong = fascia({"run", "scene.toml", "--output", "out", "--json", "--set", "solver.kind=3"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.out, "");
}

TEST_F(CommandLine, QuietSaysNothingWhenAllIsWell) {
  write("scene.toml", kCantilever);
  const ProgramResult result = fascia({"run", "scene.toml", "--output", "out", "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "");
}

TEST_F(CommandLine, SetOverridesTheScene) {
  write("scene.toml", kCantilever);
  ASSERT_EQ(fascia({"run", "scene.toml", "--output", "soft"}).status, 0);
  ASSERT_EQ(fascia({"run", "scene.toml", "--output", "stiff", "--set", "materials.soft.young=1 MPa", "--set",
                    "bodies.beam.frames.grid=[5, 2, 2]"})
                .status,
            0);
  const auto sag = [this](const char* result) {
    return summary(result).at("probes").at("tip").at("value").at(1).get<double>();
  };
  EXPECT_LT(sag("soft"), 5 * sag("stiff"));
  EXPECT_EQ(summary("stiff").at("bodies").at("beam").at("frames"), 20);

  const ProgramResult unknown = fascia({"run", "scene.toml", "--set", "materials.soft.yuong=1e6"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_TRUE(unknown.err.starts_with("--set:")) << unknown.err;
  EXPECT_NE(unknown.err.find("young"), std::string::npos) << unknown.err;
}

TEST_F(CommandLine, ResultsDoNotDependOnThreads) {
  write("scene.toml", dynamic_scene());
  ASSERT_EQ(fascia({"run", "scene.toml", "--output", "one", "--threads", "1"}).status, 0);
  ASSERT_EQ(fascia({"run", "scene.toml", "--output", "two", "--threads", "2"}).status, 0);
  EXPECT_EQ(summary("one").at("threads"), 1);
  EXPECT_EQ(summary("two").at("threads"), 2);
  EXPECT_EQ(summary("one").at("probes"), summary("two").at("probes"));
  EXPECT_EQ(read_text(folder_ / "one/probes.csv"), read_text(folder_ / "two/probes.csv"));
}

TEST_F(CommandLine, CheckTellsAndWritesNothing) {
  write("scene.toml", kCantilever);
  const auto before = snapshot();
  const ProgramResult result = fascia({"check", "scene.toml"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("48"), std::string::npos) << "degrees of freedom: " << result.out;
  EXPECT_EQ(fascia({"check", "scene.toml", "--set", "materials.soft.poisson=0.6"}).status, 2);
  EXPECT_EQ(snapshot(), before);
}

TEST_F(CommandLine, TakesTheBackendOrSaysThatItIsNotThere) {
  write("scene.toml", kCantilever);
  const auto before = snapshot();
  const ProgramResult result = fascia({"run", "scene.toml", "--backend", "cuda", "--json"});
  if (result.status == 0) {
    EXPECT_NE(result.out.find("\"backend\": \"cuda\""), std::string::npos) << result.out;
    return;
  }
  EXPECT_EQ(result.status, 5);
  EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
  EXPECT_EQ(fascia({"run", "scene.toml", "--set", "solver.backend=cuda"}).status, 5);
  EXPECT_EQ(fascia({"check", "scene.toml", "--backend", "cuda"}).status, 5);
  EXPECT_EQ(snapshot(), before);
  EXPECT_EQ(fascia({"run", "scene.toml", "--backend", "auto"}).status, 0);
}

TEST_F(CommandLine, SaysThatSinglePrecisionNeedsTheGpu) {
  write("scene.toml", kCantilever);
  const ProgramResult refused =
      fascia({"run", "scene.toml", "--set", "solver.precision=single", "--backend", "cpu", "--output", "refused"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("solver.precision: \"single\" needs the GPU"), std::string::npos) << refused.err;
  const ProgramResult result = fascia({"run", "scene.toml", "--set", "solver.precision=single", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json summary = this->summary("out");
  if (summary.at("backend") == "cuda") {
    EXPECT_EQ(summary.at("precision"), "single");
    return;
  }
  EXPECT_EQ(summary.at("precision"), "double");
  EXPECT_NE(result.err.find("precision = \"single\" needs the GPU, and there is none"), std::string::npos)
      << result.err;
  EXPECT_EQ(summary.at("warnings").size(), 1u);
}

/// On the processor conjugate gradients know mixed precision, and a factor does not.
TEST_F(CommandLine, TellsThePrecisionThatWasUsed) {
  write("scene.toml", kCantilever);
  const auto precision = [&](const std::string& backend, const std::string& linear) {
    const std::string out = backend + "_" + linear;
    const ProgramResult result = fascia({"run", "scene.toml", "--set", "solver.precision=mixed", "--set",
                                         "solver.linear.kind=" + linear, "--backend", backend, "--output", out});
    EXPECT_EQ(result.status, 0) << result.err;
    const nlohmann::json summary = this->summary(out);
    EXPECT_EQ(summary.at("backend"), "cpu");
    EXPECT_TRUE(summary.at("warnings").empty()) << result.err;
    return summary.at("precision");
  };
  EXPECT_EQ(precision("cpu", "cg"), "mixed");
  EXPECT_EQ(precision("cpu", "cholesky"), "double");
  EXPECT_EQ(precision("auto", "cg"), "mixed");
}

TEST_F(CommandLine, SeveralGpusAreThoseThatThereAre) {
  write("scene.toml", kCantilever);
  const ProgramResult refused = fascia({"run", "scene.toml", "--gpus", "2", "--backend", "cpu", "--output", "refused"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("solver.gpus: 2 does not go with backend = \"cpu\""), std::string::npos) << refused.err;
  EXPECT_EQ(fascia({"run", "scene.toml", "--gpus", "0"}).status, 2);
  EXPECT_EQ(fascia({"run", "scene.toml", "--gpus", "2", "--set", "solver.kind=modes"}).status, 2);
  const ProgramResult result = fascia({"run", "scene.toml", "--gpus", "2", "--output", "out"});
  EXPECT_EQ(result.status, 0) << result.err;
  const nlohmann::json summary = this->summary("out");
  if (summary.at("gpus") == 2) return;
  EXPECT_NE(result.err.find("gpus = 2"), std::string::npos) << result.err;
  EXPECT_EQ(summary.at("warnings").size(), 1u);
}

TEST_F(CommandLine, SaysWhichFileCannotBeRead) {
  std::filesystem::create_directory(folder_ / "folder.toml");
  for (const char* name : {"absent.toml", "folder.toml"}) {
    for (const char* command : {"run", "check"}) {
      const ProgramResult result = fascia({command, name});
      EXPECT_EQ(result.status, 4) << command << " " << name;
      EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
      EXPECT_NE(result.err.find(name), std::string::npos) << result.err;
    }
  }
}

TEST_F(CommandLine, WritesWhatThereIsWhenItDoesNotConverge) {
  write("scene.toml", kCantilever);
  const ProgramResult result = fascia({"run", "scene.toml", "--output", "out", "--set", "world.gravity=[0, -500, 0]",
                                       "--set", "solver.newton={ max_iterations = 1, tolerance = 1e-12 }"});
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_NE(result.err, "");
  const nlohmann::json summary = this->summary("out");
  EXPECT_NE(summary.at("status"), "converged");
  EXPECT_NE(summary.at("message"), "");
}

/// A column under twice its Euler load, solved from its straight state.
TEST_F(CommandLine, ExitsWith3WhereTheEndIsUnstableUnlessTheSceneAcceptsIt) {
  write("column.toml", column(2 * kEuler));
  const std::string steps = "solver.load_steps=2", accept = "solver.accept=['unstable']";
  EXPECT_EQ(fascia({"run", "column.toml", "--output", "out", "--set", steps}).status, 3);
  EXPECT_EQ(summary("out")["status"], "unstable");
  EXPECT_EQ(fascia({"run", "column.toml", "--output", "out", "--set", steps, "--set", accept}).status, 0);
}

TEST_F(CommandLine, ExitsWith0WhereStepsAboveTheToleranceAreAskedFor) {
  write("scene.toml", kCantilever);
  EXPECT_EQ(
      fascia({"run", "scene.toml", "--output", "out", "--set", "solver.newton={max_iterations=1,on_limit='continue'}"})
          .status,
      0);
  EXPECT_EQ(summary("out")["status"], "not-converged");
}

TEST_F(CommandLine, WritesNothingWhereAStepIsAboveTheStableOne) {
  expect_refused(with(kCantilever, "kind = \"static\"", "kind = \"explicit\"\ntime_step = 1\nsteps = 2"),
                 {"is above the stable step"});
}

TEST_F(CommandLine, StopsAtControlC) {
  write("scene.toml", with(dynamic_scene(), "steps = 10\n", "steps = 100000000\n"));
  ProgramOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(1500);
  const ProgramResult result =
      fascia({"run", "scene.toml", "--output", "out", "--set", "output.every_steps=100000"}, options);
  EXPECT_EQ(result.status, 130) << result.err;
  const nlohmann::json summary = this->summary("out");
  EXPECT_GT(summary.at("steps"), 0);
  EXPECT_LT(summary.at("steps"), 100000000);
  EXPECT_NE(summary.at("message"), "");
}

}  // namespace

}  // namespace fascia::command_line_test
