#include "tests/robustness/scene_runs.hpp"

#include <map>
#include <set>
#include <string>

namespace fascia::bench_test {

// fascia bench as scripts meet it: the list, wrong names, files, and a small run.
namespace {

using namespace fascia::test;

using Bench = SceneRuns;

TEST_F(Bench, WithoutANameListsTheBenchmarks) {
  const ProgramResult list = fascia({"bench"});
  EXPECT_EQ(list.status, 0);
  for (const char* name : {"table2", "table3", "gpu", "kernels", "scaling"})
    EXPECT_NE(list.out.find(name), std::string::npos) << list.out;
  EXPECT_EQ(list.err, "");
}

TEST_F(Bench, RefusesWhatItDoesNotHave) {
  const std::vector<std::vector<std::string>> wrong = {{"bench", "table4"},
                                                       {"bench", "table2", "extra"},
                                                       {"bench", "table3", "--sizes", "361"},
                                                       {"bench", "table3", "--sizes", "many"},
                                                       {"bench", "table3", "--sizes", "-360"},
                                                       {"bench", "table3", "--settings", "mine"},
                                                       {"bench", "table3", "--repeat", "0"},
                                                       {"bench", "table3", "--threads", "-1"},
                                                       {"bench", "table3", "--max-points", "few"},
                                                       {"bench", "kernels", "--sizes", "361"},
                                                       {"bench", "kernels", "--settings", "paper"},
                                                       {"bench", "kernels", "--backend", "cuda"},
                                                       {"bench", "scaling", "--gpus", "2"},
                                                       {"bench", "scaling", "--repeat", "0"}};
  for (const auto& args : wrong) {
    const ProgramResult result = fascia(args);
    EXPECT_EQ(result.status, 2) << ::testing::PrintToString(args) << "\n" << result.err;
    EXPECT_NE(result.err, "") << ::testing::PrintToString(args);
    EXPECT_EQ(result.out, "") << ::testing::PrintToString(args);
  }
  EXPECT_EQ(fascia({"bench", "table4"}).err,
            "no benchmark is called \"table4\"; must be one of table2, table3, gpu, kernels, scaling\n");
  EXPECT_EQ(fascia({"bench", "kernels", "--gpus", "2"}).err,
            "--gpus: kernels has none, since it times the processor's kernels; leave it out\n");
  EXPECT_TRUE(snapshot().empty());
}

TEST_F(Bench, TimesThePapersSmallBeamsAndWritesItsScenes) {
  const ProgramResult result = fascia({"bench", "table2", "--max-points", "400", "--settings", "paper", "--repeat", "2",
                                       "--json", "--output", "times"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const nlohmann::json j = nlohmann::json::parse(result.out);
  ASSERT_GE(j["rows"].size(), 4u);
  for (const nlohmann::json& row : j["rows"]) {
    EXPECT_EQ(row["points"], 400);
    EXPECT_EQ(row["cg_iterations"], 60);
    EXPECT_GT(row["step_ms"], 0);
    EXPECT_LT(row["residual"], 1);
    EXPECT_GT(row["paper_cpu_ms"], 30);
  }
  EXPECT_EQ(nlohmann::json::parse(read_text(folder_ / "times/table2.json")), j);
  EXPECT_NE(read_text(folder_ / "times/table2.txt").find("table 2"), std::string::npos);
  EXPECT_EQ(lines_of(read_text(folder_ / "times/table2.csv")).size(), j["rows"].size() + 1);

  const ProgramResult again =
      fascia({"run", "times/scenes/table2_72_400_4_paper.toml", "--set", "solver.steps=2", "--output", "again"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(summary("again")["linear_iterations"], 120);
  EXPECT_EQ(summary("again")["bodies"]["beam"]["points"], 400);
}

/// Another way gives the same numbers, and other numbers of threads the same bits.
void expect_right(const nlohmann::json& row) {
  EXPECT_LT(row["error"], 1e-10) << row;
  EXPECT_TRUE(row["bits_equal"].is_null() || row["bits_equal"] == true) << row;
  EXPECT_GT(row["ns"], 0) << row;
  EXPECT_LE(row["ns_low"], row["ns"]) << row;
  EXPECT_GE(row["ns_high"], row["ns"]) << row;
}

TEST_F(Bench, TimesKernelsThatAreRightOnAnyThreads) {
  const ProgramResult result =
      fascia({"bench", "kernels", "--sizes", "1000", "--repeat", "1", "--threads", "2", "--json", "--output", "times"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const nlohmann::json j = nlohmann::json::parse(result.out);
  std::map<std::string, std::set<std::string>> kernels;
  for (const nlohmann::json& row : j["rows"]) {
    expect_right(row);
    EXPECT_TRUE(row["bits_equal"].is_boolean()) << row;
    EXPECT_GT(row["fraction"], 0) << row;
    EXPECT_GT(row["read_bytes"], 0) << row;
    EXPECT_EQ(row["calls"], 1);
    kernels[row["body"]].insert(row["kernel"]);
  }
  EXPECT_EQ(kernels.size(), 6u);
  for (const auto& [body, names] : kernels)
    EXPECT_EQ(names, (std::set<std::string>{"assembled product", "assembly", "axpy", "dot", "forces", "linearisation",
                                            "product"}))
        << body;
  ASSERT_EQ(j["limits"].size(), 2u);
  for (const nlohmann::json& limits : j["limits"]) {
    EXPECT_GT(limits["flops_per_s"], 1e7);
    EXPECT_GT(limits["working_sets"].back()["read_bytes_per_s"], 1e7);
  }
  EXPECT_EQ(nlohmann::json::parse(read_text(folder_ / "times/kernels.json")), j);
  const std::string table = read_text(folder_ / "times/kernels.txt");
  for (const char* column : {"GB/s", "GFLOP/s", "fraction", "error", "bits", "working set", "load before"})
    EXPECT_NE(table.find(column), std::string::npos) << column;
  EXPECT_EQ(lines_of(read_text(folder_ / "times/kernels.csv")).size(), j["rows"].size() + 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "times/scenes/kernels_scattered8_1000.toml"));
}

TEST_F(Bench, ScalingKeepsResultsAndBuildsItsLargerModels) {
  const ProgramResult result =
      fascia({"bench", "scaling", "--sizes", "1000", "--repeat", "1", "--threads", "2", "--json", "--output", "times"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json j = nlohmann::json::parse(result.out);
  int strong = 0, weak = 0, steps = 0;
  for (const nlohmann::json& row : j["rows"]) {
    expect_right(row);
    EXPECT_GT(row["speed_up"], 0) << row;
    if (row["threads"] == 1) {
      EXPECT_EQ(row["efficiency"], 1) << row;
    }
    ++(row["growth"] == "strong" ? strong : weak);
    steps += row["kernel"] == "whole step" || row["kernel"] == "60 CG iterations" ? 1 : 0;
  }
  EXPECT_EQ(strong, 3 * 9 * 2);
  EXPECT_EQ(weak, 2 * 9 * 2);
  EXPECT_EQ(steps, 5 * 2 * 2);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "times/scenes/scaling_weak_grid_2000.toml"));
  EXPECT_NE(read_text(folder_ / "times/scaling.txt").find("efficiency"), std::string::npos);
}

TEST_F(Bench, SaysWhereItCannotWrite) {
  write("taken", "a file");
  const ProgramResult result = fascia({"bench", "table2", "--max-points", "400", "--output", "taken"});
  EXPECT_EQ(result.status, 4) << result.err;
}

}  // namespace

}  // namespace fascia::bench_test
