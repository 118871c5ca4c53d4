#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/scene_run.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

namespace fascia::study_program_test {
namespace {

using fascia::test::ProgramOptions;
using fascia::test::ProgramResult;
using fascia::test::run_program;
using fascia::test::TemporaryFolder;

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::vector<std::string>> csv(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> row{""};
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        row.emplace_back();
      else
        row.back() += c;
    }
    rows.push_back(row);
  }
  return rows;
}

/// A study of four runs of the soft cantilever, two of which are no valid scene, in a folder of its own.
class StudyProgram : public testing::Test {
 protected:
  StudyProgram() { write("[[5,2,2],[9,2,2]]"); }

  void write(const std::string& grids) const {
    std::ofstream file(folder_.path / "s.toml");
    file << "base = \"" << (fascia::test::source_dir() / "scenes/soft_cantilever.toml").string() << "\"\n"
         << "repeat = 1\nwarm_up = 0\n[[axes]]\nkey = \"bodies.beam.frames.grid\"\nvalues = " << grids
         << "\n[[axes]]\nname = \"ratio\"\nkey = \"materials.silicone.poisson\"\nvalues = [0.3, 0.6]\n"
         << "[[measures]]\nname = \"drop\"\nprobe = \"tip\"\ncomponent = \"y\"\n"
         << "reference = { value = \"-6.5096 m\", source = \"solids\", uncertainty = 2e-4 }\n";
  }

  ProgramResult study(const std::vector<std::string>& more = {}, ProgramOptions options = {}) const {
    std::vector<std::string> command{fascia::test::program(), "study", "s.toml", "--output", "out"};
    command.insert(command.end(), more.begin(), more.end());
    options.directory = folder_.path;
    return run_program(command, options);
  }
  std::filesystem::path out() const { return folder_.path / "out"; }

  TemporaryFolder folder_;
};

TEST_F(StudyProgram, WritesARowForEachCombination) {
  const ProgramResult run = study();
  ASSERT_EQ(run.status, 0) << run.err;
  const auto rows = csv(out() / "study.csv");
  ASSERT_EQ(rows.size(), 5U);
  const std::vector<std::string> head(rows[0].begin(), rows[0].begin() + 13);
  EXPECT_EQ(head, (std::vector<std::string>{"grid", "ratio", "status", "error_drop", "value_drop", "step_median",
                                            "step_max", "setup", "solve", "memory", "dofs", "newton", "linear"}));
  EXPECT_EQ(rows[1][2], "converged");
  EXPECT_EQ(rows[2][2], "refused");  // a ratio of 0.6
  EXPECT_NE(rows[2].back().find("poisson: 0.6 is out of range"), std::string::npos) << rows[2].back();
  const double value = std::stod(rows[3][4]), error = std::stod(rows[3][3]);
  EXPECT_NEAR(error, std::abs(value + 6.5096) / 6.5096, 1e-12);
  EXPECT_LT(error, std::stod(rows[1][3]));  // the finer grid is better
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  const std::string page = content(out() / "study.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("http://") == std::string::npos || page.find("http://www.w3.org") != std::string::npos, true);
  EXPECT_EQ(nlohmann::json::parse(content(out() / "study.json"))["runs"].size(), 4U);
}

TEST_F(StudyProgram, GoesOnWhereItWasInterrupted) {
  write("[[5,2,2],[9,2,2],[13,3,3],[17,3,3],[21,3,3],[25,4,4],[29,4,4],[33,4,4]]");
  ProgramOptions options;
  options.signal = SIGTERM;
  options.signal_after = std::chrono::milliseconds(600);
  const ProgramResult broken = study({}, options);
  ASSERT_TRUE(broken.status == 128 + SIGTERM || broken.status == 0) << broken.status << broken.err;
  const auto before = csv(out() / "study.csv");
  const ProgramResult again = study();
  ASSERT_EQ(again.status, 0) << again.err;
  const auto after = csv(out() / "study.csv");
  ASSERT_EQ(before.size(), after.size());
  if (before[1][2] == "converged") {
    EXPECT_NE(again.err.find("known from before"), std::string::npos) << again.err;
    EXPECT_EQ(before[1], after[1]);  // times too: it was not run again
  }
  for (std::size_t r = 1; r < after.size(); r += 2) EXPECT_EQ(after[r][2], "converged");
  const ProgramResult known = study();
  EXPECT_EQ(csv(out() / "study.csv"), after);
}

TEST_F(StudyProgram, TakesASceneWithValuesOnTheCommandLine) {
  const std::string scene = (fascia::test::source_dir() / "scenes/soft_cantilever.toml").string();
  ProgramOptions options;
  options.directory = folder_.path;
  const ProgramResult run =
      run_program({fascia::test::program(), "study", scene, "--vary", "bodies.beam.frames.grid=[[5,2,2],[9,2,2]]",
                   "--measure", "tip.y", "--untimed", "--output", "out", "--json"},
                  options);
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["measures"][0]["name"], "tip.y");
  EXPECT_EQ(json["runs"][1]["status"], "converged");
}

