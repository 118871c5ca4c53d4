// Results say where they come from: `fascia rerun` repeats one, `fascia compare` tells two apart.
#include "tests/robustness/scene_runs.hpp"

#include <nlohmann/json.hpp>

namespace fascia::test::provenance_test {
namespace {

class Provenance : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    write("beam.toml", kCantilever);
    ASSERT_EQ(fascia({"run", "beam.toml", "--output", "a", "--quiet"}).status, 0);
  }
  void run(const std::string& output, const std::string& setting) const {
    ASSERT_EQ(fascia({"run", "beam.toml", "--output", output, "--quiet", "--set", setting}).status, 0);
  }
  void expect_status(const std::vector<std::string>& command, int status, const std::string& says) const {
    const ProgramResult result = fascia(command);
    EXPECT_EQ(result.status, status) << result.out << result.err;
    EXPECT_NE((result.out + result.err).find(says), std::string::npos) << result.out << result.err;
  }
};

TEST_F(Provenance, HoldsWhatMadeTheResult) {
  run("b", "bodies.beam.density=1100");
  const auto then = summary("b").at("provenance");
  EXPECT_EQ(then.at("scene"), kCantilever);
  EXPECT_EQ(then.at("scene_sha256").get<std::string>().size(), 64u);
  EXPECT_EQ(then.at("overrides"), nlohmann::json({"bodies.beam.density=1100"}));
  EXPECT_EQ(then.at("scene_file"), std::filesystem::canonical(folder_ / "beam.toml").string());
  for (const char* key : {"command", "started", "units", "program", "machine", "files"})
    EXPECT_TRUE(then.contains(key)) << key;
  EXPECT_NE(read_text(folder_ / "b/beam_00000.vtu").find("provenance"), std::string::npos);
}

TEST_F(Provenance, RerunRepeatsWhatTheResultSays) {
  run("b", "bodies.beam.density=1100");
  expect_status({"rerun", "b"}, 0, "equal in every digit");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.rerun/summary.json"));
  write("beam.toml", with(kCantilever, "density", "# density\ndensity"));
  expect_status({"rerun", "b", "--output", "c"}, 0, "has changed since");
  std::filesystem::remove(folder_ / "beam.toml");
  expect_status({"rerun", "b", "--output", "c"}, 0, "is no longer there");
  expect_status({"rerun", "b", "--output", "b"}, 2, "is the result itself");
  expect_status({"rerun", (folder_ / "b/.").string()}, 0, "b.rerun");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b/..rerun"));
}

TEST_F(Provenance, CompareTellsWhatDiffers) {
  run("b", "bodies.beam.density=1001");
  expect_status({"compare", "a", "a"}, 0, "equal in every digit");
  expect_status({"compare", "a", "b"}, 1, "above the tolerance");
  expect_status({"compare", "a", "b", "--tolerance", "0.1"}, 0, "within the tolerance");
  const auto json = nlohmann::json::parse(fascia({"compare", "a", "b", "--json"}).out);
  EXPECT_GT(json.at("largest").get<double>(), 1e-4);
  EXPECT_LT(json.at("largest").get<double>(), 1e-2);
  run("c", "probes.other={body='beam',at=[1,0.1,0.1],quantity='displacement'}");
  expect_status({"compare", "a", "c"}, 1, "probes.csv has other columns");
}

/// Another solver rounds otherwise: rotations and shear that ought to be zero are no difference.
TEST_F(Provenance, RoundingIsNoDifference) {
  run("b", "solver.linear.kind=cg");
  run("c", "solver.linear.kind=cholesky");
  expect_status({"compare", "b", "c"}, 0, "within the tolerance");
}

TEST_F(Provenance, DamagedResultsAreTold) {
  run("b", "bodies.beam.density=1000");
  std::filesystem::remove(folder_ / "b/beam.pvd");
  expect_status({"compare", "a", "b"}, 2, "is missing, and lists the states");
  write("b/summary.json", R"({"fascia":"0","status":null,"scene":7})");
  expect_status({"compare", "a", "b"}, 2, "is damaged");
  expect_status({"rerun", "b"}, 2, "does not say where it came from");
  expect_status({"compare", "a", "nowhere"}, 4, "has no summary.json");
  std::filesystem::create_symlink("loop", folder_ / "loop");
  expect_status({"compare", "loop", "a"}, 4, "loop");
}

}  // namespace
}  // namespace fascia::test::provenance_test
