#include "app/bench/benchmark.hpp"
#include "app/bench/report.hpp"
#include "app/reader/parse.hpp"
#include "core/base/errors.hpp"
#include "tests/support/cases.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <sstream>

// fascia bench: the cases, which of them are timed, and the three forms of the result.
namespace fascia::app::bench_test {
namespace {

Scene parsed(const BenchmarkCase& c) { return parse_scene_text(c.scene, c.name + ".toml", {}); }

std::vector<BenchmarkCase> of_setting(const Benchmark& b, const std::string& setting) {
  std::vector<BenchmarkCase> cases;
  for (const BenchmarkCase& c : b.cases)
    if (c.setting == setting) cases.push_back(c);
  return cases;
}

/// A backend that takes `ms` for each step and remembers what it was asked.
BenchBackend pretended(std::string name, int threads, double ms, std::vector<StepPlan>* asked = nullptr) {
  return {std::move(name), threads, [=](const Simulation&, const StepPlan& plan) {
            if (asked) asked->push_back(plan);
            return StepTimes{{3 * ms, ms, 2 * ms}, {ms, ms / 2, ms / 4}, 60, 1e-3, ""};
          }};
}

Benchmark small_benchmark() {
  Benchmark b{"small", "A small one", "Notes.", 1000, {}};
  for (const BenchmarkCase& c : table2().cases)
    if (c.size == 400 && c.setting == "paper" && b.cases.size() < 2) b.cases.push_back(c);
  return b;
}

Measurement row(const std::string& name, const std::string& backend, int threads, double ms) {
  Measurement m;
  m.name = name;
  m.body = "grid beam";
  m.setting = "paper";
  m.points = 400;
  m.frames = 72;
  m.neighbours = 4;
  m.backend = backend;
  m.threads = threads;
  m.steps = 5;
  m.step_ms = ms;
  m.cg_ms = ms / 2;
  m.cg_iterations = 60;
  m.residual = 0.0125;
  return m;
}

BenchmarkResult result_of_two_backends() {
  BenchmarkResult r{"small", "A small one", "Notes.", {}, {{"large", "larger than 9"}, {"huge", "larger than 9"}}};
  r.rows = {row("a", "cpu", 1, 8), row("a", "cpu", 2, 5), row("b", "cpu", 1, 3), row("b", "cpu", 2, 7)};
  r.rows[0].published_cpu = 32.65;
  return r;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(BenchCases, HaveNamesOfTheirOwnAndSoundScenesOfFixedWork) {
  std::set<std::string> names;
  std::size_t number = 0;
  for (const Benchmark& b : all_benchmarks()) {
    ASSERT_LT(number, kBenchmarkNames.size());
    EXPECT_EQ(b.name, kBenchmarkNames[number++]) << "completed in the shell";
    EXPECT_TRUE(names.insert(b.name).second);
    for (const BenchmarkCase& c : b.cases) {
      EXPECT_TRUE(names.insert(c.name).second) << c.name;
      const Scene scene = parsed(c);
      EXPECT_EQ(scene.solver.kind, SolverKind::implicit_euler) << c.name;
      EXPECT_EQ(scene.solver.linear, LinearMethod::cg) << c.name;
      EXPECT_EQ(scene.solver.linear_max_iterations, 60) << c.name;
      EXPECT_EQ(scene.solver.newton_max_iterations, 1) << c.name;
      EXPECT_EQ(scene.solver.on_limit, OnLimit::proceed) << c.name;
    }
  }
}

TEST(BenchCases, ThePaperSettingIsItsRuleWithPlainConjugateGradients) {
  for (const Benchmark& b : {table2(), table3()})
    for (const BenchmarkCase& c : of_setting(b, "paper")) {
      const Scene scene = parsed(c);
      EXPECT_EQ(scene.bodies[0].drilling, 0.0) << c.name;
      EXPECT_EQ(scene.bodies[0].blend, Blend::full) << c.name;
      EXPECT_EQ(scene.solver.preconditioner, PreconditionerKind::none) << c.name;
    }
}

TEST(BenchCases, TableThreeIsThePaperThenGridsUpToTenMillionPoints) {
  const std::array<double, 9> points{360, 800, 2600, 6070, 12700, 16210, 19990, 26750, 34610};
  for (const char* setting : {"paper", "default"}) {
    const std::vector<BenchmarkCase> cases = of_setting(table3(), setting);
    ASSERT_EQ(cases.size(), 12u);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(cases[i].size, points[i]);
    EXPECT_EQ(cases[0].published_cpu, 34.84);
    EXPECT_EQ(cases[8].published_gpu, 66.1);
    for (std::size_t i = 9; i < 12; ++i) {
      const Scene scene = parsed(cases[i]);
      const std::vector<int>& grid = std::get<GridFrames>(scene.bodies[0].frames).count;
      EXPECT_EQ(cases[i].size, 24 * (grid[0] - 1) * (grid[1] - 1) * (grid[2] - 1));
      EXPECT_FALSE(cases[i].published_cpu.has_value());
    }
    EXPECT_NEAR(cases[9].size, 1e5, 1e3);
    EXPECT_NEAR(cases[10].size, 1e6, 1e4);
    EXPECT_NEAR(cases[11].size, 1e7, 1e5);
  }
}

TEST(BenchCases, TheSmallOnesHaveExactlyThePapersNumbers) {
  std::vector<BenchmarkCase> cases = of_setting(table2(), "paper");
  for (const BenchmarkCase& c : of_setting(table3(), "paper"))
    if (c.size <= (fascia::test::full_size() ? 2600 : 1000)) cases.push_back(c);
  for (const BenchmarkCase& c : cases) {
    const Benchmark one{"one", "", "", 10000, {c}};
    const BenchmarkResult result = time_benchmark(one, {}, {pretended("cpu", 1, 1)}, [](const std::string&) {});
    if (c.name.starts_with("table2_792_")) {  // 750 points in 792 frames, some of which no point needs
      ASSERT_EQ(result.skipped.size(), 1u);
      EXPECT_EQ(result.skipped[0].reason.rfind("750 integration points cannot hold", 0), 0u);
      continue;
    }
    ASSERT_EQ(result.rows.size(), 1u) << c.name;
    const Measurement& m = result.rows[0];
    int frames = m.points / 5, points = c.size, neighbours = 4;
    if (c.name.starts_with("table2")) {
      ASSERT_EQ(std::sscanf(c.name.c_str(), "table2_%d_%d_%d", &frames, &points, &neighbours), 3);
    }
    EXPECT_EQ(m.points, points) << c.name;
    EXPECT_EQ(m.frames, frames) << c.name;
    EXPECT_EQ(m.neighbours, neighbours) << c.name;
  }
}

TEST(BenchChoice, FollowsSizesSettingsAndLimit) {
  const Benchmark b = table3();
  std::vector<SkippedCase> skipped;
  BenchOptions options;
  options.settings = "paper";
  EXPECT_EQ(chosen_cases(b, options, skipped).size(), 7u);
  EXPECT_EQ(skipped.size(), 5u);

  options.sizes = {360, 34610};
  skipped.clear();
  EXPECT_EQ(chosen_cases(b, options, skipped).size(), 2u);
  EXPECT_TRUE(skipped.empty());

  options.max_points = 1000;
  const auto chosen = chosen_cases(b, options, skipped);
  ASSERT_EQ(chosen.size(), 1u);
  EXPECT_EQ(chosen[0].name, "table3_360_paper");
  ASSERT_EQ(skipped.size(), 1u);
  EXPECT_EQ(skipped[0].name, "table3_34610_paper");

  options.sizes = {361};
  try {
    chosen_cases(b, options, skipped);
    FAIL() << "361 is no size of table 3";
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()).rfind("--sizes: 361 is no size of table3; must be of 360, 800, ", 0), 0u)
        << e.what();
  }
}

TEST(BenchTimes, AreMediansAndEveryBackendTakesEveryCase) {
  std::vector<StepPlan> asked;
  BenchOptions options;
  options.repeat = 7;
  const BenchmarkResult r =
      time_benchmark(small_benchmark(), options, {pretended("cpu", 1, 4, &asked), pretended("cuda", 0, 1, &asked)},
                     [](const std::string&) {});
  ASSERT_EQ(r.rows.size(), 4u);
  ASSERT_EQ(asked.size(), 4u);
  EXPECT_EQ(asked[0].fewest, 7);
  EXPECT_EQ(asked[0].most, 7);
  EXPECT_EQ(r.rows[0].step_ms, 8);
  EXPECT_EQ(r.rows[0].step_max_ms, 12);
  EXPECT_EQ(r.rows[0].cg_ms, 2);
  EXPECT_EQ(r.rows[0].steps, 3);
  EXPECT_EQ(r.rows[1].name, r.rows[0].name);
  EXPECT_EQ(r.rows[1].backend, "cuda");
}

TEST(BenchTimes, WhatDoesNotFitIsSaidAndNotTried) {
  Benchmark b = small_benchmark();
  b.cases.resize(1);
  std::string& scene = b.cases[0].scene;
  const std::size_t frames = scene.find("frames = {");
  scene.replace(frames, scene.find("weights") - frames,
                "frames = { grid = [1000, 100, 99] }\npoints = { per_cell = [10, 10, 10] }\n");
  const std::size_t weights = scene.find("weights");
  scene.erase(weights, scene.find('\n', weights) - weights);
  const BenchmarkResult r = time_benchmark(b, {}, {pretended("cpu", 1, 1)}, [](const std::string&) {});
  EXPECT_TRUE(r.rows.empty());
  ASSERT_EQ(r.skipped.size(), 1u);
  EXPECT_EQ(r.skipped[0].reason.rfind("it needs about ", 0), 0u) << r.skipped[0].reason;
}

TEST(BenchBackends, OneThreadThenAsManyAsAskedFor) {
  const std::vector<BenchBackend> backends = available_backends(3);
  ASSERT_GE(backends.size(), 2u);
  EXPECT_EQ(backends[0].label(), "cpu, 1 thread");
  EXPECT_EQ(backends[1].label(), "cpu, 3 threads");
  EXPECT_EQ(available_backends(1).front().label(), "cpu, 1 thread");
}

TEST(BenchBackends, TheProcessorTakesSixtyIterationsAStepAndTellsWhatIsLeft) {
  BenchOptions options;
  options.repeat = 2;
  const BenchmarkResult r =
      time_benchmark(small_benchmark(), options, available_backends(2), [](const std::string&) {});
  ASSERT_EQ(r.rows.size() % 4, 0u);
  for (const Measurement& m : r.rows) {
    EXPECT_EQ(m.steps, 2);
    EXPECT_EQ(m.cg_iterations, 60);
    EXPECT_GT(m.step_ms, m.cg_ms);
    EXPECT_GT(m.cg_ms, 0);
    EXPECT_GT(m.residual, 1e-6);
    EXPECT_LT(m.residual, 1);
  }
  EXPECT_EQ(r.rows[0].residual, r.rows[1].residual) << "one thread and two solve the same";
}

TEST(BenchReport, TheTableShowsBackendsSideBySideAndWhichIsFastest) {
  const std::vector<std::string> lines = lines_of(result_table(result_of_two_backends(), this_machine()));
  ASSERT_GT(lines.size(), 8u);
  EXPECT_EQ(lines[0], "A small one");
  EXPECT_NE(lines[2].find("cpu, 1 thread"), std::string::npos);
  EXPECT_NE(lines[2].find("cpu, 2 threads"), std::string::npos);
  EXPECT_EQ(lines[4].size(), lines[5].size()) << "columns are aligned";
  EXPECT_NE(lines[4].find("32.6"), std::string::npos) << lines[4];
  EXPECT_TRUE(lines[4].ends_with("cpu, 2 threads")) << lines[4];
  EXPECT_TRUE(lines[5].ends_with("cpu, 1 thread")) << lines[5];
  EXPECT_NE(std::find(lines.begin(), lines.end(), "not timed, larger than 9: large huge"), lines.end());
}

TEST(BenchReport, TheCsvHasALineForEachMeasurement) {
  const std::vector<std::string> lines = lines_of(result_csv(result_of_two_backends()));
  ASSERT_EQ(lines.size(), 5u);
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  EXPECT_EQ(lines[1], "a,grid beam,paper,400,72,4,0,cpu,1,5,8,0,0,4,60,0.0125,32.65,,0");
  EXPECT_EQ(commas(lines[0]), commas(lines[1]));
}

TEST(BenchReport, TheJsonHasTheMachineAndNullForWhatIsNoNumber) {
  BenchmarkResult r = result_of_two_backends();
  r.rows[1].residual = std::numeric_limits<double>::quiet_NaN();
  const nlohmann::ordered_json j = nlohmann::ordered_json::parse(result_json(r, this_machine()).dump());
  EXPECT_EQ(j["benchmark"], "small");
  ASSERT_EQ(j["rows"].size(), 4u);
  EXPECT_EQ(j["rows"][0]["step_ms"], 8);
  EXPECT_EQ(j["rows"][0]["paper_cpu_ms"], 32.65);
  EXPECT_TRUE(j["rows"][0]["paper_gpu_ms"].is_null());
  EXPECT_TRUE(j["rows"][1]["residual"].is_null());
  EXPECT_EQ(j["skipped"][0]["case"], "large");
  EXPECT_GT(j["machine"]["threads"], 0);
  EXPECT_GT(j["machine"]["memory_bytes"], 1e8);
  EXPECT_EQ(j["build"]["fascia"], FASCIA_VERSION);
  EXPECT_TRUE(j["build"]["libraries"].contains("Eigen"));
  EXPECT_EQ(j["date"].get<std::string>().size(), 20u);
}

}  // namespace
}  // namespace fascia::app::bench_test
