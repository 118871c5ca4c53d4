// What the times of small runs foretell of others.
#include "app/tune/cost_model.hpp"
#include "app/tune/tune_scenes.hpp"
#include "assembly/build/build_simulation.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace fascia::app::cost_model_test {
namespace {

using test::parse;
using test::parse_beam;

constexpr double kPoint = 2e-6, kFactor = 3e-7, kExponent = 1.3, kProduct = 1e-9, kSpread = 9, kWave = 7,
                 kExplicitPoint = 5e-8, kKept = 0.3;

double iterations(double unknowns, double courant) {
  const double still = kSpread * std::cbrt(unknowns);
  return courant > 0 ? std::min(still, 2 + kWave * courant) : still;
}

/// A run of ten Newton iterations that takes exactly what the law says.
CostSample sample(double unknowns, bool factorised, double courant = 0) {
  CostSample s{"frames", factorised, courant > 0};
  s.points = 2 * unknowns;
  s.unknowns = unknowns;
  s.courant = courant;
  s.newton = 10;
  const double n = iterations(unknowns, courant);
  if (!factorised) s.linear = s.newton * n;
  s.setup = 1e-3 + 1e-5 * s.points;
  s.solve =
      s.newton * (kPoint * s.points + (factorised ? kFactor * std::pow(unknowns, kExponent) : kProduct * unknowns * n));
  if (factorised && s.dynamics) s.solve *= kKept;
  return s;
}

CostSample explicit_sample() {
  CostSample s{"frames"};
  s.explicit_steps = 300;
  s.points = 1200;
  s.unknowns = 600;
  s.setup = 1;
  s.solve = s.explicit_steps * s.points * kExplicitPoint;
  return s;
}

KindCost fitted() {
  return fitted_costs({sample(600, true), sample(600, false), sample(3500, true), sample(3500, false),
                       sample(600, true, 0.5), sample(600, false, 0.5), explicit_sample()})
      .kinds.at("frames");
}

TEST(CostModel, FindsTheLawThatItsSamplesKeep) {
  const KindCost cost = fitted();
  EXPECT_NEAR(cost.point, kPoint, 1e-9 * kPoint);
  EXPECT_NEAR(cost.factor, kFactor, 1e-9 * kFactor);
  EXPECT_NEAR(cost.exponent, kExponent, 1e-9);
  EXPECT_NEAR(cost.product, kProduct, 1e-9 * kProduct);
  EXPECT_NEAR(cost.spread, kSpread, 1e-9);
  EXPECT_NEAR(cost.wave, kWave, 1e-9);
  EXPECT_NEAR(cost.step, 1, 1e-9);
  EXPECT_NEAR(cost.kept, kKept, 1e-9);
  EXPECT_NEAR(cost.explicit_point, kExplicitPoint, 1e-9 * kExplicitPoint);
}

/// Statics take a factor up to 10,000 unknowns, and dynamics up to 500. Beyond, steps take conjugate gradients as long
/// as they need few iterations, and both the cheaper of the two where they need more.
TEST(CostModel, TakesTheSolverThatARunTakes) {
  KindCost cost = fitted();
  const auto choice = [&](double unknowns, double courant, LinearMethod method = LinearMethod::automatic) {
    return linear_cost(cost, unknowns, {method, 3, courant, courant > 0});
  };
  EXPECT_TRUE(choice(9000, 0).factorised);
  EXPECT_FALSE(choice(11000, 0).factorised);
  EXPECT_TRUE(choice(400, 0.5).factorised);
  EXPECT_FALSE(choice(9000, 0.5).factorised);
  EXPECT_NEAR(choice(9000, 0.5).seconds, kProduct * 9000 * (2 + kWave * 0.5), 1e-9);
  EXPECT_NEAR(choice(9000, 1e9, LinearMethod::cg).seconds, kProduct * 9000 * kSpread * std::cbrt(9000), 1e-9);
  EXPECT_TRUE(choice(9000, 0.5, LinearMethod::cholesky).factorised);
  EXPECT_NEAR(choice(9000, 0.5, LinearMethod::cholesky).seconds, kFactor * std::pow(9000, kExponent), 1e-9);
  EXPECT_TRUE(linear_cost(cost, 9000, {LinearMethod::automatic, 3, 0.5, false}).factorised);  // followers
  cost.product *= 1e4;                                                                        // a factor is cheaper now
  EXPECT_TRUE(choice(11000, 0).factorised);
  EXPECT_FALSE(choice(9000, 160 / kWave).factorised);
  EXPECT_TRUE(choice(9000, 170 / kWave).factorised);
}

/// Blocks go first where the choice is the program's alone, and where loads have a potential.
TEST(CostModel, BlocksGoFirstWhereNobodySaidOtherwise) {
  const std::string step = "[solver]\nkind = \"newmark\"\ntime_step = \"2 ms\"\nsteps = 3\n";
  const auto first = [&](const std::string& more, bool conservative = true) {
    return linear_use(parse_beam(step + more).solver, 3, 1, conservative).blocks_first;
  };
  EXPECT_TRUE(first(""));
  EXPECT_FALSE(first("", false));
  EXPECT_FALSE(first("linear = { kind = \"cg\" }\n"));
  EXPECT_FALSE(first("linear = { preconditioner = \"jacobi\" }\n"));
  EXPECT_FALSE(first("linear = { max_iterations = 100 }\n"));
  EXPECT_FALSE(linear_use(parse_beam("").solver, 3, 0, true).blocks_first);
}

/// Set-up, and two Newton iterations of each step by the law.
TEST(CostModel, ForetellsARunOfImplicitSteps) {
  CostModel costs;
  KindCost cost = fitted();
  cost.step = 1.5;
  costs.kinds["frames"] = cost;
  const std::string text =
      "[solver]\nkind = \"newmark\"\ntime_step = \"2 ms\"\nsteps = 30\nthreads = 1\nlinear = { kind = \"cg\" }\n";
  const Simulation s = build_simulation(parse_beam(text));
  const auto points = static_cast<double>(s.bodies[0].body->points().size());
  const double dofs = 120, n = std::min(kSpread * std::cbrt(dofs), 2 + kWave * courant_of(s));
  const double iteration = 1.5 * (kPoint * points + kProduct * dofs * n);
  const std::optional<TimeForecast> found = forecast_time(s, costs);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->iterations, 60);
  EXPECT_NEAR(found->seconds, 1e-3 + 1e-5 * points + 60 * iteration, 1e-6 * found->seconds);
  EXPECT_FALSE(forecast_time(s, {}).has_value());
}

