// Statics in which rounding leaves much of the loads, and nothing of the answer.
#include "tests/support/solved_scene.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace fascia::test::rounding_test {
namespace {

/// A cantilever of frames through the thickness, 0.1 × 0.03 m and thinner, in other units of length and force.
SolvedScene plate(double thickness, double load, double metre, const std::string& more = "") {
  const auto of = [&](double x) { return fmt::format("{:.17g}", x * metre); };
  const std::string held = "box = { min = [-1e9, -1e9, -1e9], max = [" + of(1e-6) + ", 1e9, 1e9] }";
  return SolvedScene::of_text(fmt::format(R"(
[bodies.plate]
model = "meshless"
domain = {{ box = {{ min = [0, 0, 0], max = [{}, {}, {}] }} }}
frames = {{ grid = [9, 3, 3] }}
density = 1000
material = {{ young = 1e4, poisson = 0.3 }}
[solver]
kind = "static"
linear = {{ kind = "cholesky" }}
[[constraints]]
body = "plate"
where = {{ {} }}
{}
[[loads]]
body = "plate"
where = {{ box = {{ min = [{}, -1e9, -1e9], max = [1e9, 1e9, 1e9] }} }}
total_force = [0, 0, {:.17g}]
[probes.tip]
body = "plate"
quantity = "displacement"
at = [{}, {}, {}]
[probes.support]
body = "plate"
quantity = "force"
where = {{ {} }}
)",
                                          of(0.1), of(0.03), of(thickness), held, more.empty() ? "fix = \"all\"" : more,
                                          of(0.0999), load * metre * metre, of(0.1), of(0.015), of(0.5 * thickness),
                                          held));
}

double component(const SolvedScene& run, const char* probe) {
  return run.summary()["probes"][probe]["value"][2].get<double>();
}

/// 1,000 times as long as thick: rounding leaves 6e-4 of the load. Runs in other units, whose digits have nothing in
/// common, agree, and so do their reactions with the load.
TEST(Rounding, OfASlenderSolidMovesNothing) {
  const SolvedScene one = plate(1e-4, -7.5e-11, 1), other = plate(1e-4, -7.5e-11, 37.31);
  for (const SolvedScene* run : {&one, &other}) {
    EXPECT_EQ(run->status(), "converged") << run->message();
    EXPECT_LE(run->summary().value("newton_iterations", 1000), 8);
    EXPECT_GT(run->summary().value("residual", 0.0), 1e-4) << "rounding leaves no more than it may excuse anyway";
  }
  EXPECT_NEAR(component(other, "tip") / (37.31 * component(one, "tip")), 1, 1e-8);
  EXPECT_NEAR(component(one, "support") / 7.5e-11, 1, 1e-7);
}

/// 10,000 times as long as thick it hides the stiffness; and a motion of all of the plate, however much work its load
/// does along it, is no measure of what rounding may leave.
TEST(Rounding, IsNotExcusedByWhatItHides) {
  EXPECT_EQ(plate(1e-5, -7.5e-14, 1).status(), "not-converged");
  const SolvedScene moved = plate(1e-4, -7.5e-11, 1, "move = { translate = [0, 0, -100] }");
  EXPECT_EQ(moved.status(), "not-converged");
  EXPECT_NE(moved.message().find("rounding leaves"), std::string::npos) << moved.message();
}

/// A plate whose triangles at one end are 2,000 times as long as wide is one part: areas are no stiffness. Of parts by
/// areas the tip would be one, and rounding 1 % of its weight.
TEST(Rounding, SmallTrianglesAreNoPartOfTheirOwn) {
  const SolvedScene run = SolvedScene::of_text(R"(
[bodies.plate]
model = "shell"
domain = { annulus = { center = [0.10001, 0, 0], normal = [0, 0, 1], inner = 1e-5, outer = 0.10001, angle = ["150 degree", "210 degree"], cells = [8, 2] } }
thickness = 0.0025
density = 1000
material = { young = 1e4, poisson = 0.3 }
[[constraints]]
body = "plate"
where = { group = "outer" }
fix = "all"
[world]
gravity = [0, 0, -4e-4]
[solver]
kind = "static"
linear = { kind = "cholesky" }
[probes.tip]
body = "plate"
quantity = "displacement"
at = [0.1, 0, 0]
)");
  EXPECT_EQ(run.status(), "converged") << run.message();
}

}  // namespace
}  // namespace fascia::test::rounding_test
