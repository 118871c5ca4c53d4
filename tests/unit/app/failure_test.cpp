#include "app/run/run_scene.hpp"
#include "app/run/temporary_folder.hpp"
#include "io/result_reader.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

// A run that failed leaves these: both states, the marks of what is suspect, and a message with a place.
namespace fascia::app::failure_test {
namespace {

namespace fs = std::filesystem;

class FailedRun : public ::testing::Test {
 protected:
  int run(const std::string& scene) {
    std::ofstream(folder_ / "scene.toml") << scene;
    RunOptions options;
    options.scene = folder_ / "scene.toml";
    options.output = folder_ / "out";
    options.quiet = true;
    const int status = run_scene(options);
    std::ifstream file(folder_ / "out/summary.json");
    summary_ = nlohmann::json::parse(file);
    return status;
  }

  /// An array of the failed state of a body.
  std::vector<double> failed(const std::string& body, const std::string& array) const {
    const io::ResultArrays arrays = io::read_result_arrays(folder_ / "out" / (body + "_failed.vtu"));
    const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const auto& a) {
      return a.first == array || a.first.ends_with(" " + array) || a.first.ends_with("." + array);
    });
    EXPECT_NE(found, arrays.end()) << array;
    return found == arrays.end() ? std::vector<double>{} : found->second;
  }

  void expect_both_states() const {
    const nlohmann::json& failure = summary_.at("failure");
    for (const char* which : {"last_good", "failed"}) {
      EXPECT_EQ(failure.at(which).size(), summary_.at("bodies").size());
      for (const auto& name : failure.at(which))
        EXPECT_FALSE(io::read_result_arrays(folder_ / "out" / name.get<std::string>()).empty()) << name;
    }
    const std::string message = summary_.at("message");
    EXPECT_NE(message.find("worst at"), std::string::npos) << message;
    for (const io::CollectionEntry& entry : io::read_collection(folder_ / "out/scene.pvd"))
      EXPECT_EQ(entry.file.find("failed"), std::string::npos);
  }

  TemporaryFolder made_{"fascia failure"};
  fs::path folder_ = made_.path();
  nlohmann::json summary_;
};

/// Two bars that hang apart; the end of the second one is pushed through its support.
std::string bars(const std::string& law, const std::string& model, const std::string& solver, double push) {
  std::string text = fmt::format("[materials.soft]\nyoung = \"20 kPa\"\npoisson = 0.3\nlaw = \"{}\"\n", law);
  for (const auto& [name, y] : {std::pair{"left", 0.0}, std::pair{"right", 1.0}})
    text += fmt::format(
        "[bodies.{0}]\nmodel = \"{1}\"\ndensity = 1000\nmaterial = \"soft\"\ndomain = {{ box = {{ min = [0, {2}, 0], "
        "max = "
        "[0.3, {3}, 0.1]{4} }} }}\n{5}",
        name, model, y, y + 0.1, model == "meshless" ? "" : ", cells = [3, 1, 1]",
        model == "meshless" ? "frames = { grid = [4, 2, 2] }\n" : "");
  for (const char* name : {"left", "right"})
    text += fmt::format(
        "[[constraints]]\nbody = \"{}\"\nwhere = {{ box = {{ min = [-0.01, -9, -9], max = [0.01, 9, 9] }} }}\nfix = "
        "\"all\"\n",
        name);
  return text +
         fmt::format(
             "[[constraints]]\nbody = \"right\"\nwhere = {{ box = {{ min = [0.29, -9, -9], max = [0.31, 9, 9] }} }}\n"
             "move = {{ translate = [{}, 0, 0] }}\n{}[solver]\n{}\n",
             -push, solver.find("static") == std::string::npos ? "over = 1\n" : "", solver);
}

TEST_F(FailedRun, MarksTheBodyThatIsCrushed) {
  for (const char* model : {"hexahedra", "meshless"}) {
    const char* solver = "kind = \"static\"\nnewton = { max_iterations = 6 }";
    ASSERT_EQ(run(bars("neo-hookean", model, solver, 0.5)), kNotConverged) << model;
    expect_both_states();
    std::printf("%s: %s\n%s\n", model, summary_.at("message").get<std::string>().c_str(),
                summary_.at("failure").dump().c_str());
    EXPECT_EQ(summary_.at("failure").at("body"), "right");
    const std::vector<double> left = failed("left", "suspect"), right = failed("right", "suspect");
    EXPECT_EQ(std::count(left.begin(), left.end(), 1.0), 0);
    EXPECT_GT(std::count(right.begin(), right.end(), 1.0), 0);
  }
}

/// The corners of a thick bar that is twisted by a turn are pressed to 0.56 along a diagonal: the run that stops says
/// what gives way.
TEST_F(FailedRun, NamesTheLawThatGivesWay) {
  const char* bar = R"(
[bodies.bar]
model = "tetrahedra"
domain = { box = { min = [0, -0.015, -0.0125], max = [0.1, 0.015, 0.0125], cells = [8, 2, 2] } }
order = 2
density = 1000
material = { young = 1e4, poisson = 0.3 }
[[constraints]]
body = "bar"
where = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }
fix = "all"
[[constraints]]
body = "bar"
where = { box = { min = [0.099999, -1, -1], max = [1, 1, 1] } }
move = { rotate = { axis = [1, 0, 0], angle = "360 degree", center = [0, 0, 0] } }
[solver]
kind = "static"
linear = { kind = "cholesky" }
newton = { max_iterations = 15 }
)";
  ASSERT_EQ(run(bar), kNotConverged);
  const std::string message = summary_.at("message");
  EXPECT_NE(message.find("materials give way"), std::string::npos) << message;
}

