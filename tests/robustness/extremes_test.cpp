#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <utility>

namespace fascia::extremes_program_test {
namespace {

using namespace fascia::test;

class ExtremesProgram : public testing::Test {
 protected:
  ProgramResult extremes(std::vector<std::string> words, std::vector<std::string> environment = {}) const {
    words.insert(words.begin(), {program(), "extremes", "--quiet", "--output", "out"});
    ProgramOptions options;
    options.environment = std::move(environment);
    options.directory = folder_.path;
    options.timeout = std::chrono::minutes(3);  // hundreds of runs, beside what else the machine does
    return run_program(words, options);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path / name) << text; }
  std::string file(const std::string& name) const {
    std::ifstream in(folder_.path / "out" / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  TemporaryFolder folder_;
};

/// Right cells stay right, and those refused or stopped are not called converged: the quick cells of the stored
/// map at the ends of its axes, and slower ones of scattered frames, whose weights are their own.
TEST_F(ExtremesProgram, TheReducedMapIsNoWorseThanTheStoredOne) {
  const std::string stored = (source_dir() / "docs/extremes.csv").string();
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--quicker-than", "0.075"},
                                               {"--only", "scattered, static", "--quicker-than", "0.5"}}) {
    std::vector<std::string> words{"--reduced", "--compare", stored};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult r = extremes(words);
    EXPECT_EQ(r.status, 0) << r.out << r.err;
    EXPECT_EQ(r.out.find("worse: "), std::string::npos) << r.out;
  }
}

/// The steps of a GPU are taken in the space of the host: no cell is worse than on the processor.
TEST_F(ExtremesProgram, TheStepsOfAGpuAreNoWorseThanTheStoredMap) {
  const std::string stored = (source_dir() / "docs/extremes.csv").string();
  const std::string module = (build_dir() / "fascia-host.so").string();
  const ProgramResult r =
      extremes({"--backend", "cuda", "--reduced", "--only", ", cg", "--compare", stored, "--quicker-than", "0.053"},
               {"FASCIA_DEVICE_MODULE=" + module});
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  EXPECT_EQ(r.out.find("worse: "), std::string::npos) << r.out;
  EXPECT_EQ(file("extremes.json").find("\"backend\": \"cpu\""), std::string::npos);
}

TEST_F(ExtremesProgram, WritesATableAndAPageThatSayHowToRepeatACell) {
  const ProgramResult r = extremes({"--only", "line, static, cg,pull"});
  ASSERT_EQ(r.status, 0) << r.out << r.err;
  EXPECT_NE(file("extremes.csv").find("\"line, static, cg\",pull,1e-09 E A,right,converged"), std::string::npos)
      << file("extremes.csv");
  const std::string page = file("extremes.html");
  EXPECT_NE(page.find("fascia run out/cells/line-static-cg-pull-1e-09-e-a.toml"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder_.path / "out/cells/line-static-cg-pull-1e-09-e-a.toml"));
}

/// What had ended stands in the table, and is not run again.
TEST_F(ExtremesProgram, GoesOnWhereItWasInterrupted) {
  const std::vector<std::string> cells{"--only", "tetrahedra, static,Young", "--pairs", "0"};
  std::vector<std::string> words{program(), "extremes", "--quiet", "--output", "out", "--jobs", "1"};
  words.insert(words.end(), cells.begin(), cells.end());
  ProgramOptions options;
  options.directory = folder_.path;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(1000);
  const ProgramResult stopped = run_program(words, options);
  ASSERT_EQ(stopped.status, 130) << stopped.out << stopped.err;
  EXPECT_NE(stopped.err.find("--resume goes on"), std::string::npos) << stopped.err;
  const std::string begun = file("extremes.csv");
  ASSERT_GT(std::count(begun.begin(), begun.end(), '\n'), 1) << begun;
  words = cells;
  words.insert(words.end(), {"--resume", "--time-limit", "7"});
  const ProgramResult other = extremes(words);
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("time_limit = 60.0, and now it is 7.0"), std::string::npos) << other.err;
  words.resize(words.size() - 2);
  const ProgramResult rest = extremes(words);
  EXPECT_EQ(rest.status, 0) << rest.out << rest.err;
  const std::string whole = file("extremes.csv");
  EXPECT_GT(whole.size(), begun.size());
  std::istringstream rows(begun);
  for (std::string row; std::getline(rows, row);) EXPECT_NE(whole.find(row), std::string::npos) << row;
}

TEST_F(ExtremesProgram, SweepsAScene) {
  write("s.toml",
        "materials.m = { young = \"10 kPa\", poisson = 0.3 }\n"
        "bodies.b = { model = \"hexahedra\", density = 1000, material = \"m\", domain = { box = { min = [0, 0, "
        "0], max = [\"10 cm\", 0.02, 0.02], cells = [3, 1, 1] } } }\n"
        "constraints = [{ body = \"b\", where = { box = { min = [-1, -1, -1], max = [0.001, 1, 1] } }, fix = "
        "\"all\" }]\n"
        "loads = [{ body = \"b\", where = { box = { min = [0.099, -1, -1], max = [1, 1, 1] } }, total_force = "
        "[0, 0, \"-1 mN\"] }]\n"
        "probes.tip = { body = \"b\", at = [0.1, 0.01, 0.01], quantity = \"displacement\" }\n");
  const ProgramResult r = extremes({"s.toml", "--set", "bodies.b.density=900"});
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  for (const char* cell : {"s,base,1,right", "s,stiffness,x 1e-06,", "s,Poisson's ratio,0.4999,",
                           "s,size,x 10000,right", "s,loads,x 1e-09,right"})
    EXPECT_NE(file("extremes.csv").find(cell), std::string::npos) << cell << "\n" << file("extremes.csv");
}

TEST_F(ExtremesProgram, RefusesWhatItCannotDo) {
  const auto refusal = [&](const std::vector<std::string>& words, const std::string& why) {
    const ProgramResult r = extremes(words);
    EXPECT_EQ(r.status, 2) << why;
    EXPECT_NE(r.err.find(why), std::string::npos) << r.err;
  };
  refusal({"--only", "nonsense"}, "no cell's name holds all words");
  refusal({"--set", "a=1"}, "--set changes a scene");
  refusal({"--pairs", "1000000000"}, "give that at most");
  refusal({"--quicker-than", "1"}, "add --compare");
  refusal({"--resume"}, "holds no map");
  write("none.toml", "bodies.b = { model = \"line\" }\n");
  refusal({"none.toml"}, "none.toml:1");
  write("mute.toml",
        "bodies.b = { model = \"rigid\", density = 1, domain = { box = { min = [0, 0, 0], max = [1, 1, 1] } } }\n");
  refusal({"mute.toml"}, "has no probe");
  refusal({"mute.toml", "--reduced"}, "leave it out, or the scene");
  std::filesystem::create_directory(folder_.path / "out");
  write("out/mine.txt", "x");
  EXPECT_EQ(extremes({"--only", "line, static,pull"}).status, 4);
}

}  // namespace
}  // namespace fascia::extremes_program_test
