#include "tests/robustness/scene_runs.hpp"

#include <cmath>
#include <sstream>

namespace fascia::test::frictions_test {
namespace {

/// What makes the program easy, or hard, to work with: texts that it reads and prints.
class Frictions : public SceneRuns {
 protected:
  /// Bytes of the .vtu files of a result, and of its probes.csv.
  double size_of(const std::string& result) const {
    double size = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / result))
      if (entry.path().extension() == ".vtu" || entry.path().extension() == ".csv")
        size += static_cast<double>(entry.file_size());
    return size;
  }

  /// What `check` says of the size of the results [bytes].
  double forecast(std::vector<std::string> more) const {
    more.insert(more.begin(), {"check", "scene.toml"});
    const ProgramResult result = fascia(more);
    EXPECT_EQ(result.status, 0) << result.err;
    const std::string begin = "\nresults: about ";
    const std::size_t place = result.out.find(begin);
    EXPECT_NE(place, std::string::npos) << result.out;
    std::istringstream text(result.out.substr(place + begin.size()));
    double size = 0;
    std::string unit;
    text >> size >> unit;
    const std::map<std::string, double> factors = {{"kB:", 1e3}, {"MB:", 1e6}, {"GB:", 1e9}, {"TB:", 1e12}};
    return size * factors.at(unit);
  }
};

TEST_F(Frictions, PrintsSixDigitsAndWhereToLook) {
  std::string points = "at = [";
  for (int k = 0; k < 40; ++k) points += "[0." + std::to_string(10 + k) + ", 0.1, 0.1], ";
  write("scene.toml", with(kCantilever, "at = [1, 0.1, 0.1]", points + "]"));
  const ProgramResult result = fascia({"run", "scene.toml", "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("weight (mass): 40 kg"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(", ... 36 more in probes.csv] m"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("results in out; open out/scene.pvd in ParaView, or read probes.csv\n"), std::string::npos)
      << result.out;
  const nlohmann::json tip = summary("out").at("probes").at("tip").at("value");
  EXPECT_EQ(tip.size(), 40u);
  EXPECT_GT(tip.at(39).at(1).dump().size(), 12u) << "files keep all digits";
}

TEST_F(Frictions, ForecastsTheSizeOfResults) {
  write("scene.toml", with(dynamic_scene(), "grid = [3, 2, 2]", "grid = [12, 4, 4]"));
  ASSERT_EQ(fascia({"run", "scene.toml", "--output", "out", "--quiet"}).status, 0);
  EXPECT_NEAR(std::log(forecast({}) / size_of("out")), 0, std::log(1.5));

  write("scene.toml", with(kCantilever, "model    = \"meshless\"", "model = \"tetrahedra\"\nlocking = \"none\""));
  const std::vector<std::string> mesh = {"--set", "bodies.beam.domain.box.cells=[12, 5, 5]", "--set",
                                         "bodies.beam.frames="};
  std::vector<std::string> run = {"run", "scene.toml", "--output", "mesh", "--quiet"};
  run.insert(run.end(), mesh.begin(), mesh.end());
  const ProgramResult result = fascia(run);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NEAR(std::log(forecast(mesh) / size_of("mesh")), 0, std::log(1.5));
}

TEST_F(Frictions, WarnsOfLargeResults) {
  write("scene.toml", dynamic_scene());
  const std::vector<std::string> large = {"--set", "solver.steps=100000000"};
  for (const std::string command : {"check", "run"}) {
    std::vector<std::string> arguments = {command, "scene.toml"};
    arguments.insert(arguments.end(), large.begin(), large.end());
    if (command == "run")
      arguments.insert(arguments.end(), {"--output", "out", "--set", "solver.newton.max_iterations=1", "--set",
                                         "solver.newton.tolerance=1e-12"});
    const ProgramResult result = fascia(arguments);
    EXPECT_EQ(result.status, command == "run" ? 3 : 0);
    EXPECT_NE(result.err.find("warning: output: the results take about "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("a larger output.every_steps saves fewer states, output.fields leaves fields out"),
              std::string::npos)
        << result.err;
  }
  EXPECT_EQ(summary("out").at("warnings").size(), 2u);  // the other: of its many steps
}

TEST_F(Frictions, ListsScenesQuantitiesAndUnits) {
  const ProgramResult scenes = fascia({"list", "scenes"});
  ASSERT_EQ(scenes.status, 0) << scenes.err;
  EXPECT_NE(scenes.out.find("soft_cantilever.toml"), std::string::npos) << scenes.out;
  EXPECT_NE(scenes.out.find("Soft cantilever under its own weight"), std::string::npos) << scenes.out;
  const ProgramResult quantities = fascia({"list", "quantities"});
  EXPECT_EQ(quantities.status, 0);
  EXPECT_NE(quantities.out.find("stress             Pa        At points: Cauchy, 3 x 3 by rows.\n"), std::string::npos)
      << quantities.out;
  const ProgramResult units = fascia({"list", "units"});
  EXPECT_EQ(units.status, 0);
  EXPECT_NE(units.out.find("a pressure"), std::string::npos) << units.out;
  EXPECT_NE(units.out.find("mmHg"), std::string::npos) << units.out;
  EXPECT_EQ(fascia({"list", "bones"}).status, 2);
  EXPECT_EQ(fascia({"list"}).status, 2);
}

TEST_F(Frictions, TextsOfAnyLanguageGoThrough) {
  write(
      "Mus\xC3\xA9"
      "e.toml",
      with(kCantilever, "Small cantilever",
           "Mus\xC3\xA9"
           "e \xE2\x82\xAC"));
  const ProgramResult result = fascia({"run",
                                       "Mus\xC3\xA9"
                                       "e.toml",
                                       "--output", "caf\xE9"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(summary("caf\xE9").at("title"),
            "Mus\xC3\xA9"
            "e \xE2\x82\xAC");
  EXPECT_EQ(fascia({"run",
                    "Mus\xC3\xA9"
                    "e.toml",
                    "--output", "caf\xE9"})
                .status,
            0)
      << "into the same directory";

  const ProgramResult wrong = fascia({"run",
                                      "Mus\xC3\xA9"
                                      "e.toml",
                                      "--set",
                                      "title=Mus\xE9"
                                      "e",
                                      "--output", "out"});
  EXPECT_EQ(wrong.status, 2) << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(Frictions, ASceneWithTheLongestName) {
  const std::string longest = std::string(250, 'n') + ".toml", too_long(255, 'n');
  write(longest, kCantilever);
  const ProgramResult result = fascia({"run", longest, "--output", "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / (std::string(250, 'n') + ".pvd")));
  write(too_long, kCantilever);
  EXPECT_EQ(fascia({"run", too_long, "--output", "out2"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out2"));
}

}  // namespace
}  // namespace fascia::test::frictions_test