/// A factor that the program chose is kept, and one that was asked for is not; nor is one of a few hundred unknowns,
/// but where points take long. It takes the place of slower blocks.
TEST(CostModel, ForetellsWhatAKeptFactorSaves) {
  CostModel costs;
  KindCost& cost = costs.kinds["frames"] = fitted();
  cost.spread = cost.wave = 1e6;  // more iterations than blocks may have
  const auto share = [&](const Scene& scene) {
    const Simulation s = build_simulation(scene);
    const auto points = static_cast<double>(s.bodies[0].body->points().size());
    const double unknowns = s.model.free_dof_count(), iterations = 2.0 * scene.solver.steps;
    return (forecast_time(s, costs)->seconds - 1e-3 - 1e-5 * points) /
           (iterations * (cost.point * points + kFactor * std::pow(unknowns, kExponent)));
  };
  Scene block = parse(tune_scene({"frames", 3, true, true}));
  block.solver.threads = 1;
  block.solver.preconditioner = PreconditionerKind::automatic;
  block.solver.linear = LinearMethod::automatic;
  EXPECT_NEAR(share(block), kKept, 1e-6);
  block.solver.linear = LinearMethod::cholesky;
  EXPECT_NEAR(share(block), 1, 1e-6);
  const Scene small = parse_beam("[solver]\nkind = \"newmark\"\ntime_step = \"2 ms\"\nsteps = 30\nthreads = 1\n");
  EXPECT_NEAR(share(small), 1, 1e-6);
  cost.point = 1;
  EXPECT_NEAR(share(small), kKept, 1e-6);
  cost = fitted();
  cost.product = 1;  // few iterations that take long
  block.solver.linear = LinearMethod::automatic;
  EXPECT_NEAR(share(block), kKept, 1e-6);
}

