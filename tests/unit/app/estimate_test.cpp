#include "app/estimate/estimate.hpp"
#include "app/estimate/measure.hpp"
#include "app/estimate/plan.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// What errors are estimated from: orders, series over time, which runs are made.
namespace fascia::app::estimate_test {
namespace {

using namespace test;

/// Of a quantity 1 + c h^p at h = 4, 2, 1 and 1/2.
LevelDifferences levels(double c, double p) {
  const auto value = [&](double h) { return 1 + c * std::pow(h, p); };
  return {std::abs(value(4) - value(2)), std::abs(value(2) - value(1)), std::abs(value(1) - value(0.5))};
}

TEST(Richardson, GivesTheErrorOfAPowerLaw) {
  for (const double p : {1.0, 1.6, 2.0, 3.3, 4.0}) {
    const LevelDifferences all = levels(0.03, p);
    for (const LevelDifferences& known :
         {all, LevelDifferences{{}, all.coarser, all.finer}, LevelDifferences{all.coarsest, all.coarser, {}}}) {
      const auto e = extrapolated(known, {});
      ASSERT_TRUE(e);
      EXPECT_TRUE(e->measured);
      EXPECT_EQ(e->by_finer, known.finer.has_value());
      EXPECT_NEAR(e->order, p, 1e-9);
      EXPECT_NEAR(e->error, 0.03, 1e-9);
    }
    const auto assumed = extrapolated({{}, {}, all.finer}, {p});
    EXPECT_FALSE(assumed->measured);
    EXPECT_NEAR(assumed->error, 0.03, 1e-9);
    EXPECT_NEAR(extrapolated({{}, all.coarser, {}}, {p})->error, 0.03, 1e-9);
  }
}

TEST(Richardson, OrdersStayWithinTheGuard) {
  EXPECT_EQ(extrapolated({{}, 1.0, 1.0}, {})->order, 1);   // does not converge yet
  EXPECT_EQ(extrapolated({{}, 1.0, 1e-9}, {})->order, 4);  // by chance
  EXPECT_EQ(extrapolated({{}, 0.0, 1e-3}, {})->order, 2);  // says nothing
  EXPECT_FALSE(extrapolated({1.0, {}, {}}, {}));
  EXPECT_EQ(extrapolated({{}, 1.0, 0.0}, {})->error, 0);
}

TEST(SeriesOverTime, AreComparedAtCommonTimes) {
  const Series a{{0, 0.1, 0.2}, {{0, 0}, {3, 4}, {1, 0}}},
      b{{0, 0.05, 0.1 + 1e-12, 0.15, 0.2}, {{0, 0}, {9, 9}, {3, 3}, {9, 9}, {0, 0}}};
  EXPECT_DOUBLE_EQ(a.largest(), 5);
  EXPECT_DOUBLE_EQ(*distance(a, b, SeriesNorm::euclidean), 1);
  EXPECT_FALSE(distance(a, {{0.07}, {{1, 1}}}, SeriesNorm::euclidean)) << "no common time";
  EXPECT_FALSE(distance(a, {{0.1}, {{1}}}, SeriesNorm::euclidean)) << "other components";
  EXPECT_NEAR(*distance({{1}, {{1e-9, 2, 10}}}, {{1}, {{1, 2.2, 10}}}, SeriesNorm::largest_relative), 0.1, 1e-15);
  EXPECT_EQ(mixed({{1}, {{1, 2}}}, {{1}, {{2, 2}}}, 1.5).values[0], (std::vector<double>{2.5, 2}));
}

/// Values of statics at each level.
Measured of_levels(double own, double finer, double coarser) {
  const auto twin = [=](TwinRole role) -> std::optional<Series> {
    if (role == TwinRole::finer) return Series{{1}, {{finer}}};
    if (role == TwinRole::coarser) return Series{{1}, {{coarser}}};
    if (role == TwinRole::exact) return Series{{1}, {{own * (1 + 1e-7)}}};
    return std::nullopt;
  };
  return {Series{{1}, {{own}}}, twin};
}

TEST(EstimatedErrors, AreRelativeToTheLargerOfValueAndExtrapolatedValue) {
  // 0.6 and 0.9 on the way to 1: a locking body on the coarse side.
  const EstimatedError e = measured(of_levels(0.6, 0.9, -0.6), SolverKind::statics, false);
  EXPECT_NEAR(e.order, 2, 1e-12);
  EXPECT_NEAR(e.scale, 1, 1e-12);
  EXPECT_NEAR(*e.discretisation, 0.4, 1e-12);
  EXPECT_NEAR(*e.solver, 0.6e-7, 1e-12);
  EXPECT_EQ(*e.time, 0);
  EXPECT_EQ(*e.precision, 0);
  EXPECT_NEAR(*e.total(), 0.4, 1e-6);
}

TEST(EstimatedErrors, OfARunThatWasCutAreThoseOfItsTwinAndWhatWasLeft) {
  Measured cut = of_levels(0.6, 0.9, -0.6);
  cut.own = Series{{1}, {{0.55}}};
  cut.cut = true;
  const EstimatedError e = measured(cut, SolverKind::statics, false);
  EXPECT_NEAR(e.order, 2, 1e-6);
  EXPECT_NEAR(*e.discretisation, 0.4, 1e-6);
  EXPECT_NEAR(*e.solver, 0.05, 1e-6);
  cut.twin = [](TwinRole) -> std::optional<Series> { return std::nullopt; };
  EXPECT_FALSE(measured(cut, SolverKind::statics, false).discretisation) << "nothing to compare twins with";
}

TEST(EstimatedErrors, WithoutATwinThereIsNoNumber) {
  Measured none{Series{{1}, {{1}}}, [](TwinRole) -> std::optional<Series> { return std::nullopt; }};
  const EstimatedError e = measured(none, SolverKind::bdf2, true);
  EXPECT_FALSE(e.discretisation || e.time || e.solver || e.precision || e.total());
  none.own = Series{{1}, {{0}}};
  none.twin = [](TwinRole) { return Series{{1}, {{0}}}; };
  EXPECT_EQ(*measured(none, SolverKind::statics, false).total(), 0) << "nothing moves in either";
  none.twin = [](TwinRole role) { return Series{{1}, {{role == TwinRole::finer ? 1e-18 : 0}}}; };
  none.rounding = 1e-12;
  EXPECT_EQ(*measured(none, SolverKind::statics, false).total(), 0) << "rounding";
}

EstimatePlan plan_of(const std::string& more, const std::vector<std::string>& overrides = {}) {
  const std::string held =
      "[[constraints]]\nbody = \"beam\"\nwhere = { box = { min = [-1, -1, -1], max = [0, 9, 9] } }\nfix = \"all\"\n";
  std::vector<std::string> all{"output.estimate=true"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return plan_estimate(build_simulation(parse_beam(held + more, all)));
}

std::vector<TwinRole> roles(const EstimatePlan& plan) {
  std::vector<TwinRole> roles;
  for (const PlannedTwin& twin : plan.twins) roles.push_back(twin.role);
  return roles;
}

using Roles = std::vector<TwinRole>;

TEST(EstimatePlans, TakeAFinerTwinWhereItIsSmall) {
  const std::string fine = "bodies.beam.frames.grid=[9, 5, 5]";
  EXPECT_EQ(roles(plan_of("")), (Roles{TwinRole::finer, TwinRole::exact})) << "one cell cannot be halved";
  EXPECT_EQ(roles(plan_of("", {fine})), (Roles{TwinRole::finer, TwinRole::coarser, TwinRole::exact}));
  EXPECT_EQ(roles(plan_of("", {fine, "output.estimate=coarser"})),
            (Roles{TwinRole::coarser, TwinRole::coarsest, TwinRole::exact}));
  const EstimatePlan large = plan_of("", {"bodies.beam.frames.grid=[41, 9, 9]"});
  EXPECT_EQ(roles(large), (Roles{TwinRole::coarser, TwinRole::coarsest, TwinRole::exact}));
  EXPECT_NE(large.notes[0].find("by coarser twins, as a finer one would have"), std::string::npos) << large.notes[0];
  const EstimatePlan none = plan_of("", {"bodies.beam.frames.grid=[40, 8, 8]"});
  EXPECT_EQ(roles(none), Roles{TwinRole::exact});
  EXPECT_NE(none.notes[0].find("no estimate, because \"beam\" stays: 39 cells cannot be joined by 2"),
            std::string::npos)
      << none.notes[0];
  EXPECT_GT(plan_of("", {fine}).cost(), 8);
}

TEST(EstimatePlans, OfDynamicsHalveTheStep) {
  const std::string steps = "time_step = 0.01\nduration = 1\n";
  EXPECT_EQ(roles(plan_of("[solver]\nkind = \"bdf2\"\n" + steps)),
            (Roles{TwinRole::finer, TwinRole::shorter_step, TwinRole::exact}));
  for (const PlannedTwin& twin : plan_of("[solver]\nkind = \"bdf2\"\nbudget = \"5 ms\"\n" + steps).twins)
    EXPECT_EQ(std::ranges::count(twin.twin.overrides, "solver.budget=\"none\""), 1) << twin.name;
  const EstimatePlan plan = plan_of("[solver]\nkind = \"explicit\"\ntime_step = 0.001\nduration = 1\n");
  EXPECT_EQ(roles(plan), (Roles{TwinRole::finer, TwinRole::shorter_step}));
  EXPECT_EQ(plan.twins[0].twin.overrides.back(), "solver.time_step=0.0005") << "the finer mesh needs it";
}

/// Half of the longest stable step may be a little too long in a mesh of halved cells.
TEST(EstimatePlans, OfAutomaticStepsKeepTheFinerTwinStable) {
  Simulation simulation = build_simulation(
      parse_beam("[solver]\nkind = \"explicit\"\ntime_step = \"auto\"\nduration = 1\n", {"output.estimate=true"}));
  simulation.scene.solver.time_step = 1e-3;  // as a run has found it
  const EstimatePlan plan = plan_estimate(simulation);
  ASSERT_EQ(roles(plan), (Roles{TwinRole::finer, TwinRole::shorter_step}));
  const auto step = [&](std::size_t twin) {
    for (const std::string& s : plan.twins[twin].twin.overrides)
      if (s.starts_with("solver.time_step=")) return std::stod(s.substr(s.find('=') + 1));
    return 0.0;
  };
  EXPECT_DOUBLE_EQ(step(0), 0.4e-3);
  EXPECT_DOUBLE_EQ(step(1), 0.5e-3);
}

TEST(EstimatePlans, WhatCannotBeEstimatedIsAnError) {
  EXPECT_THROW(plan_of("[solver]\nkind = \"modes\"\n"), SceneError);
  EXPECT_THROW(plan_of("[probes.bodies]\nbody = \"beam\"\nquantity = \"volume\"\n"), SceneError);
}

}  // namespace
}  // namespace fascia::app::estimate_test