/// A bar of two models is pulled to u = c X: fields of other c differ by a part that is known, whatever the meshes.
TEST_F(StudyProgram, MeasuresFieldsOfOtherMeshes) {
  std::ofstream(folder_.path / "bar.toml") << R"([bodies.bar]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [2, 1, 1], cells = [3, 1, 1] } }
density = 1000
material = { young = "10 kPa", poisson = 0 }
[[constraints]]
body = "bar"
where = "all"
fix = ["y", "z"]
[[constraints]]
body = "bar"
where = { box = { min = [-0.01, -9, -9], max = [0.01, 9, 9] } }
fix = ["x"]
[[constraints]]
body = "bar"
where = { box = { min = [1.99, -9, -9], max = [2.01, 9, 9] } }
move = { translate = [0.5, 0, 0], axes = ["x"] }
[solver]
kind = "static"
newton = { tolerance = 1e-12 }
)";
  std::ofstream(folder_.path / "s.toml") << R"(base = "bar.toml"
timed = false
[[axes]]
name = "pull"
key = "constraints[2].move.translate"
values = [[0.5, 0, 0], [0.4, 0, 0], [0.6, 0, 0]]
[[axes]]
key = "bodies.bar.model"
values = ["hexahedra", "tetrahedra"]
[[measures]]
field = "displacement"
reference = { set = { bodies.bar.domain.box.cells = [2, 2, 2] } }
[[measures]]
name = "stretch"
field = "strain"
body = "bar"
reference = "finest"
[[measures]]
name = "turn"
field = "rotation"
reference = "finest"
)";
  const ProgramResult run = study({"--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  const double strain[] = {0.25, 0.2, 0.3};  // Green-Lagrange: c + c²/2; all are as fine, and the first is taken
  for (std::size_t r = 0; r < 6; ++r) {
    const auto& shape = json["runs"][r]["measures"]["displacement"];
    const double part[] = {0, 0.2, 0.2};
    EXPECT_NEAR(shape["error"].get<double>(), part[r / 2], 1e-9) << r;
    const auto& stretch = json["runs"][r]["measures"]["stretch"];
    const double e = strain[r / 2] + strain[r / 2] * strain[r / 2] / 2, first = 0.25 + 0.25 * 0.25 / 2;
    EXPECT_NEAR(stretch["error"].get<double>(), std::abs(e - first) / first, 1e-9) << r;
    EXPECT_NEAR(stretch["value"][0].get<double>(), e, 1e-9) << r;
  }
  EXPECT_NEAR(json["runs"][0]["measures"]["displacement"]["value"][0].get<double>(), 0.5 / std::sqrt(3), 1e-9);
  EXPECT_NE(json["measures"][2]["reference"]["missing"].get<std::string>().find("field \"rotation\""),
            std::string::npos)
      << json["measures"][2]["reference"];
}

/// Rotations of nearly half a turn cannot be compared: their body is no error of 0, however the other one fares.
TEST_F(StudyProgram, LeavesNoBodyOutOfAField) {
  std::string scene = "[solver]\nkind = \"static\"\nthreads = 1\n[output]\nfields = [\"rotation\"]\n";
  for (const auto& [name, y, angle] : {std::tuple("p", 0, 10), std::tuple("q", 3, 190)})
    scene += fmt::format(
        "[bodies.{0}]\nmodel = \"meshless\"\nframes = {{ grid = [2, 2, 2] }}\ndensity = 1\n"
        "domain = {{ box = {{ min = [0, {1}, 0], max = [1, {3}, 1] }} }}\n"
        "material = {{ young = \"1 MPa\", poisson = 0.3 }}\n"
        "[[constraints]]\nbody = \"{0}\"\nwhere = \"all\"\n"
        "move = {{ rotate = {{ axis = [0, 0, 1], angle = \"{2} degree\", center = [0, {1}, 0] }} }}\n",
        name, y, angle, y + 1);
  std::ofstream(folder_.path / "turns.toml") << scene;
  std::ofstream(folder_.path / "s.toml") << R"(base = "turns.toml"
timed = false
[[axes]]
key = "constraints[1].move.rotate.angle"
values = ["175 degree", "90 degree"]
[[measures]]
field = "rotation"
reference = { set = { solver.threads = 1 } }
)";
  const ProgramResult run = study({"--json"});
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_NE(run.out.find("body \\\"q\\\" turns by more than 3 rad"), std::string::npos) << run.out;
  EXPECT_FALSE(json["runs"][0]["measures"]["rotation"]["error"].is_number()) << json["runs"][0];
  EXPECT_GT(json["runs"][1]["measures"]["rotation"]["error"],
            1);  // 90° beside the 190° of the reference, which are −170°
}

