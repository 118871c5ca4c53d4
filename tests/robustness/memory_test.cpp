#include "tests/robustness/scene_runs.hpp"
#include "tests/support/cases.hpp"

#include <fmt/format.h>

#include <regex>

namespace fascia::memory_test {

// Memory as scripts meet it: what `fascia check` says is what a run takes, limits end a run with a message, and steps
// leave nothing behind.
namespace {

using namespace fascia::test;

constexpr const char* kCube = R"([world]
gravity = [0, -1, 0]

[bodies.cube]
model = "{}"
{}
density = 1000
material = {{ young = "1 MPa", poisson = 0.3 }}

[[constraints]]
body = "cube"
where = {{ box = {{ min = [-1e-3, -9, -9], max = [1e-3, 9, 9] }} }}
fix = "all"

[solver]
threads = {}
backend = "cpu"
{}
)";

constexpr const char* kStatic = "kind = \"static\"";
constexpr const char* kStaticCg = "kind = \"static\"\nlinear = { kind = \"cg\" }";
constexpr const char* kImplicit = "kind = \"newmark\"\ntime_step = \"1 ms\"\nduration = \"2 ms\"";
constexpr const char* kExplicit = "kind = \"explicit\"\ntime_step = \"auto\"\nduration = \"0.5 ms\"";
constexpr const char* kModes = "kind = \"modes\"\ncount = 10";

std::string box(const std::string& more) {
  return "domain = { box = { min = [0, 0, 0], max = [1, 1, 1]" + more + " } }";
}
std::string cells(int n, int order) {
  return box(fmt::format(", cells = [{0}, {0}, {0}]", n)) + fmt::format("\norder = {}", order);
}
std::string grid(int n) { return box("") + fmt::format("\nframes = {{ grid = [{0}, {0}, {0}] }}", n); }

class Memory : public SceneRuns {
 protected:
  void expect_told(const std::string& model, const std::string& body, const std::string& solver,
                   int threads = 1) const {
    constexpr double part = 0.2;
    write("scene.toml", fmt::format(kCube, model, body, threads, solver));
    const ProgramResult check = fascia({"check", "scene.toml"});
    ASSERT_EQ(check.status, 0) << check.err;
    std::smatch found;
    ASSERT_TRUE(std::regex_search(check.out, found, std::regex("memory: about ([0-9.e+]+) MB"))) << check.out;
    const double said = std::stod(found[1]);
    const ProgramResult run = fascia({"run", "scene.toml", "--json", "--output", "out"});
    ASSERT_EQ(run.status, 0) << run.err;
    const double used = nlohmann::json::parse(run.out).at("peak_memory_bytes").get<double>() / 1e6;
    EXPECT_NEAR(said, used, part * used) << model << ", " << solver;
  }
};

TEST_F(Memory, OfSmallRunsIsAsCheckSays) {
  expect_told("meshless", grid(4), kStatic);
  expect_told("hexahedra", cells(2, 2), kStatic, 2);
  expect_told("meshless", box("") + "\nframes = { count = 60, seed = 1 }\npoints = { count = 600 }", kStatic);
  expect_told("tetrahedra", cells(6, 1), kExplicit);
  expect_told("hexahedra", cells(4, 1), kModes);
}

TEST_F(Memory, OfMediumRunsIsAsCheckSays) {
  expect_told("hexahedra", cells(7, 2), "linear = { kind = \"cholesky\" }");
  expect_told("meshless", grid(8), kImplicit, 2);
  expect_told("tetrahedra", cells(14, 1), kStaticCg);
}

TEST_F(Memory, OfLargeRunsIsAsCheckSays) {
  if (!full_size()) GTEST_SKIP() << "in full size only";
  expect_told("hexahedra", cells(16, 2), "linear = { kind = \"cholesky\" }", 2);
  expect_told("meshless", grid(14), "linear = { kind = \"cholesky\" }");
  expect_told("meshless", grid(22), kStaticCg, 2);
  expect_told("tetrahedra", cells(40, 1), kExplicit);
}

TEST_F(Memory, OfLimitedProcessesRunsOutWithAMessage) {
  write("scene.toml", fmt::format(kCube, "tetrahedra", cells(10, 2), 1, kStatic));
  for (const int megabytes : {45, 90, 120, 150, 200, 230, 260, 300}) {
    for (const std::string command : {"check", "run"}) {
      ProgramOptions options;
      options.directory = folder_;
      const std::string line = fmt::format("ulimit -v {}; exec \"$0\" {} scene.toml", megabytes * 1000, command);
      const ProgramResult result = run_program({"sh", "-c", line, program()}, options);
      EXPECT_FALSE(result.timed_out) << line;
      if (result.status == 0 || result.status == 127) continue;  // enough, or too little to load libraries
      EXPECT_EQ(result.status, 2) << line << ": " << result.err;
      EXPECT_FALSE(result.err.empty()) << line;
    }
  }
}

/// The peak of a run with --json [bytes].
double peak_of(const ProgramResult& run) {
  EXPECT_EQ(run.status, 0) << run.err;
  return run.status == 0 ? nlohmann::json::parse(run.out).at("peak_memory_bytes").get<double>() : 0;
}

TEST_F(Memory, DoesNotGrowWithSteps) {
  const auto peak = [&](int steps) {
    const std::string solver = fmt::format(
        "kind = \"explicit\"\ntime_step = \"1 us\"\nduration = \"{0} us\"\n[output]\nevery = \"{0} us\"", steps);
    write("scene.toml", fmt::format(kCube, "hexahedra", cells(1, 1), 1, solver));
    return peak_of(fascia({"run", "scene.toml", "--json", "--output", "out"}));
  };
  const double few = peak(200), many = peak(60000);
  EXPECT_LT(many, few + 1.5e6);
}

}  // namespace
}  // namespace fascia::memory_test