/// Beside a kept factor the points of each body cost their own kind's share.
TEST(CostModel, ForetellsKeptFactorsOfTwoKindsOfBodies) {
  CostModel costs;
  costs.kinds["frames"] = costs.kinds["tetrahedra"] = fitted();
  costs.kinds["frames"].product = costs.kinds["tetrahedra"].product = 1;
  costs.kinds["tetrahedra"].kept = 0.1 * kKept;
  Scene scene = parse(tune_scene({"frames", 3, true, true}));
  Body second = parse(tune_scene({"tetrahedra", 1, true, true})).bodies[0];
  second.name = "second";
  scene.bodies.push_back(second);
  scene.solver.threads = 1;
  scene.solver.preconditioner = PreconditionerKind::automatic;
  scene.solver.linear = LinearMethod::automatic;
  const Simulation s = build_simulation(scene);
  ASSERT_GT(s.bodies[0].body->node_count(), s.bodies[1].body->node_count());
  const auto first = static_cast<double>(s.bodies[0].body->points().size()),
             other = static_cast<double>(s.bodies[1].body->points().size());
  const double factor = kFactor * std::pow(s.model.free_dof_count(), kExponent);
  const double setup = 1e-3 + 1e-5 * (first + other), iteration = kKept * (kPoint * (first + 0.1 * other) + factor);
  const double found = forecast_time(s, costs)->seconds;
  EXPECT_NEAR(found, setup + 2.0 * scene.solver.steps * iteration, 1e-6 * found);
}

/// An explicit step costs its points' forces, no more.
TEST(CostModel, ForetellsARunOfExplicitSteps) {
  CostModel costs;
  costs.kinds["frames"] = fitted();
  const Simulation s =
      build_simulation(parse_beam("[solver]\nkind = \"explicit\"\ntime_step = \"1 us\"\nsteps = 40\nthreads = 1\n"));
  const auto points = static_cast<double>(s.bodies[0].body->points().size());
  const std::optional<TimeForecast> found = forecast_time(s, costs);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->iterations, 40);
  EXPECT_NEAR(found->seconds, 1e-3 + 1e-5 * points + 40 * kExplicitPoint * points, 1e-6 * found->seconds);
  costs.kinds["frames"].explicit_point = 0;  // not timed
  EXPECT_FALSE(forecast_time(s, costs).has_value());
}

/// Speed of pressure waves × step over the distance of frames: a metre.
TEST(CostModel, KnowsHowFarWavesRunInAStep) {
  const Scene scene = parse_beam("[solver]\nkind = \"newmark\"\ntime_step = \"2 ms\"\nsteps = 3\n");
  const std::string held = "[[constraints]]\nbody = \"beam\"\nwhere = { nearest = [0, 0, 0] }\nfix = \"all\"\n";
  const double density = 5 / 4.0, stiffness = 40e3 * 0.7 / (1.3 * 0.4);
  EXPECT_NEAR(courant_of(build_simulation(scene)), std::sqrt(stiffness / density) * 2e-3, 1e-6);
  EXPECT_EQ(courant_of(build_simulation(parse_beam(held))), 0);
}

TEST(CostModel, ScenesThatAreTimedHaveTheCourantNumberThatTheySay) {
  for (const TuneCase& c : tune_cases(false, 1)) {
    const Simulation simulation = build_simulation(parse(tune_scene(c)));
    const double spread = c.kind == "scattered" ? 0.02 : 0.01;  // Poisson-disk samples are not equally dense
    EXPECT_NEAR(courant_of(c), courant_of(simulation), spread * courant_of(simulation)) << c.kind;
    EXPECT_EQ(courant_of(c) > 0, c.dynamics);
  }
}

}  // namespace
}  // namespace fascia::app::cost_model_test