/// A bundle starts the program so: /proc/self/exe is then the loader, and runs of the study must be started by it too.
TEST_F(StudyProgram, StartsItsRunsThroughTheLoaderItWasStartedBy) {
  const char* const loader = "/lib64/ld-linux-x86-64.so.2";
  if (!std::filesystem::exists(loader)) GTEST_SKIP() << "no " << loader;
  write("[[5,2,2]]");
  ProgramOptions options;
  options.directory = folder_.path;
  const ProgramResult run =
      run_program({loader, "--argv0", "fascia", "--library-path", fascia::test::build_dir().string(),
                   fascia::test::program(), "study", "s.toml", "--output", "out"},
                  options);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(csv(out() / "study.csv")[1][2], "converged") << run.out << run.err;
}

TEST_F(StudyProgram, RefusesWhatItCannotDo) {
  std::filesystem::create_directory(out());
  std::ofstream(out() / "letter.txt") << "mine";
  const ProgramResult foreign = study();
  EXPECT_EQ(foreign.status, 4);
  EXPECT_NE(foreign.err.find("something else than a study"), std::string::npos) << foreign.err;
  EXPECT_EQ(content(out() / "letter.txt"), "mine");
  std::filesystem::remove_all(out());

  ProgramOptions options;
  options.directory = folder_.path;
  const std::string scene = (fascia::test::source_dir() / "scenes/soft_cantilever.toml").string();
  const ProgramResult no_vary = run_program({fascia::test::program(), "study", scene}, options);
  EXPECT_EQ(no_vary.status, 2);
  EXPECT_NE(no_vary.err.find("this is a scene"), std::string::npos) << no_vary.err;
  const ProgramResult half = run_program({fascia::test::program(), "study", scene, "--measure", "tip"}, options);
  EXPECT_EQ(half.status, 2);
  write("[\"five\"]");
  const ProgramResult none = study();
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("none of the 2 combinations"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace fascia::study_program_test