TEST_F(FailedRun, TimeStepsToo) {
  ASSERT_EQ(run(bars("neo-hookean", "tetrahedra", "kind = \"implicit-euler\"\ntime_step = 0.05\nsteps = 20", 0.5)),
            kNotConverged);
  expect_both_states();
  std::printf("%s\n", summary_.at("message").get<std::string>().c_str());
  EXPECT_EQ(summary_.at("failure").at("body"), "right");
}

/// A bar that is pulled stiffens, until the step that was stable at rest is so no more.
TEST_F(FailedRun, ExplicitStepsToo) {
  const std::string solver = "kind = \"explicit\"\ntime_step = 0.0145\nsteps = 200";
  ASSERT_EQ(run(bars("st-venant-kirchhoff", "hexahedra", solver, -1.5)), kNotConverged);
  expect_both_states();
  const nlohmann::json& failure = summary_.at("failure");
  std::printf("%s\n%s\n", summary_.at("message").get<std::string>().c_str(), failure.dump().c_str());
  EXPECT_EQ(failure.at("body"), "right");
  EXPECT_GT(failure.at("step"), 1);
  const std::vector<double> left = failed("left", "suspect");
  EXPECT_EQ(std::count(left.begin(), left.end(), 1.0), 0);
}

/// Bodies without matter have cells, in which no point says how far they are compressed.
TEST_F(FailedRun, BodiesWithoutMatterKeepTheirVolume) {
  const char* more = R"(
[bodies.skin]
model = "surface"
domain = { box = { min = [0.05, 0.02, 0.02], max = [0.25, 0.08, 0.08] } }
[couplings.ride]
kind = "embed"
body = "skin"
where = "all"
to = "left"
[bodies.bone]
model = "rigid"
domain = { box = { min = [0, 2, 0], max = [0.1, 2.1, 0.1] } }
density = 1000
[[constraints]]
body = "bone"
where = "all"
fix = "all"
)";
  const char* solver = "kind = \"static\"\nnewton = { max_iterations = 6 }";
  ASSERT_EQ(run(bars("neo-hookean", "hexahedra", solver, 0.5) + more), kNotConverged);
  expect_both_states();
  EXPECT_EQ(summary_.at("failure").at("body"), "right");
  for (const char* body : {"skin", "bone"})
    for (const double volume : failed(body, "volume_ratio")) EXPECT_EQ(volume, 1) << body;
}

TEST_F(FailedRun, MatterInsideOutIsMarked) {
  ASSERT_EQ(run(bars("st-venant-kirchhoff", "hexahedra", "kind = \"static\"\nload_steps = 4", 0.5)), kNotConverged);
  expect_both_states();
  std::printf("%s\n", summary_.at("message").get<std::string>().c_str());
  EXPECT_NE(summary_.at("message").get<std::string>().find("materials.soft.law = \"neo-hookean\""), std::string::npos);
  const std::vector<double> suspect = failed("right", "suspect"), volume = failed("right", "volume_ratio");
  for (std::size_t cell = 0; cell < suspect.size(); ++cell) EXPECT_EQ(suspect[cell] == 1, volume[cell] <= 0) << cell;
}

/// A block of six tetrahedra and one on top of it that is all but flat; the top of that one is pushed through.
TEST_F(FailedRun, MarksThePlantedElement) {
  std::ofstream(folder_ / "flat.msh")
      << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n5 0 0 1\n6 1 0 1\n7 0 1 "
         "1\n8 1 1 1\n9 0.7 0.4 1.05\n$EndNodes\n$Elements\n7\n1 4 2 0 1 1 2 4 8\n2 4 2 0 1 1 4 3 8\n3 4 2 0 1 1 3 7 "
         "8\n4 4 2 0 1 1 7 5 8\n5 4 2 0 1 1 5 6 8\n6 4 2 0 1 1 6 2 8\n7 4 2 0 1 5 6 8 9\n$EndElements\n";
  const char* scene = R"([materials.soft]
young = "20 kPa"
poisson = 0.3
law = "neo-hookean"
[bodies.block]
model = "tetrahedra"
domain = { file = "flat.msh" }
density = 1000
material = "soft"
[[constraints]]
body = "block"
where = { box = { min = [-9, -9, -0.1], max = [9, 9, 1.01] } }
fix = ["x", "y"]
[[constraints]]
body = "block"
where = { box = { min = [-9, -9, -0.1], max = [9, 9, 0.1] } }
fix = ["z"]
[[constraints]]
body = "block"
where = { box = { min = [-9, -9, 0.9], max = [9, 9, 1.01] } }
move = { translate = [0, 0, 0.1] }
[[constraints]]
body = "block"
where = { box = { min = [-9, -9, 1.02], max = [9, 9, 1.1] } }
fix = "all"
[solver]
kind = "static"
)";
  ASSERT_EQ(run(scene), kNotConverged);
  expect_both_states();
  std::printf("%s\n%s\n", summary_.at("message").get<std::string>().c_str(), summary_.at("failure").dump().c_str());
  EXPECT_EQ(summary_.at("failure").at("element"), 7);
  EXPECT_EQ(failed("block", "suspect"), (std::vector<double>{0, 0, 0, 0, 0, 0, 1}));
}

TEST_F(FailedRun, OneThatSucceedsLeavesNothing) {
  ASSERT_EQ(run(bars("neo-hookean", "hexahedra", "kind = \"static\"", 0.02)), kDone);
  EXPECT_FALSE(summary_.contains("failure"));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "out"))
    EXPECT_EQ(entry.path().string().find("_failed"), std::string::npos);
}

}  // namespace
}  // namespace fascia::app::failure_test
