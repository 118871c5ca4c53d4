// Times and settings of two results beside one another.
#include "app/compare/figures.hpp"
#include "app/compare/settings.hpp"
#include "app/compare/time_pairs.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace fascia::app::compare_parts_test {
namespace {

using Json = nlohmann::ordered_json;
using Times = std::vector<double>;

TimePairs pairs(const Times& a, const Times& b, RunKind kind) { return pair_times(a, kind, b, kind, "states"); }

TEST(PairTimes, TakesTheSameTimes) {
  const TimePairs p = pairs({0, 0.1, 0.2}, {0, 0.1 + 1e-12, 0.2}, RunKind::dynamics);
  ASSERT_EQ(p.pairs.size(), 3u);
  EXPECT_EQ(p.pairs[1].b.fraction, 0);
  EXPECT_TRUE(p.notes.empty());
  EXPECT_TRUE(p.structure.empty());
}

TEST(PairTimes, InterpolatesTheFinerOne) {
  const TimePairs p = pairs({0, 0.1, 0.2, 0.3}, {0, 0.15, 0.3}, RunKind::dynamics);
  ASSERT_EQ(p.pairs.size(), 3u);
  EXPECT_EQ(p.pairs[1].time, 0.15);
  EXPECT_EQ(p.pairs[1].a.below, 1u);
  EXPECT_EQ(p.pairs[1].a.above, 2u);
  EXPECT_NEAR(p.pairs[1].a.fraction, 0.5, 1e-12);
  EXPECT_EQ(p.pairs[1].b.below, 1u);
  ASSERT_EQ(p.notes.size(), 1u);
  EXPECT_NE(p.notes[0].find("1 of 3 times lie between two of A"), std::string::npos) << p.notes[0];
}

TEST(PairTimes, TellsAnEarlierEnd) {
  const TimePairs p = pairs({0, 0.1}, {0, 0.1, 0.2}, RunKind::dynamics);
  EXPECT_EQ(p.pairs.size(), 2u);
  ASSERT_EQ(p.structure.size(), 1u);
  EXPECT_NE(p.structure[0].find("the last of A is at 0.1, that of B at 0.2"), std::string::npos) << p.structure[0];
  EXPECT_EQ(pairs({}, {0}, RunKind::dynamics).structure.size(), 1u);
}

TEST(PairTimes, ComparesLoadFactorsThatBothHaveAndEndsOfPaths) {
  const TimePairs statics = pairs({0.5, 1}, {0.25, 1}, RunKind::statics);
  ASSERT_EQ(statics.pairs.size(), 1u);
  EXPECT_EQ(statics.pairs[0].a.below, 1u);
  const TimePairs path = pairs({1, 2, 3}, {1, 2, 3, 4, 5}, RunKind::path);
  ASSERT_EQ(path.pairs.size(), 1u);
  EXPECT_EQ(path.pairs[0].a.below, 2u);
  EXPECT_EQ(path.pairs[0].b.below, 4u);
  EXPECT_TRUE(path.structure.empty());
}

Json summary_of(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  return {{"provenance", {{"scene", scene}, {"overrides", overrides}}}};
}

std::vector<std::string> differing(const Json& a, const Json& b) {
  std::vector<std::string> texts;
  for (const Difference& d : setting_differences(scene_settings(a, "A"), scene_settings(b, "B")))
    texts.push_back(d.name + ": " + d.a + " | " + d.b);
  return texts;
}

TEST(Settings, DifferByKeyAfterOverrides) {
  const Json a = summary_of("[bodies.beam]\nframes = { grid = [3, 2, 2] }\n[[constraints]]\nfix = \"all\"\n"),
             b = summary_of(
                 "[bodies.beam]\nframes = { grid = [3, 2, 2] }\nlocking = \"none\"\n[[constraints]]\nfix = \"x\"\n",
                 {"bodies.beam.frames.grid=[5,3,3]"});
  EXPECT_EQ(differing(a, b),
            (std::vector<std::string>{"bodies.beam.frames.grid: [3, 2, 2] | [5, 3, 3]",
                                      "constraints[0].fix: \"all\" | \"x\"", "bodies.beam.locking:  | \"none\""}));
  EXPECT_EQ(scene_settings(a, "A").value_of("constraints[0].fix"), "all");
}

TEST(Settings, OfOneMeaningAreTheSame) {
  EXPECT_TRUE(differing(summary_of("a = \"40 kPa\"\nb = [1, \"5 mm\"]\nc = 2\n"),
                        summary_of("a = 4e4\nb = [1.0, 0.005]\nc = 2.0\n"))
                  .empty());
  EXPECT_EQ(differing(summary_of("a = \"40 kPa\""), summary_of("a = \"41 kPa\"")).size(), 1u);
}

TEST(Settings, ThatCannotBeReadAreTold) {
  EXPECT_EQ(scene_settings(Json::object(), "A").notes.size(), 1u);
  EXPECT_EQ(scene_settings(summary_of("a = = 1"), "A").notes.size(), 1u);
}

TEST(Figures, AreThoseThatBothHave) {
  const Json a = {{"fascia", "1"}, {"seconds", {{"setup", 2.0}}}, {"couplings", {{"tie", {{"force", {3, 4, 0}}}}}}};
  Json b = a;
  b["fascia"] = "2";
  b["seconds"]["setup"] = 3.0;
  ASSERT_EQ(cost_figures(a, b).size(), 1u);
  EXPECT_EQ(cost_figures(a, b)[0].b, 3);
  ASSERT_EQ(energy_figures(a, b).size(), 1u);
  EXPECT_EQ(energy_figures(a, b)[0].a, 5);
  ASSERT_EQ(program_differences(a, b).size(), 1u);
  EXPECT_EQ(program_differences(a, b)[0].name, "version");
}

}  // namespace
}  // namespace fascia::app::compare_parts_test
