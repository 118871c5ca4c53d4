#include "tests/robustness/scene_runs.hpp"

#include <cmath>

namespace fascia::explain_runs_test {

// fascia explain as scripts meet it: what it measures is what its changes do, what it keeps, and how it ends.
namespace {

using namespace fascia::test;

using Explain = SceneRuns;

/// A soft foot under a stone that is ten thousand times as stiff.
const std::string kScene = R"([world]
gravity = [0, 0, -9.81]
[bodies.foot]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1], cells = [2, 2, 2] } }
density = 1000
material = { law = "neo-hookean", young = "20 kPa", poisson = 0.3 }
[bodies.stone]
model = "tetrahedra"
domain = { box = { min = [0, 0, 0.1], max = [0.1, 0.1, 0.2], cells = [2, 2, 2] } }
density = 2000
material = { young = "200 MPa", poisson = 0.3 }
[[constraints]]
body = "foot"
where = { box = { min = [-1, -1, -1], max = [1, 1, 0.001] } }
fix = "all"
[couplings.glue]
kind = "embed"
body = "foot"
where = { box = { min = [-1, -1, 0.099], max = [1, 1, 1] } }
to = "stone"
[solver]
kind = "static"
threads = 1
[probes.top]
body = "stone"
at = [0.05, 0.05, 0.2]
quantity = "displacement"
[probes.shear]
body = "stone"
at = [0.05, 0.05, 0.15]
quantity = "stress"
)";

double norm(const nlohmann::json& v) {
  double sum = 0;
  for (const nlohmann::json& x : v) sum += x.get<double>() * x.get<double>();
  return std::sqrt(sum);
}

TEST_F(Explain, MeasuresWhatItsChangesDo) {
  write("scene.toml", kScene);
  const ProgramResult result =
      fascia({"explain", "scene.toml", "--repeat", "1", "--json", "--quiet", "--output", "why"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const nlohmann::json j = nlohmann::json::parse(result.out);
  EXPECT_EQ(nlohmann::json::parse(read_text(folder_ / "why/explain.json")), j);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "why/variant"));
  EXPECT_FALSE(j["interrupted"]);

  const nlohmann::json base = summary("why/base");
  EXPECT_EQ(j["base"]["probes"], base["probes"]);
  int unknowns = 0;
  for (const nlohmann::json& body : j["bodies"]) unknowns += body["unknowns"].get<int>();
  EXPECT_EQ(unknowns, base["dofs"]);
  EXPECT_LT(j["bodies"]["stone"]["motion"]["strain"], 1e-3);
  EXPECT_GT(j["bodies"]["foot"]["motion"]["strain"], 1e-2);

  int rigid = 0, refused = 0, measured = 0;
  for (const nlohmann::json& part : j["parts"]) {
    if (part["status"] == "refused") {
      EXPECT_NE(part["reason"], "") << part;
      ++refused;
    }
    if (part["status"] != "converged") continue;
    ++measured;
    EXPECT_GT(part["solve"]["median"], 0) << part;
    if (part["kind"] != "rigid" || part["part"] != "bodies.stone") continue;
    ++rigid;
    EXPECT_TRUE(part["changes"]["shear"].is_null());  // a rigid body has no stress
    // The change comes out alike when it is made by hand.
    std::vector<std::string> run{"run", "scene.toml", "--quiet", "--output", "rigid"};
    for (const nlohmann::json& change : part["set"]) run.insert(run.end(), {"--set", change});
    ASSERT_EQ(fascia(run).status, 0);
    const nlohmann::json before = base["probes"]["top"]["value"], after = summary("rigid")["probes"]["top"]["value"];
    nlohmann::json difference = nlohmann::json::array();
    for (std::size_t i = 0; i < 3; ++i) difference.push_back(after[i].get<double>() - before[i].get<double>());
    EXPECT_DOUBLE_EQ(part["changes"]["top"].get<double>(), norm(difference) / norm(before));
    EXPECT_LT(part["changes"]["top"], 1e-2);
  }
  EXPECT_EQ(rigid, 1);
  EXPECT_GT(refused, 0);  // the stone holds the foot up
  EXPECT_GT(measured, 8);
  for (const nlohmann::json& s : j["suggestions"]) EXPECT_LT(s["largest_change"]["relative"], 1e-2) << s;
}

TEST_F(Explain, QuicklyRunsTheSceneOnceAndSaysWhatIsEstimated) {
  write("scene.toml", kScene);
  const ProgramResult result = fascia({"explain", "scene.toml", "--quick", "--set", "probes.shear="});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* word : {"stage", "set-up", "stone", "~", "estimate"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word << "\n" << result.out;
  EXPECT_NE(result.out.find("`bodies.stone` stays below"), std::string::npos) << result.out;
  EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
  EXPECT_EQ(snapshot().size(), 1u);  // nothing is kept without --output
}

TEST_F(Explain, SaysWhatThereWasNoTimeFor) {
  write("scene.toml", kScene);
  const ProgramResult result = fascia({"explain", "scene.toml", "--repeat", "1", "--time-limit", "1e-3"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* words : {"No time was left within 0.001 s", "bodies.stone as model = \"rigid\"", "suggestions"})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
}

TEST_F(Explain, WithoutProbesComparesMeanDisplacements) {
  write("scene.toml", kScene.substr(0, kScene.find("[probes.top]")));
  const ProgramResult result = fascia({"explain", "scene.toml", "--quick", "--json", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json j = nlohmann::json::parse(result.out);
  EXPECT_TRUE(j["base"]["probes"].contains("explain_foot")) << j["base"]["probes"];
  EXPECT_NE(j["notes"][0].get<std::string>().find("no probes"), std::string::npos);
}

TEST_F(Explain, KeepsWhatItKnowsWhereItIsInterrupted) {
  write("scene.toml", kScene);
  ProgramOptions options;
  options.signal = SIGINT;
  options.signal_after = std::chrono::milliseconds(1500);
  const ProgramResult result =
      fascia({"explain", "scene.toml", "--repeat", "999", "--json", "--quiet", "--output", "why"}, options);
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "why/variant"));
  EXPECT_TRUE(nlohmann::json::parse(read_text(folder_ / "why/explain.json"))["interrupted"]);
}

TEST_F(Explain, RefusesWhatItCannotExplain) {
  write("scene.toml", kScene);
  write("notes/letter.txt", "Dear Sir");
  const ProgramResult taken = fascia({"explain", "scene.toml", "--output", "notes"});
  EXPECT_EQ(taken.status, 4);
  EXPECT_NE(taken.err.find("holds something else than an explanation"), std::string::npos) << taken.err;
  EXPECT_EQ(fascia({"explain", "none.toml"}).status, 4);
  EXPECT_EQ(fascia({"explain", "scene.toml", "--set", "bodies.foot.modle=1"}).status, 2);
  EXPECT_EQ(fascia({"explain", "scene.toml", "--repeat", "0"}).status, 2);
  const ProgramResult fails = fascia({"explain", "scene.toml", "--quiet", "--set", "solver.newton.max_iterations=1",
                                      "--set", "world.gravity=[0, 0, -1000]"});
  EXPECT_EQ(fails.status, 3) << fails.err;
  EXPECT_NE(fails.err.find("nothing can be compared with it"), std::string::npos) << fails.err;
}

}  // namespace
}  // namespace fascia::explain_runs_test
