// Runs that are stopped, killed, or cannot write: what was saved stays, whole, and the next run finds its way.
#include "tests/robustness/scene_runs.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/crushed_cube.hpp"
#include "tests/support/paths.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <random>
#include <regex>
#include <set>

namespace fascia::interrupted_runs_test {
namespace {

using namespace fascia::test;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class InterruptedRuns : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    write("short.toml", kCantilever);
    write("long.toml", with(dynamic_scene(), "steps = 10\n", "steps = 100000000\n"));
  }
  ProgramResult stopped(const std::vector<std::string>& args, int signal, int milliseconds) const {
    ProgramOptions options;
    options.signal = signal;
    options.signal_after = std::chrono::milliseconds(milliseconds);
    return fascia(args, options);
  }
  ProgramResult in_shell(const std::string& command) const {
    ProgramOptions options;
    options.directory = folder_;
    options.environment = {"PROGRAM=" + fascia::test::program()};
    return run_program({"sh", "-c", command}, options);
  }

  /// Rows of probes.csv, each as long as the head; the states of the .pvd, each of which is there.
  void expect_whole(const std::string& name, std::size_t least_states) const {
    const std::vector<std::string> rows = lines_of(read_text(folder_ / "out/probes.csv"));
    ASSERT_FALSE(rows.empty());
    for (const std::string& row : rows)
      EXPECT_EQ(std::count(row.begin(), row.end(), ','), std::count(rows[0].begin(), rows[0].end(), ',')) << row;
    EXPECT_TRUE(read_text(folder_ / "out/probes.csv").ends_with("\n"));
    const std::string text = read_text(folder_ / "out" / (name + ".pvd"));
    EXPECT_TRUE(text.ends_with("</VTKFile>\n"));
    const std::regex file(R"re(file="([^"]*)")re");
    std::set<std::string> states;
    for (auto match = std::sregex_iterator(text.begin(), text.end(), file); match != std::sregex_iterator(); ++match)
      states.insert((*match)[1]);
    EXPECT_GE(states.size(), least_states);
    for (const std::string& state : states) EXPECT_TRUE(read_text(folder_ / "out" / state).ends_with("</VTKFile>\n"));
    EXPECT_GE(rows.size(), states.size());
  }
  void expect_short_run_replaces_it() const {
    ASSERT_EQ(fascia({"run", "short.toml", "--output", "out"}).status, 0);
    expect_only(folder_ / "out", {"summary.json", "probes.csv", "short.pvd", "beam_00000.vtu", "notes.txt"});
  }
  static void expect_only(const fs::path& directory, const std::set<std::string>& files) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) names.insert(entry.path().filename().string());
    EXPECT_EQ(names, files);
  }
};

TEST_F(InterruptedRuns, StopAtEverySignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const ProgramResult result = stopped({"run", "long.toml", "--output", "out"}, signal, 400);
    EXPECT_EQ(result.status, 128 + signal) << result.err;
    EXPECT_EQ(summary("out").at("status"), "interrupted");
    expect_whole("long", 2);
  }
}

/// `timeout` sends a signal to the program and another one to its group: both ask for the same.
TEST_F(InterruptedRuns, TwoSignalsAtOnceAreOneRequest) {
  const ProgramResult result =
      in_shell("timeout --preserve-status -s INT 0.5 \"$PROGRAM\" run long.toml --output out --quiet");
  EXPECT_EQ(result.status, 128 + SIGINT) << result.err;
  EXPECT_EQ(summary("out").at("status"), "interrupted");
  expect_whole("long", 2);
}

TEST_F(InterruptedRuns, KilledLeaveWhatWasSaved) {
  for (const int milliseconds : {50, 120, 300, 1500}) {
    const ProgramResult result = stopped({"run", "long.toml", "--output", "out"}, SIGKILL, milliseconds);
    EXPECT_EQ(result.status, 128 + SIGKILL);
    if (milliseconds < 300) continue;  // on a machine that is busy nothing may have been saved
    EXPECT_EQ(summary("out").at("status"), "running");
    expect_whole("long", 1);
    write("out/notes.txt", "mine");
    if (milliseconds < 1000) continue;
    EXPECT_GT(summary("out").at("steps"), 0);
    EXPECT_GT(summary("out").at("seconds_left"), 0);
    expect_short_run_replaces_it();
    EXPECT_EQ(read_text(folder_ / "out/notes.txt"), "mine");
  }
}

