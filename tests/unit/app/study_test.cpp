#include "app/scene/toml_text.hpp"
#include "app/study/evaluation.hpp"
#include "app/study/richardson.hpp"
#include "app/study/study_file.hpp"
#include "app/study/tables.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace fascia::study_test {
namespace {

using namespace fascia::app;

std::vector<Level> levels_of(double limit, double factor, double order, const std::vector<double>& sizes) {
  std::vector<Level> levels;
  for (const double h : sizes) levels.push_back({h, {limit + factor * std::pow(h, order)}});
  return levels;
}

TEST(Richardson, FindsLimitAndOrderOfAPower) {
  for (const double order : {0.5, 1.0, 1.6, 2.0, 4.0})
    for (const auto& sizes : {std::vector{1.0, 0.5, 0.25}, {1.0, 0.7, 0.6}, {3.0, 1.0, 0.1}}) {
      const std::optional<Limit> limit = limit_of(levels_of(2.5, -0.3, order, sizes));
      ASSERT_TRUE(limit && limit->order) << order;
      EXPECT_NEAR(*limit->order, order, 1e-6);
      EXPECT_NEAR(limit->value[0], 2.5, 1e-6);
    }
}

TEST(Richardson, VectorsShareAnOrder) {
  std::vector<Level> levels;
  for (const double h : {1.0, 0.5, 0.25}) levels.push_back({h, {1 + h * h, -2 - 3 * h * h}});
  const std::optional<Limit> limit = limit_of(levels);
  EXPECT_NEAR(limit->value[0], 1, 1e-9);
  EXPECT_NEAR(limit->value[1], -2, 1e-9);
  EXPECT_NEAR(limit->uncertainty, 1.25 * std::hypot(1, 3) / 16, 1e-9);
}

TEST(Richardson, ClaimsNoOrderWhereThereIsNone) {
  const std::optional<Limit> swings = limit_of({{1, {1.0}}, {0.5, {1.2}}, {0.25, {1.1}}});
  EXPECT_FALSE(swings->order);
  EXPECT_EQ(swings->value[0], 1.1);
  EXPECT_NEAR(swings->uncertainty, 0.3, 1e-12);
  EXPECT_FALSE(limit_of({{1, {1.0}}, {0.5, {1.1}}, {0.25, {1.3}}})->order);  // grows apart
  EXPECT_FALSE(limit_of({{1, {1.0}}, {0.5, {1.1}}})->order);
  EXPECT_FALSE(limit_of({{1, {1.0}}}));
  EXPECT_FALSE(limit_of({{1, {1.0}}, {1, {1.1}}}));  // one size alone
  EXPECT_FALSE(limit_of({{1, {1.0}}, {0.5, {1.0}}, {0.25, {1.0}}})->order);
}

TEST(Richardson, FitsSlopes) {
  EXPECT_NEAR(*fitted_order(std::vector{1.0, 0.5, 0.1}, std::vector{0.3, 0.075, 0.003}), 2, 1e-12);
  EXPECT_FALSE(fitted_order(std::vector{1.0}, std::vector{0.3}));
  EXPECT_FALSE(fitted_order(std::vector{1.0, 0.5}, std::vector{0.3, 0.0}));
  EXPECT_FALSE(fitted_order(std::vector{1.0, 1.0}, std::vector{0.3, 0.2}));
}

TEST(TomlText, ReadsBackAsWhatItWas) {
  for (const char* text : {"1", "1.0", "1e-300", "-0.5", "true", "\"a \\\"b\\\" \\\\ µ\"", "[1, 2.5, \"x\"]",
                           "{ a = 1, \"b c\" = { d = [] } }", "inf"}) {
    const std::string first = toml_text(*parse_toml(std::string("v = ") + text).find("v"));
    EXPECT_EQ(toml_text(*parse_toml("v = " + first).find("v")), first) << text;
  }
  EXPECT_EQ(toml_text(*parse_toml("v = 3.0").find("v")), "3.0");  // stays a number with a point
}

/// Writes a study beside the scenes, so that its base is found.
class StudyFile {
 public:
  explicit StudyFile(const std::string& text) {
    std::string name = (std::filesystem::temp_directory_path() / "fascia_study_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    path = folder_ / "study.toml";
    const std::string scene = (fascia::test::source_dir() / "scenes/soft_cantilever.toml").string();
    io::write_file(path, "base = \"" + scene + "\"\n" + text);
  }
  ~StudyFile() { std::filesystem::remove_all(folder_); }
  StudyFile(const StudyFile&) = delete;
  StudyFile& operator=(const StudyFile&) = delete;
  std::filesystem::path path;

  std::string error() const {
    try {
      Study study = read_study(path);
      plan_study(study);
    } catch (const SceneError& e) {
      return e.what();
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

 private:
  std::filesystem::path folder_;
};

const char* const kAxis = "[[axes]]\nkey = \"bodies.beam.frames.grid\"\nvalues = [[5,2,2],[9,3,3]]\n";
const char* const kMeasure = "[[measures]]\nprobe = \"tip\"\n";

TEST(StudyFiles, CombineAllValuesTheLastFastest) {
  const StudyFile file(std::string(kAxis) + "[[axes]]\nkey = \"solver.threads\"\nvalues = [1, 2]\n" + kMeasure);
  Study study = read_study(file.path);
  const std::vector<PlannedRun> runs = plan_study(study);
  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(runs[1].overrides, (std::vector<std::string>{"bodies.beam.frames.grid=[5, 2, 2]", "solver.threads=2"}));
  EXPECT_NE(runs[1].key, runs[0].key);
  EXPECT_EQ(runs[1].refused, "");
}

TEST(StudyFiles, KeysMoveTogetherAndAlternativesSetAndRemove) {
  const StudyFile file(
      "mode = \"paired\"\n[[axes]]\nname = \"stiffness\"\nkeys = [\"materials.silicone.young\", \"bodies.beam.mass\"]\n"
      "values = [[\"40 kPa\", 5], [\"80 kPa\", 6]]\n[[axes]]\nalternatives = [{ name = \"coarse\", set = { "
      "bodies.beam.frames.grid = [5,2,2] } }, { name = \"untitled\", remove = [\"title\"], set = { \"solver.threads\" "
      "= "
      "1 } }]\n" +
      std::string(kMeasure));
  Study study = read_study(file.path);
  const std::vector<PlannedRun> runs = plan_study(study);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].overrides[2], "bodies.beam.frames.grid=[5, 2, 2]");
  EXPECT_EQ(runs[1].overrides, (std::vector<std::string>{"materials.silicone.young=\"80 kPa\"", "bodies.beam.mass=6",
                                                         "title=", "solver.threads=1"}));
  EXPECT_EQ(runs[1].refused, "");
}

TEST(StudyFiles, ModelsOfTheSameBeam) {
  const StudyFile file(
      "[[axes]]\nbody = \"beam\"\nmodels = [\"frames\", \"affine\", \"tetrahedra\", \"hexahedra-2\", \"shell\"]\n"
      "[[axes]]\nrefine = [1, 2]\n" +
      std::string(kMeasure));
  Study study = read_study(file.path);
  const std::vector<PlannedRun> runs = plan_study(study);
  ASSERT_EQ(runs.size(), 10U);
  for (std::size_t r = 0; r < 8; ++r) EXPECT_EQ(runs[r].refused, "") << r;
  EXPECT_NE(runs[8].refused, "");  // a box is no surface
}

TEST(StudyFiles, SayWhatIsWrongWithThem) {
  const auto expect = [](const std::string& text, const std::string& part) {
    const std::string error = StudyFile(text).error();
    EXPECT_NE(error.find(part), std::string::npos) << error << "\n  for\n" << text;
  };
  const std::string axis = kAxis, measure = kMeasure;
  expect(axis + "[[measures]]\nprobe = \"tipp\"\n", "did you mean \"tip\"?");
  expect("[[axes]]\nkey = \"bodies.beam.frmes.grid\"\nvalues = [1]\n" + measure, "did you mean \"frames\"?");
  expect("[[axes]]\nkeys = [\"a\", \"b\"]\nvalues = [[1]]\n" + measure, "each row must have 2 values");
  expect("[[axes]]\nvalues = [1]\n" + measure, "is missing; give exactly one");
  expect(axis + measure + "reference = { value = [1, 2, 3], source = \"me\" }\n", "uncertainty: is missing");
  expect(axis + measure + "reference = { value = [1, 2, 3], uncertainty = 0 }\n", "source: is missing");
  expect(axis + measure + "reference = { value = [\"1 kg\", 2, 3], uncertainty = 0, source = \"me\" }\n", "\"1 kg\"");
  expect(axis + measure + "reference = { }\n", "needs `value`, `scene` or `set`");
  expect(axis + measure + "per = \"nothing\"\nreference = \"finest\"\n", "no known axis");
  expect(axis + axis + measure, "stands twice");
  expect(axis + measure + "reference = \"finer\"\n", "finest");
  const std::string finest = "reference = \"finest\"\n", shape = "[[measures]]\nfield = \"displacement\"\n";
  expect(axis + "[[measures]]\nfield = \"displacment\"\n" + finest, "did you mean \"displacement\"?");
  expect(axis + "[[measures]]\n" + finest, "is missing; give exactly one");
  expect(axis + shape, "study.toml:5:1: measures[0].reference: is missing; a field needs one");
  expect(axis + shape + "reference = { value = 1, source = \"me\", uncertainty = 0 }\n", "a field needs another field");
  expect(axis + shape + "moment = \"curve\"\n" + finest, "at the end; remove it");
  expect(axis + shape + "body = \"beem\"\n" + finest, "measures[0].body: \"beem\" is no known body of");
  expect(axis + measure + "body = \"beam\"\n" + finest, "measures[0].body: belongs to a field");
  expect("set = { output.fields = [\"strain\"] }\n" + axis + shape + finest, "is not among `output.fields`");
  expect("mode = \"paired\"\n" + axis + "[[axes]]\nkey = \"solver.threads\"\nvalues = [1]\n" + measure, "paired");
}

TEST(FieldDistances, SayWhatIsMissing) {
  const StudyFile file(std::string(kAxis) + "[[measures]]\nfield = \"displacement\"\nreference = \"finest\"\n");
  const Study study = read_study(file.path);
  EXPECT_EQ(study.measures[0].name, "displacement");
  const std::filesystem::path nowhere = file.path.parent_path() / "runs" / "nothing";
  const FieldDistance distance = FieldDistances().at(study.measures[0], nowhere, nowhere);
  EXPECT_NE(distance.trouble.find(nowhere.string()), std::string::npos) << distance.trouble;
}

/// A study of one measure, whose runs have these costs and errors.
StudyResult result_of(const std::vector<std::pair<Spread, double>>& runs) {
  StudyResult result;
  result.study.measures.emplace_back().name = "tip";
  result.study.axes.push_back({{}, "n", {}, "", {}});
  result.questions = questions_of(result.study);
  for (const auto& [cost, error] : runs) {
    result.study.axes[0].values.push_back({std::to_string(result.runs.size()), {}, {}, "", 1});
    StudyRun& run = result.runs.emplace_back();
    run.plan.at = {result.runs.size() - 1};
    run.record.emplace().status = "converged";
    run.record->dofs = 100;
    run.cost = cost;
    run.measured.resize(1);
    run.measured[0].error = error;
    run.on_front = {0};
  }
  return result;
}

TEST(Fronts, HoldWhatNothingBeats) {
  const StudyResult result = result_of({{{1, 1, 1}, 0.1}, {{2, 2, 2}, 0.05}, {{3, 3, 3}, 0.06}, {{4, 4, 4}, 0.01}});
  EXPECT_EQ(front_of(result, result.questions[0]), (std::vector<std::size_t>{0, 1, 3}));
}

TEST(Fronts, TakeOverlappingTimesForEqual) {
  // The second is not slower by more than the spread, and more accurate: the first is beaten.
  const StudyResult result = result_of({{{1, 0.8, 1.2}, 0.1}, {{1.1, 0.9, 1.3}, 0.05}, {{1.15, 1, 1.2}, 0.05}});
  EXPECT_EQ(front_of(result, result.questions[0]), (std::vector<std::size_t>{1, 2}));
}

TEST(Fronts, ErrorsBelowTheUncertaintyAreEqual) {
  StudyResult result = result_of({{{1, 1, 1}, 0.002}, {{2, 2, 2}, 0.001}, {{3, 3, 3}, 1e-6}});
  result.questions[0].reference.uncertainty = 0.005;
  EXPECT_EQ(front_of(result, result.questions[0]), (std::vector<std::size_t>{0}));
}

TEST(Choices, AreTheCheapestThatIsGoodEnoughOrTheKnee) {
  StudyResult result = result_of({{{1, 1, 1}, 0.1}, {{2, 2, 2}, 0.01}, {{40, 40, 40}, 0.005}});
  EXPECT_EQ(choices_of(result, result.questions[0])->chosen, 1U);
  result.study.need = 0.2;
  EXPECT_EQ(choices_of(result, result.questions[0])->chosen, 0U);
  result.study.need = 0.006;
  EXPECT_EQ(choices_of(result, result.questions[0])->chosen, 2U);
  EXPECT_EQ(by_cost(result, result.questions[0]).size(), 2U);  // 1 and 10 s
}

}  // namespace
}  // namespace fascia::study_test
