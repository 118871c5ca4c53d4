// Errors that are estimated without a reference, as users ask for them.
#include "tests/robustness/scene_runs.hpp"

#include <csignal>

namespace fascia::estimate_runs_test {
namespace {

using namespace fascia::test;
namespace fs = std::filesystem;

class EstimateRuns : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    write("beam.toml", with(kCantilever, "grid = [3, 2, 2]", "grid = [9, 3, 3]"));
  }
  nlohmann::json estimated(const std::vector<std::string>& more) const {
    std::vector<std::string> args{"run", "beam.toml", "--output", "out", "--estimate", "--quiet"};
    args.insert(args.end(), more.begin(), more.end());
    const ProgramResult result = fascia(args);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "out/.fascia.twins"));
    return summary("out");
  }
};

TEST_F(EstimateRuns, SayWhatTheyFoundAndChangeNothing) {
  const ProgramResult plain = fascia({"run", "beam.toml", "--output", "plain"});
  const ProgramResult result = fascia({"run", "beam.toml", "--output", "out", "--estimate"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json j = summary("out"), error = j.at("estimated_error").at("tip");
  EXPECT_EQ(j.at("probes"), summary("plain").at("probes"));
  EXPECT_FALSE(summary("plain").contains("estimated_error"));
  // The tip of 5 x 2 x 2, 9 x 3 x 3 and 17 x 5 x 5 frames, and what they tend to.
  EXPECT_GT(error.at("total"), 0.01);
  EXPECT_LT(error.at("total"), 0.2);
  EXPECT_EQ(error.at("time"), 0);
  EXPECT_TRUE(error.at("order_measured").get<bool>());
  EXPECT_EQ(error.at("method"), "finer");
  EXPECT_EQ(result.out.find("by coarser twins alone"), std::string::npos);
  EXPECT_EQ(j.at("estimated_error").at("weight").at("total"), 0) << "a mass is exact";
  EXPECT_GT(j.at("estimated_error").at("bodies").at("beam").at("discretisation"), 0.01);
  EXPECT_GE(j.at("estimate").at("runs").size(), 2u);
  EXPECT_NE(result.out.find("estimated error of tip: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("estimated error of the displacement of \"beam\": "), std::string::npos);
  const ProgramResult check = fascia({"check", "beam.toml", "--estimate"});
  EXPECT_NE(check.out.find("estimate: 3 more runs, about "), std::string::npos) << check.out;
  EXPECT_NE(check.out.find("by a finer twin: \"beam\" has 17 x 5 x 5 frames in the place of 9 x 3 x 3"),
            std::string::npos);
}

TEST_F(EstimateRuns, SayThatCoarserTwinsAreLessCertain) {
  const ProgramResult result = fascia({"run", "beam.toml", "--output", "out", "--set", "output.estimate=\"coarser\""});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(summary("out").at("estimated_error").at("tip").at("method"), "coarser");
  EXPECT_NE(result.out.find("estimate: by coarser twins alone"), std::string::npos) << result.out;
}

TEST_F(EstimateRuns, SplitErrorsOfDynamicsIntoTheirParts) {
  const nlohmann::json j =
      estimated({"--set", "solver={ kind = \"implicit-euler\", time_step = 0.02, duration = 0.2 }"});
  const nlohmann::json tip = j.at("estimated_error").at("tip");
  EXPECT_GT(tip.at("time"), 1e-3);
  EXPECT_GT(tip.at("discretisation"), 1e-3);
  EXPECT_LT(tip.at("solver"), 1e-4);
  const double sum =
      tip.at("time").get<double>() + tip.at("discretisation").get<double>() + tip.at("solver").get<double>();
  EXPECT_NEAR(tip.at("total"), sum, 1e-15);
}

TEST_F(EstimateRuns, OfModes) {
  const nlohmann::json j = estimated({"--set", "solver={ kind = \"modes\", count = 3 }", "--set",
                                      "probes.tip=", "--set", "probes.f={ quantity = \"frequency\" }"});
  EXPECT_GT(j.at("estimated_error").at("f").at("total"), 1e-3);
  EXPECT_FALSE(j.at("estimated_error").contains("bodies"));
}

TEST_F(EstimateRuns, SayWhyThereIsNoNumber) {
  const nlohmann::json listed =
      estimated({"--set", "bodies.beam.points={ count = 200 }", "--set",
                 "bodies.beam.frames={ positions = [[0,0,0], [0,0.2,0], [0,0,0.2], [0,0.2,0.2], "
                 "[1,0,0], [1,0.2,0], [1,0,0.2], [1,0.2,0.2]] }"});
  EXPECT_TRUE(listed.at("estimated_error").at("tip").at("total").is_null());
  EXPECT_NE(listed.at("estimate").at("how").dump().find("its frames are listed in the scene"), std::string::npos);
  // Between 0.2 and 0.3 there is a plane of frames, which the coarser twin lacks.
  const nlohmann::json lost = estimated({"--set",
                                         "loads=[{ body = \"beam\", where = { box = { min = [0.2, -1, -1], max = [0.3, "
                                         "1, 1] } }, total_force = [0, -1, 0] }]",
                                         "--set", "bodies.beam.frames.grid=[5, 3, 3]"});
  EXPECT_NE(lost.at("estimate").at("how").dump().find("the coarser twin gives nothing"), std::string::npos)
      << lost.at("estimate").dump(1);
  EXPECT_FALSE(lost.at("estimated_error").at("tip").at("order_measured").get<bool>());
}

TEST_F(EstimateRuns, RefuseWhatMakesNoSense) {
  const std::string still = with(kCantilever, "[world]\ngravity = [0, -1, 0]\n", "");
  const std::string modes = with(still, "kind = \"static\"", "kind = \"modes\"");
  expect_refused(modes.substr(0, modes.find("[probes.tip]")) + "[output]\nestimate = true\n",
                 {"output.estimate: there is nothing to estimate", "\"frequency\""});
  expect_refused(std::string(kCantilever) + "[output]\nestimate = \"fast\"\n", {"output.estimate: ", "\"finer\""});
  expect_refused(std::string(kCantilever) + "[probes.bodies]\nquantity = \"volume\"\n[output]\nestimate = true\n",
                 {"probes.bodies: ", "another name"});
}

TEST_F(EstimateRuns, StopAtASignal) {
  ProgramOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(700);
  const ProgramResult result =
      fascia({"run", "beam.toml", "--output", "out", "--set", "output.estimate=finer", "--set",
              "bodies.beam.frames.grid=[21, 6, 6]", "--set",
              "solver={ kind = \"implicit-euler\", time_step = 0.01, duration = 0.02 }", "--set", "solver.threads=1"},
             options);
  EXPECT_EQ(result.status, 130) << result.out << result.err;
  EXPECT_NE(result.err.find("interrupted before its errors were estimated"), std::string::npos) << result.err;
  EXPECT_EQ(summary("out").at("status"), "converged");
  EXPECT_FALSE(summary("out").contains("estimated_error"));
  EXPECT_FALSE(fs::exists(folder_ / "out/.fascia.twins"));
}

}  // namespace
}  // namespace fascia::estimate_runs_test