/// Where a step takes long, the process does not wait for it; an older result comes back.
TEST_F(InterruptedRuns, StopWithinAStep) {
  const std::vector<std::string> heavy{"run",      "short.toml",
                                       "--output", "out",
                                       "--set",    "bodies.beam.frames.grid=[60,20,20]",
                                       "--set",    "solver.linear.kind=cholesky"};
  for (const bool older : {false, true}) {
    if (older) {
      ASSERT_EQ(fascia({"run", "short.toml", "--output", "out"}).status, 0);
    }
    const auto before = older ? snapshot() : std::map<std::string, std::string>{};
    const Clock::time_point start = Clock::now();
    const ProgramResult result = stopped(heavy, SIGTERM, 900);
    EXPECT_EQ(result.status, 128 + SIGTERM) << result.err;
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - start).count(), 30) << "it did not wait for the solution";
    if (older) {
      EXPECT_EQ(snapshot(), before);
    } else if (fs::exists(folder_ / "out")) {
      EXPECT_EQ(summary("out").at("status"), "interrupted");
      fs::remove_all(folder_ / "out");
    }
  }
}

TEST_F(InterruptedRuns, FullDiskLeavesWhatWasSaved) {
  const ProgramResult result =
      in_shell("trap '' XFSZ; ulimit -f 64; exec \"$PROGRAM\" run long.toml --output out --set output.every_steps=1");
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_NE(result.err.find("cannot be written"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("out holds what was saved before"), std::string::npos) << result.err;
  expect_whole("long", 10);
  EXPECT_EQ(summary("out").at("status"), "interrupted");
  EXPECT_NE(summary("out").at("message").get<std::string>().find("cannot be written"), std::string::npos);
}

TEST_F(InterruptedRuns, ASecondOneIntoTheSameDirectoryIsRefused) {
  const ProgramResult result = in_shell(
      "\"$PROGRAM\" run long.toml --output out --quiet & first=$!\n"
      "while [ ! -e out/long.pvd ]; do sleep 0.05; done\n"
      "\"$PROGRAM\" run short.toml --output out --quiet; second=$?\n"
      "kill -TERM $first; wait $first; echo $second $?");
  EXPECT_EQ(result.out, "4 143\n") << result.err;
  EXPECT_NE(result.err.find("another run writes its result there (process "), std::string::npos) << result.err;
  expect_whole("long", 1);
}

TEST_F(InterruptedRuns, StandardErrorThatIsClosedOrFullEndsNothing) {
  const std::string loud = "\"$PROGRAM\" run short.toml --output out -v --set probes.tip.at=[1.0001,0.1,0.1] ";
  ASSERT_FALSE(in_shell(loud).err.empty());
  const std::string probes = read_text(folder_ / "out/probes.csv");
  for (const char* where : {"2>&-", "2>/dev/full", ">&- 2>&-"}) {
    EXPECT_EQ(in_shell(loud + where).status, 0) << where;
    EXPECT_EQ(read_text(folder_ / "out/probes.csv"), probes) << where;
    EXPECT_EQ(summary("out").at("status"), "converged");
  }
  EXPECT_EQ(in_shell("\"$PROGRAM\" run short.toml --output out --json >/dev/full").status, 4);
}

/// Every solver, signal and moment: there is the older result, or the new one up to its last state, or nothing; a
/// foreign file stays, and the next run is as if nothing had been.
TEST_F(InterruptedRuns, AtRandomMomentsLeaveWholeResults) {
  const std::vector<std::string> solvers{"{kind='static',load_steps=100000}",
                                         "{kind='static',control='arc-length',max_steps=100000}",
                                         "{kind='implicit-euler',time_step=0.01,steps=1000000}",
                                         "{kind='newmark',time_step=0.01,steps=1000000}",
                                         "{kind='explicit',time_step='auto',duration=1e6}",
                                         "{kind='modes',count=20}"};
  const std::vector<int> signals{SIGINT, SIGTERM, SIGHUP, SIGKILL};
  std::mt19937 random(static_cast<unsigned>(cases(6)));
  const auto any = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  ASSERT_EQ(fascia({"run", "short.toml", "--output", "out"}).status, 0);
  int older = 0, saved = 0;
  for (int k = 0; k < cases(6); ++k) {
    write("out/notes.txt", "mine");
    const auto before = snapshot();
    const int signal = signals[any(signals.size())], moment = static_cast<int>(any(700));
    const std::string solver = solvers[static_cast<std::size_t>(k) % solvers.size()];
    const std::string every = solver.find("static") == std::string::npos ? "every_steps=3" : "fields=['displacement']";
    const ProgramResult result = stopped({"run", "short.toml", "--output", "out", "--set", "solver=" + solver, "--set",
                                          "output={" + every + "}", "--set", "bodies.beam.frames.grid=[9,4,4]", "--set",
                                          solver.find("modes") == std::string::npos ? "title=run" : "probes={}"},
                                         signal, moment);
    SCOPED_TRACE(solver + " ended by " + std::to_string(signal) + " after " + std::to_string(moment) +
                 " ms: " + result.err);
    EXPECT_TRUE(result.status == 128 + signal || result.status == 0) << result.status;
    EXPECT_EQ(read_text(folder_ / "out/notes.txt"), "mine");
    auto after = snapshot();
    std::erase_if(after, [](const auto& file) { return file.first.find(".fascia.lock") != std::string::npos; });
    if (after == before) {
      ++older;
    } else if (!fs::exists(folder_ / "out/.fascia.older")) {
      ++saved;
      expect_whole("short", 1);
    }
    ASSERT_EQ(fascia({"run", "short.toml", "--output", "out"}).status, 0);
    expect_only(folder_ / "out", {"summary.json", "probes.csv", "short.pvd", "beam_00000.vtu", "notes.txt"});
  }
  std::printf("%d runs: %d times the older result, %d times new states\n", cases(6), older, saved);
}

/// Good states, and then one that is not finite.
TEST_F(InterruptedRuns, AStateThatIsNotFiniteLosesNoOther) {
  write("crushed.toml", kCrushedCube);
  const ProgramResult result = fascia({"run", "crushed.toml", "--output", "out"});
  EXPECT_EQ(result.status, 3) << result.err;
  expect_whole("crushed", 2);
  EXPECT_EQ(summary("out").at("status"), "diverged");
}

/// A probe without a value ends a run like a field without one, before anything of the state is written.
TEST_F(InterruptedRuns, AProbeThatIsNotFiniteLosesNoOther) {
  write("crushed.toml",
        std::string(kCrushedCube) + kStressProbe + "[output]\nevery_steps = 1\nfields = [\"displacement\"]\n");
  const ProgramResult result = fascia({"run", "crushed.toml", "--output", "out"});
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_NE(result.err.find("probe \"s\": stress is not finite"), std::string::npos) << result.err;
  expect_whole("crushed", 2);
  const std::string rows = read_text(folder_ / "out/probes.csv"), states = read_text(folder_ / "out/crushed.pvd");
  const auto count = [](const std::string& text, const std::string& word) {
    int found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(rows, "\n") - 1, count(states, "<DataSet "));
}

TEST_F(InterruptedRuns, OfExplicitStepsTellWhatThereIs) {
  write("explicit.toml",
        with(kCantilever, "kind = \"static\"", "kind = \"explicit\"\ntime_step = \"1 ms\"\nsteps = 100000000") +
            "[output]\nevery = 1\n");
  const ProgramResult program = stopped({"run", "explicit.toml", "--quiet", "--output", "out"}, SIGINT, 700);
  EXPECT_EQ(program.status, 130) << program.err;
  const nlohmann::json told = summary("out");
  const double time = told["simulated_time"];
  EXPECT_GT(told["steps"], 0);
  EXPECT_NEAR(time, 1e-3 * told["steps"].get<double>(), 1e-9 * time);
  EXPECT_TRUE(fs::exists(folder_ / "out/explicit.pvd"));
}

}  // namespace
}  // namespace fascia::interrupted_runs_test
