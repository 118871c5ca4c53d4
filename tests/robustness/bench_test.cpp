#include "tests/robustness/scene_runs.hpp"

namespace fascia::bench_test {

// fascia bench as scripts meet it: the list, wrong names, files, and a small run.
namespace {

using namespace fascia::test;

using Bench = SceneRuns;

TEST_F(Bench, WithoutANameListsTheBenchmarks) {
  const ProgramResult list = fascia({"bench"});
  EXPECT_EQ(list.status, 0);
  for (const char* name : {"table2", "table3", "gpu"}) EXPECT_NE(list.out.find(name), std::string::npos) << list.out;
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
                                                       {"bench", "table3", "--max-points", "few"}};
  for (const auto& args : wrong) {
    const ProgramResult result = fascia(args);
    EXPECT_EQ(result.status, 2) << ::testing::PrintToString(args) << "\n" << result.err;
    EXPECT_NE(result.err, "") << ::testing::PrintToString(args);
    EXPECT_EQ(result.out, "") << ::testing::PrintToString(args);
  }
  EXPECT_EQ(fascia({"bench", "table4"}).err, "no benchmark is called \"table4\"; must be one of table2, table3, gpu\n");
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

TEST_F(Bench, SaysWhereItCannotWrite) {
  write("taken", "a file");
  const ProgramResult result = fascia({"bench", "table2", "--max-points", "400", "--output", "taken"});
  EXPECT_EQ(result.status, 4) << result.err;
}

}  // namespace

}  // namespace fascia::bench_test
