#include "app/extremes/map.hpp"
#include "app/extremes/other_units.hpp"
#include "app/extremes/twin.hpp"
#include "app/reader/parse.hpp"
#include "app/report/csv.hpp"
#include "app/run/run_scene.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "tests/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <set>

namespace fascia::extremes_unit_test {
namespace {

using namespace fascia::app;

void collect_units(const Shape& shape, std::set<std::string>& units, int depth = 0) {
  if (depth > 20) return;  // schemas that refer to themselves
  if (shape.type == Type::number) units.insert(shape.unit);
  if (shape.type == Type::reference) collect_units(shape.target(), units, depth + 1);
  for (const Shape& item : shape.items) collect_units(item, units, depth + 1);
  for (const Key& key : shape.keys) collect_units(key.shape, units, depth + 1);
}

TEST(OtherUnits, EveryUnitOfTheSchemaHasADimension) {
  std::set<std::string> units;
  collect_units(scene_schema(), units);
  EXPECT_GT(units.size(), 12U);
  for (const std::string& unit : units) EXPECT_NO_THROW(UnitFactors{}.of(unit)) << unit;
}

TEST(OtherUnits, FollowTheDimension) {
  const UnitFactors f{2, 3, 5};
  EXPECT_DOUBLE_EQ(f.of("1"), 1);
  EXPECT_DOUBLE_EQ(f.of("rad/s"), 1.0 / 5);
  EXPECT_DOUBLE_EQ(f.of("kg/m3"), 2.0 / 27);
  EXPECT_DOUBLE_EQ(f.of("N m"), 2.0 * 9 / 25);
  EXPECT_DOUBLE_EQ(f.of("Pa"), 2.0 / (3 * 25));
  EXPECT_DOUBLE_EQ(f.of("m/s2"), 3.0 / 25);
  EXPECT_DOUBLE_EQ(f.of("N/m"), 2.0 / 25);
  EXPECT_THROW(f.of("furlong"), std::invalid_argument);
}

TEST(OtherUnits, ReachNumbersTextsWithUnitsAndLists) {
  Specimen s;
  Value scene = parse_toml(s.text() +
                           "[world]\ngravity = [\"9.81 m/s2\", 0, 1]\n[probes.one]\nat = [1, 2, 3]\n"
                           "[probes.several]\nat = [[1, 2, 3], [\"4 mm\", 5, 6]]\n");
  ASSERT_TRUE(change_units(scene, {1, 10, 1}));
  const Array& gravity = *scene.find("world")->find("gravity")->as_array();
  EXPECT_DOUBLE_EQ(std::get<double>(gravity[0].data), 98.1);
  EXPECT_DOUBLE_EQ(std::get<double>(gravity[2].data), 10);
  const auto at = [&](const char* probe) { return scene.find("probes")->find(probe)->find("at")->as_array(); };
  EXPECT_DOUBLE_EQ(std::get<double>((*at("one"))[1].data), 20);
  EXPECT_DOUBLE_EQ(std::get<double>((*(*at("several"))[0].as_array())[2].data), 30);
  EXPECT_DOUBLE_EQ(std::get<double>((*(*at("several"))[1].as_array())[0].data), 0.04);
  EXPECT_DOUBLE_EQ(std::get<double>(scene.find("materials")->find("near")->find("young")->data), 1e3);
  EXPECT_DOUBLE_EQ(std::get<double>(scene.find("materials")->find("near")->find("poisson")->data), 0.3);
}

TEST(ExtremeCells, AreScenesThatTheReaderTakes) {
  std::set<std::string> names;
  for (const ExtremeCell& c : reduced_cells()) {
    EXPECT_TRUE(names.insert(c.name()).second) << c.name();
    EXPECT_NO_THROW(parse_scene_text(c.text, "cell.toml", {})) << c.name();
    EXPECT_NO_THROW(parse_scene_text(twin_of(c).text, "twin.toml", twin_solver())) << c.name();
  }
  EXPECT_GT(names.size(), 200U);
  std::set<std::string> all;
  for (const ExtremeCell& c : map_cells()) all.insert(c.name());
  for (const std::string& name : names) EXPECT_TRUE(all.contains(name)) << name;
  EXPECT_EQ(pair_cells(5).back().text, pair_cells(5).back().text);
}

/// A run that ended so, with one displacement.
ChildResult ended(int status, double value, const std::string& message = "") {
  ChildResult r;
  r.exit_status = status;
  r.message = message;
  r.summary = {{"status", status == kDone ? "converged" : "not-converged"},
               {"probes", {{"tip", {{"unit", "m"}, {"value", {value, 0.0, 0.0}}}}}}};
  return r;
}

CellVerdict verdict(const ChildResult& run, const ChildResult& twin, const ChildResult& disturbed = {},
                    const ChildResult& sharper = {}) {
  return judge({"row", "axis", "1", "", std::nullopt}, {&run, &twin, &disturbed, &sharper, {1, 2, 1}}).verdict;
}

TEST(CellVerdicts, SayWhatATwinSays) {
  const ChildResult run = ended(kDone, 1);
  EXPECT_EQ(verdict(run, ended(kDone, 2)), CellVerdict::right);  // lengths of the twin are twice as large
  EXPECT_EQ(verdict(run, ended(kDone, 2.00001)), CellVerdict::wrong);
  EXPECT_EQ(verdict(run, ended(kDone, 2.00001), ended(kDone, 2.00002)), CellVerdict::sensitive);
  EXPECT_EQ(verdict(run, ended(kDone, 2.00001), ended(kDone, 2.0000100001)), CellVerdict::wrong);
  EXPECT_EQ(verdict(run, ended(kDone, 3), {}, ended(kDone, 1)), CellVerdict::branch);
  EXPECT_EQ(verdict(run, ended(kNotConverged, 2, "stalled")), CellVerdict::unconfirmed);
  EXPECT_EQ(verdict(run, ended(kNotConverged, 2, "stalled"), {}, ended(kDone, 1)), CellVerdict::branch);
  ChildResult doubtful = run;
  doubtful.summary["doubts"] = {"the body snapped"};
  EXPECT_EQ(verdict(doubtful, ended(kDone, 3)), CellVerdict::warned);
  EXPECT_EQ(verdict(doubtful, ended(kDone, 2)), CellVerdict::right);
}

/// A reaction may differ by what rounding leaves of the forces, as the run says; a displacement may not.
TEST(CellVerdicts, TakeWhatRoundingLeavesForReactionsAlone) {
  const auto reacting = [](double displacement, double force) {
    ChildResult r = ended(kDone, displacement);
    r.summary["probes"]["support"] = {{"unit", "N"}, {"value", force}};
    r.summary["residual_floor"] = 1e-4;
    return r;
  };
  const ChildResult run = reacting(1, 1);  // forces of the twin are twice as large as well
  EXPECT_EQ(verdict(run, reacting(2, 2)), CellVerdict::right);
  EXPECT_EQ(verdict(run, reacting(2, 2.00002)), CellVerdict::sensitive);
  EXPECT_EQ(verdict(run, reacting(2, 2.002)), CellVerdict::wrong);
  EXPECT_EQ(verdict(run, reacting(2.00002, 2)), CellVerdict::wrong);
  EXPECT_EQ(verdict(run, reacting(2.00001, 2.00002)), CellVerdict::wrong);
}

/// Two runs whose displacements are rounding of a length of 1 m.
TEST(CellVerdicts, CountRoundingAsNone) {
  const ChildResult run = ended(kDone, 3e-17), twin = ended(kDone, -1e-16);
  ExtremeCell cell{"row", "axis", "1", "", std::nullopt};
  const ChildResult none;
  const CellRuns runs{&run, &twin, &none, &none, {1, 2, 1}};
  EXPECT_EQ(judge(cell, runs).verdict, CellVerdict::wrong);
  cell.length = 1;
  EXPECT_EQ(judge(cell, runs).verdict, CellVerdict::right);
}

/// Statics of what nothing holds: right is to say so, and to say nothing else.
TEST(CellVerdicts, OfWhatHasNoEquilibrium) {
  ExtremeCell cell{"row", "axis", "1", "", std::nullopt};
  cell.has_equilibrium = false;
  const auto of = [&](const ChildResult& run) {
    const ChildResult none, twin = ended(kDone, 2);
    return judge(cell, {&run, &twin, &none, &none, {1, 2, 1}}).verdict;
  };
  EXPECT_EQ(of(ended(kWrongInput, 1, "bodies.beam: nothing holds this body in a static solve")), CellVerdict::right);
  EXPECT_EQ(of(ended(kWrongInput, 1, "young: too small")), CellVerdict::refused);
  EXPECT_EQ(of(ended(kNotConverged, 1, "step 3")), CellVerdict::stopped);
  EXPECT_EQ(of(ended(kDone, 1)), CellVerdict::wrong);
  int without = 0;
  for (const ExtremeCell& c : map_cells()) without += c.has_equilibrium ? 0 : 1;
  EXPECT_EQ(without, 24);  // twelve models, two solvers
}

/// By closed forms: the stress of a bar falls from 0.577 of its length on, its section vanishes at a stretch of 2.08.
TEST(ExtremeCells, KnowWhatTheirLawBears) {
  const auto borne = [](BeamModel model, Action action, double amount, bool neo_hookean = false) {
    Specimen s;
    s.model = model;
    s.action = action;
    s.amount = amount;
    s.neo_hookean = neo_hookean;
    return s.is_borne();
  };
  for (const BeamModel m : {BeamModel::grid, BeamModel::hexahedra, BeamModel::line, BeamModel::shell}) {
    EXPECT_TRUE(borne(m, Action::stretch, 0.6));
    EXPECT_FALSE(borne(m, Action::stretch, 0.5));
    EXPECT_TRUE(borne(m, Action::stretch, 2));
    EXPECT_FALSE(borne(m, Action::stretch, 2.1));
    EXPECT_TRUE(borne(m, Action::pull, 1)) << "a stretch of 1.52";
    EXPECT_FALSE(borne(m, Action::pull, 10)) << "of 2.83";
    EXPECT_TRUE(borne(m, Action::stretch, 0.2, true));
    EXPECT_TRUE(borne(m, Action::compress, 10));
  }
  EXPECT_TRUE(borne(BeamModel::grid, Action::twist, 5.1));
  EXPECT_FALSE(borne(BeamModel::grid, Action::twist, 5.2)) << "edges are sheared by 1 at 5.12";
  EXPECT_TRUE(borne(BeamModel::shell, Action::twist, 12.6));
  EXPECT_TRUE(borne(BeamModel::corotational_tetrahedra, Action::twist, 12.6));
  EXPECT_TRUE(borne(BeamModel::linear_tetrahedra, Action::stretch, 0.2));
  EXPECT_TRUE(borne(BeamModel::corotational_tetrahedra, Action::pull, 3));
  EXPECT_FALSE(borne(BeamModel::corotational_tetrahedra, Action::pull, 3.5)) << "a stretch of 4.33 leaves no section";
}

/// To stop is as good as an answer where the law gives way, and the run says that it does.
TEST(CellVerdicts, OfWhatALawDoesNotBear) {
  const ChildResult none, twin = ended(kDone, 2);
  const auto of = [&](const ChildResult& run, bool borne) {
    ExtremeCell cell{"row", "axis", "1", "", std::nullopt};
    cell.is_borne = borne;
    return judge(cell, {&run, &twin, &none, &none, {1, 2, 1}}).verdict;
  };
  const ChildResult told = ended(kNotConverged, 1, "where St Venant-Kirchhoff materials give way");
  EXPECT_EQ(of(told, false), CellVerdict::beyond);
  EXPECT_EQ(of(told, true), CellVerdict::stopped);
  EXPECT_EQ(of(ended(kNotConverged, 1, "step 3"), false), CellVerdict::stopped);
  EXPECT_EQ(of(ended(kDone, 1), false), CellVerdict::right);
  EXPECT_EQ(of(ended(kDone, 3), false), CellVerdict::wrong);
}

TEST(CellVerdicts, OfRunsThatFail) {
  const ChildResult twin = ended(kDone, 2);
  EXPECT_EQ(verdict(ended(kWrongInput, 1, "young: too small"), twin), CellVerdict::refused);
  EXPECT_EQ(verdict(ended(kNotConverged, 1, "step 3"), twin), CellVerdict::stopped);
  EXPECT_EQ(verdict(ended(kNotConverged, 1), twin), CellVerdict::crashed);  // no reason
  EXPECT_EQ(verdict(ended(139, 1, "ended with status 139"), twin), CellVerdict::crashed);
  ChildResult nan = ended(kDone, 1);
  nan.summary["probes"]["tip"]["value"][0] = nullptr;
  EXPECT_EQ(verdict(nan, twin), CellVerdict::crashed);
  ChildResult slow = ended(143, 1, "did not end within 60 s");
  slow.timed_out = true;
  EXPECT_EQ(verdict(slow, twin), CellVerdict::limit);
}

class StoredMap : public testing::Test {
 protected:
  StoredMap() {
    map_.cells = {{"row", "axis, one", "1", "", std::nullopt}, {"row", "axis, one", "2", "", std::nullopt}};
    map_.outcomes.resize(2);
    map_.outcomes[0].verdict = CellVerdict::right;
    map_.outcomes[1].verdict = CellVerdict::stopped;
    map_.outcomes[1].reason = "says \"no\"";
    write(csv_of(map_));
  }
  void write(const std::string& text) const { io::write_file(file(), text); }
  std::filesystem::path file() const { return folder_.path / "extremes.csv"; }
  std::string refusal() {
    try {
      compare_with_stored(map_, file());
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
  ExtremesMap map_;
};

TEST_F(StoredMap, TellsWhatGotWorseAndBetter) {
  compare_with_stored(map_, file());
  EXPECT_TRUE(map_.regressions.empty() && map_.gains.empty());
  map_.outcomes[0].verdict = CellVerdict::wrong;
  map_.outcomes[1].verdict = CellVerdict::right;
  compare_with_stored(map_, file());
  ASSERT_EQ(map_.regressions.size(), 1U);
  EXPECT_NE(map_.regressions[0].find("was right, is wrong"), std::string::npos) << map_.regressions[0];
  EXPECT_EQ(map_.gains.size(), 1U);
}

/// A fault that a cell and its twin share.
TEST_F(StoredMap, TellsThatADisplacementIsAnotherOne) {
  map_.outcomes[0].size = 0.125;
  write(csv_of(map_));
  map_.outcomes[0].size = 0.1250005;
  compare_with_stored(map_, file());
  EXPECT_TRUE(map_.regressions.empty());
  map_.outcomes[0].size = 0.12501;
  compare_with_stored(map_, file());
  ASSERT_EQ(map_.regressions.size(), 1U);
  EXPECT_NE(map_.regressions[0].find("was 0.125 m, is 0.12501 m"), std::string::npos) << map_.regressions[0];
}

TEST_F(StoredMap, RefusesWhatIsNone) {
  write("row,axis\n1,2\n");
  EXPECT_NE(refusal().find("extremes.csv:1: the columns are not"), std::string::npos) << refusal();
  std::string edited = csv_of(map_);
  edited.replace(edited.find("stopped"), 7, "perfect");
  write(edited);
  EXPECT_NE(refusal().find(":3: \"perfect\" is no verdict"), std::string::npos) << refusal();
  map_.cells[0].row = map_.cells[1].row = "another scene";
  ExtremesMap other = map_;
  other.cells[0].row = other.cells[1].row = "third";
  write(csv_of(other));
  EXPECT_NE(refusal().find("has none of these 2 cells"), std::string::npos) << refusal();
  write("\"open");
  EXPECT_NE(refusal().find("a quote begins and does not end"), std::string::npos) << refusal();
}

TEST_F(StoredMap, TellsWhatAnotherProgramSaid) {
  map_.files = {"cells/one.toml", "cells/two.toml"};
  write("cell,fascia,calculix,difference\ntwo,inverted,converged,\n");
  read_beside(map_, file());
  EXPECT_EQ(map_.others, (std::vector<std::string>{"", "calculix: converged"}));
  write("cell,fascia,calculix,difference\nthree,inverted,converged,\n");
  EXPECT_THROW(read_beside(map_, file()), InputError);
  write("cell\n");
  EXPECT_THROW(read_beside(map_, file()), InputError);
}

TEST(Csv, ReadsWhatItWrites) {
  const std::vector<std::string> row{"a,b", "say \"x\"", "two\nlines", ""};
  EXPECT_EQ(read_csv(csv_row(row) + csv_row({"1", "2"})), (std::vector<std::vector<std::string>>{row, {"1", "2"}}));
  EXPECT_EQ(read_csv("a,b\r\nc,d"), (std::vector<std::vector<std::string>>{{"a", "b"}, {"c", "d"}}));
}

}  // namespace
}  // namespace fascia::extremes_unit_test
