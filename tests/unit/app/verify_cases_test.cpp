// The registry of verification cases: what a case file may say, how runs are chosen, how values are judged.
#include "app/verify/choice.hpp"
#include "app/verify/report.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

namespace fascia::verify_cases_test {
namespace {

using namespace fascia::app;
namespace fs = std::filesystem;

/// Two runs, one of a text and one of a file; lines are counted below.
constexpr const char* kCases = R"toml(title = "Small ones"
[[runs]]
name = "cube-pulled"
title = "A cube is pulled"
features = ["statics", "hexahedra"]
scene = '''
[bodies.cube]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [1, 1, 1] } }
density = 1000
material = { young = 1000, poisson = 0 }
[[constraints]]
body = "cube"
where = "all"
fix = "all"
[solver]
kind = "static"
[probes.corner]
body = "cube"
at = [1, 1, 1]
quantity = "displacement"
'''
[[runs.cases]]
name = "cube-pulled-corner"
title = "displacement of the corner"
probe = "corner"
at = "y"
value = 0.1
unit = "m"
source = "F / (E A)"
allowed = 1e-8
[[runs]]
name = "cube-held"
title = "A cube is held"
features = ["statics", "tetrahedra"]
level = "full"
repeat = true
file = "cube.toml"
set = ["bodies.cube.density=2"]
[[runs.cases]]
name = "cube-held-corner"
title = "displacement"
probe = "corner"
minus = "corner"
at = "norm"
over = 2
value = 0
unit = "m"
source = "it is held"
allowed_absolute = 1e-12
)toml";

class VerifyCases : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "fascia_cases_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    const std::string text = kCases;
    const std::size_t begin = text.find("[bodies.cube]"), end = text.find("'''\n[[runs.cases]]");
    write("cube.toml", text.substr(begin, end - begin));
    fs::create_directory(folder_ / "cases");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  static std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  static std::string good() { return with(kCases, "\"cube.toml\"", "\"../cube.toml\""); }
  Registry read(const std::string& text) const {
    write("cases/small.toml", text);
    return read_registry(folder_ / "cases");
  }
  std::string wrong(const std::string& text) const {
    try {
      read(text);
    } catch (const SceneError& e) {
      return e.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(VerifyCases, AreRead) {
  const Registry r = read(good());
  ASSERT_EQ(r.size(), 2u);
  EXPECT_EQ(r[0].heading, "Small ones");
  EXPECT_EQ(r[0].topic, "small");
  EXPECT_TRUE(r[0].text);
  EXPECT_EQ(r[0].cases.at(0).at.indices, std::vector<std::size_t>{1});
  EXPECT_TRUE(r[0].cases[0].allowed.relative);
  EXPECT_TRUE(r[1].full && r[1].repeated && !r[1].text);
  EXPECT_EQ(r[1].scene, folder_ / "cube.toml");
  EXPECT_TRUE(r[1].cases.at(0).at.norm);
  EXPECT_FALSE(r[1].cases[0].allowed.relative);
}

TEST_F(VerifyCases, WhatIsWrongIsToldWithItsLineAndARemedy) {
  struct Wrong {
    const char *from, *to, *place, *says;
  };
  const Wrong all[] = {
      {"name = \"cube-held\"", "name = \"cube-pulled\"", ":33:", "name of the run at"},
      {"name = \"cube-held-corner\"", "name = \"cube-pulled-corner\"", ":41:", "needs a name of its own"},
      {"name = \"cube-held\"", "name = \"cube held\"", ":33:", "letters, digits and hyphens"},
      {"probe = \"corner\"\nat = \"y\"", "probe = \"corne\"\nat = \"y\"", ":26:", "did you mean \"corner\"?"},
      {"at = \"y\"", "at = \"w\"", ":27:", "is no known value"},
      {"value = 0.1", "valeu = 0.1", ":28:", "did you mean \"value\"?"},
      {"over = 2", "over = 0", ":46:", "cannot divide"},
      {"allowed_absolute = 1e-12", "allowed = 1e-12", ":50:", "give allowed_absolute"},
      {"allowed = 1e-8", "allowed = 1e-2", ":23:", "runs[0].cases[0].why: is missing"},
      {"source = \"F / (E A)\"", "source = \"\"", ":30:", "must say where the value comes from"},
      {"\"../cube.toml\"", "\"../cub.toml\"", ":38:", "must be a scene, relative to this file"},
      {"[\"bodies.cube.density=2\"]", "[\"bodies.cube.densty=2\"]", ":39:", "bodies.cube.densty: is no known key"},
      {"density = 1000", "density = -1000", ":10:", "bodies.cube.density: -1000 is out of range"},
      {"file = \"../cube.toml\"", "", ":32:", "file or scene is missing"},
      {"level = \"full\"", "level = \"long\"", ":36:", "must be \"full\""},
      {"[[runs.cases]]", "[[runs.case]]", ":23:", "did you mean \"cases\"?"},
      {"title = \"Small ones\"", "title = ", ":1:", "must be"}};
  for (const Wrong& w : all) {
    const std::string said = wrong(with(good(), w.from, w.to));
    EXPECT_NE(said.find("small.toml" + std::string(w.place)), std::string::npos) << w.to << ":\n" << said;
    EXPECT_NE(said.find(w.says), std::string::npos) << w.to << ":\n" << said;
  }
}

TEST_F(VerifyCases, NamesAreUniqueOverAllFiles) {
  write("cases/other.toml", good());
  const std::string said = wrong(good());
  EXPECT_NE(said.find("small.toml:3:"), std::string::npos) << said;
  EXPECT_NE(said.find("other.toml:3"), std::string::npos) << said;
}

TEST_F(VerifyCases, FoldersWithoutCasesAreFileErrors) {
  EXPECT_THROW(read_registry(folder_ / "cases"), FileError);
  EXPECT_THROW(read_registry(folder_ / "nowhere"), FileError);
}

TEST_F(VerifyCases, AreChosenByRunCaseFeatureTopicAndGlob) {
  const Registry r = read(good());
  const auto names = [&](const std::vector<std::string>& by, bool full) {
    std::string all;
    for (const VerificationRun& run : choose(r, by, full).runs) all += run.name + " ";
    return all;
  };
  EXPECT_EQ(names({}, false), "cube-pulled ");
  EXPECT_EQ(choose(r, {}, false).long_left, 1u);
  EXPECT_EQ(names({}, true), "cube-pulled cube-held ");
  EXPECT_EQ(names({"cube-held"}, false), "cube-held ") << "named itself";
  EXPECT_EQ(names({"cube-held-corner"}, false), "cube-held ");
  EXPECT_EQ(names({"tetrahedra"}, true), "cube-held ");
  EXPECT_EQ(names({"tetrahedra"}, false), "");
  EXPECT_EQ(names({"small"}, true), "cube-pulled cube-held ");
  EXPECT_EQ(names({"*-pulled"}, true), "cube-pulled ");
  try {
    choose(r, {"cube-hold"}, false);
    ADD_FAILURE() << "chosen";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"cube-held\"?"), std::string::npos) << e.what();
  }
  EXPECT_THROW(choose(r, {"x*"}, false), InputError);
}

TEST(VerifyValues, AreTakenOutOfProbes) {
  const auto summary = nlohmann::ordered_json::parse(R"({"probes": {"tip": {"value": [3, 4, 0]}, "mass": {"value": 7},
    "base": {"value": [1, 1, 0]}, "stress": {"value": [[[1, 2], [3, 4]]]}, "lost": {"value": null}}})");
  VerificationCase c;
  c.probe = "tip";
  c.allowed = {0.1, true};
  c.value = 5;
  c.at = {{}, true};
  EXPECT_EQ(judge(c, summary).value, 5.0);
  c.at = {{1}, false};
  c.minus = "base";
  c.over = 2;
  c.value = 1.6;
  const CaseOutcome apart = judge(c, summary);
  EXPECT_EQ(apart.value, 1.5);
  EXPECT_NEAR(apart.error, -0.0625, 1e-15);
  EXPECT_EQ(apart.verdict, Verdict::passed);
  c.allowed.error = 0.06;
  EXPECT_EQ(judge(c, summary).verdict, Verdict::failed);
  c = {};
  c.value = 1;
  for (const auto& [probe, at, says] : {std::tuple{"tip", Entry{}, "which number"},
                                        {"tip", Entry{{3}}, "has 3 entries"},
                                        {"mass", Entry{{0}}, "is a number"},
                                        {"lost", Entry{}, "no finite number"},
                                        {"none", Entry{}, "has no probe"},
                                        {"stress", Entry{{0, 1}}, "which number"}}) {
    c.probe = probe;
    c.at = at;
    const CaseOutcome outcome = judge(c, summary);
    EXPECT_EQ(outcome.verdict, Verdict::failed);
    EXPECT_FALSE(outcome.value);
    EXPECT_NE(outcome.reason.find(says), std::string::npos) << outcome.reason;
  }
  c.probe = "stress";
  c.at = {{0, 1, 0}};
  EXPECT_EQ(judge(c, summary).value, 3.0);
}

/// Lines of a page without what a run of it computed: the last two cells of its rows.
std::vector<std::string> without_results(const std::string& page) {
  std::istringstream in(page);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("| ") && line.ends_with(" |"))
      for (int cell = 0; cell < 2; ++cell) line.erase(line.rfind(" | "));
    lines.push_back(line);
  }
  return lines;
}

TEST(ValidationPage, IsThatOfTheRegistry) {
  const fs::path source = test::source_dir();
  std::ifstream file(source / "docs/validation.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::string> there = without_results(page),
                           wanted = without_results(validation_page(read_registry(source / "scenes/cases"), {}));
  there.resize(std::max(there.size(), wanted.size()));
  wanted.resize(there.size());
  for (std::size_t i = 0; i < there.size(); ++i)
    ASSERT_EQ(there[i], wanted[i]) << "docs/validation.md:" << i + 1
                                   << ": write it again: fascia verify --full --write-validation docs/validation.md";
}

}  // namespace
}  // namespace fascia::verify_cases_test
