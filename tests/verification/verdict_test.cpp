// What a run says of its end: stable or not, inside out, within tolerance, and what it keeps where it fails.
#include "tests/support/column.hpp"
#include "tests/support/crushed_cube.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/solved_scene.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <tuple>
#include <utility>

namespace fascia::test::verdict_test {
namespace {

/// A scene from text, run to any end.
struct Ended {
  SolvedScene run;

  explicit Ended(const std::string& text, const Settings& settings = {}) : run(SolvedScene::of_text(text, settings)) {}
  const nlohmann::json& summary() const { return run.summary(); }
  bool ok() const { return run.ok(); }
  std::string said() const { return run.status(); }
  std::string message() const { return run.message(); }
  double component(const std::string& probe, int k) const {
    return run.summary()["probes"][probe]["value"][static_cast<std::size_t>(k)].get<double>();
  }
};

TEST(Stability, OfAColumnIsTheSameByFactorAndByConjugateGradients) {
  std::printf("load over Euler's   cholesky        cg\n");
  for (const double part : {0.5, 0.9, 1.1, 2.0, 10.0}) {
    const Ended direct(column(part * kEuler), {"solver.linear.kind='cholesky'", "solver.load_steps=2"});
    const Ended iterative(column(part * kEuler),
                          {"solver.linear.kind='cg'", "solver.load_steps=2", "solver.linear.max_iterations=20000"});
    std::printf("%17.2f   %-12s    %-12s\n", part, direct.said().c_str(), iterative.said().c_str());
    EXPECT_EQ(direct.said(), part < 1 ? "converged" : "unstable") << direct.message();
    EXPECT_EQ(iterative.said(), direct.said()) << iterative.message();
    EXPECT_EQ(direct.ok(), part < 1);
  }
}

/// What a run says of its end: within a hundredth of the lowest stiffness at rest the sign is nobody's to tell.
std::string verdict(const Ended& run) {
  const bool near =
      run.summary().value("warnings", nlohmann::json::array()).dump().find("near a limit point") != std::string::npos;
  return near ? "near" : run.said();
}

/// At a bifurcation the lowest stiffness falls in proportion to the load.
TEST(Stability, NearABifurcationIsToldAlikeByEverySolver) {
  for (const auto& [part, expected] : std::initializer_list<std::pair<double, const char*>>{{0.97, "converged"},
                                                                                            {0.985, "converged"},
                                                                                            {0.993, "near"},
                                                                                            {1.0, "near"},
                                                                                            {1.007, "near"},
                                                                                            {1.015, "unstable"},
                                                                                            {1.03, "unstable"}}) {
    const Ended direct(column(part * kEuler), {"solver.linear.kind='cholesky'"});
    const Ended iterative(column(part * kEuler), {"solver.linear.kind='cg'", "solver.linear.max_iterations=20000"});
    EXPECT_EQ(verdict(direct), expected) << part << " " << direct.message();
    EXPECT_EQ(verdict(iterative), expected) << part << " " << iterative.message();
    EXPECT_EQ(direct.ok(), std::string(expected) != "unstable") << part;
  }
}

/// At a limit point the lowest stiffness falls as the square root of what is left of the load: 22 %, 7 % and 0.2 %
/// here.
TEST(Stability, NearALimitPointIsToldAlikeByEverySolver) {
  std::ifstream file(fascia::test::source_dir().string() + "/scenes/shell_hinged_roof.toml");
  const std::string roof{std::istreambuf_iterator<char>(file), {}};
  for (const auto& [part, expected] : std::initializer_list<std::pair<double, const char*>>{
           {0.95, "converged"}, {0.999, "converged"}, {0.99995, "near"}}) {
    const std::string force = "loads[0].force_per_node=[0, 0, " + std::to_string(-750 * 0.739413 * part) + "]";
    for (const std::string kind : {"cholesky", "cg"}) {
      const Ended run(roof, {"solver.control='load'", force, "solver.linear.kind='" + kind + "'",
                             "solver.linear.max_iterations=20000", "bodies.roof.domain.cylinder.cells=[8, 8]"});
      EXPECT_EQ(verdict(run), expected) << part << " " << kind << " " << run.message();
    }
  }
}

/// A direct solver reaches this state in one iteration from rest: its only tangent was that of rest, which is stable.
/// St Venant-Kirchhoff material with its sides held loses its ellipticity above 0.7 of its length.
TEST(Stability, OfAStateThatOneIterationReachedIsItsOwn) {
  const std::string walls = R"(
[solver]
kind = "static"
[bodies.block]
model = "meshless"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
frames = { grid = [3, 3, 3], kind = "affine" }
density = 1000
material = { young = "1 kPa", poisson = 0.3 }
)";
  std::string sides;
  for (const auto& [axis, least, most] :
       {std::tuple("x", "[-0.01, -1, -1]", "[0.01, 9, 9]"), std::tuple("y", "[-1, -0.01, -1]", "[9, 0.01, 9]"),
        std::tuple("y", "[-1, 0.99, -1]", "[9, 1.01, 9]"), std::tuple("z", "[-1, -1, -0.01]", "[9, 9, 0.01]"),
        std::tuple("z", "[-1, -1, 0.99]", "[9, 9, 1.01]")})
    sides += fmt::format(
        "[[constraints]]\nbody = \"block\"\nwhere = {{ box = {{ min = {}, max = {} }} }}\nfix = [\"{}\", \"rx\", "
        "\"ry\", \"rz\"]\n",
        least, most, axis);
  for (const auto& [shorter, expected] : {std::pair(0.1, "converged"), std::pair(0.3, "unstable")}) {
    const std::string moved = fmt::format(
        "[[constraints]]\nbody = \"block\"\nwhere = {{ box = {{ min = [0.99, -1, -1], max = [1.01, 9, 9] }} }}\n"
        "move = {{ translate = [{}, 0, 0], axes = [\"x\", \"rx\", \"ry\", \"rz\"] }}\n",
        -shorter);
    for (const std::string kind : {"cholesky", "cg"}) {
      const Ended run(walls + sides + moved, {"solver.linear.kind='" + kind + "'"});
      EXPECT_EQ(run.said(), expected) << shorter << " " << kind << " " << run.message();
    }
  }
}

/// A section of 12 x 12 cells, whose factor costs more than all of the solves: conjugate gradients themselves tell.
TEST(Stability, OfALargerColumnIsFoundWithoutAFactor) {
  for (const double part : {0.4, 10.0}) {
    const Ended run(column(part * kEuler), {"bodies.c.order=1", "bodies.c.domain.box.cells=[16, 12, 12]",
                                            "solver.linear.kind='cg'", "solver.linear.max_iterations=20000"});
    EXPECT_EQ(run.said(), part < 1 ? "converged" : "unstable") << run.message();
  }
}

TEST(Stability, TheMessageNamesBodyAndRemedyAndTheSceneMayAccept) {
  const Ended refused(column(2 * kEuler), {"solver.load_steps=2"});
  EXPECT_FALSE(refused.ok());
  for (const char* word : {"unstable", "\"c\"", "arc-length", "accept"})
    EXPECT_NE(refused.message().find(word), std::string::npos) << refused.message();
  const Ended accepted(column(2 * kEuler), {"solver.load_steps=2", "solver.accept=['unstable']"});
  EXPECT_TRUE(accepted.ok());
  EXPECT_EQ(accepted.said(), "converged");
  EXPECT_NE(accepted.summary()["warnings"].dump().find("unstable"), std::string::npos);
}

/// The elastica of Timoshenko and Gere, table 2-4, clamped and free: at 1.063 Euler loads the end turns by 40°, and
/// comes down by 0.119 lengths and goes aside by 0.422.
TEST(Stability, AnImperfectionSetsOffBuckling) {
  const Ended bent(column(1.063 * kEuler), {"solver.imperfection=1e-4"});
  ASSERT_EQ(bent.said(), "converged") << bent.message();
  const double down = -bent.component("tip", 0) / 2,
               aside = std::hypot(bent.component("tip", 1), bent.component("tip", 2)) / 2;
  std::printf("down %.4f (elastica 0.119), aside %.4f (0.422), %d iterations\n", down, aside,
              bent.summary().value("newton_iterations", -1));
  EXPECT_NEAR(down, 0.119, 0.02);
  EXPECT_NEAR(aside, 0.422, 0.03);
  EXPECT_EQ(Ended(column(1), {"solver.imperfection=0.5"}).said(), "refused");
  EXPECT_EQ(Ended(column(1), {"solver.imperfection=1e-4", "constraints[0].where='all'"}).said(), "refused");
}

/// A cube pressed by more than its law can bear, 0.192 E A.
const char* kCrushed = R"(
[bodies.c]
model = "tetrahedra"
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [3, 3, 3] } }
density = 1000
material = { young = 1e6, poisson = 0.3 }
[[constraints]]
body = "c"
where = { box = { min = [-0.1, -1, -1], max = [0.0001, 2, 2] } }
fix = "all"
[[loads]]
body = "c"
where = { box = { min = [0.9999, -1, -1], max = [1.01, 2, 2] } }
total_force = [-1e6, 0, 0]
[solver]
kind = "static"
)";

TEST(Inversion, IsAStatusUnlessTheSceneAcceptsIt) {
  const Ended crushed(kCrushed);
  EXPECT_FALSE(crushed.ok());
  EXPECT_EQ(crushed.said(), "inverted");
  EXPECT_NE(crushed.message().find("inside out"), std::string::npos);
  const Ended accepted(kCrushed, {"solver.accept=['inverted', 'unstable']"});
  EXPECT_TRUE(accepted.ok());
  EXPECT_EQ(accepted.said(), "converged");
}

/// A strand of 1 kPa on bone of 17 GPa under its own weight: 7.85 g hang on the bone.
TEST(Contrast, AStrandOnBoneCarriesItsWeight) {
  const Ended run(R"(
[world]
gravity = [0, -9.81, 0]
[bodies.c]
model = "tetrahedra"
order = 2
domain = { box = { min = [-0.02, -0.0025, -0.0025], max = [0.1, 0.0025, 0.0025], cells = [24, 2, 2] } }
density = 1000
material = [{ where = { box = { min = [-1, -1, -1], max = [0, 1, 1] } }, use = "bone" }, { use = "tissue" }]
[materials.bone]
young = "17 GPa"
poisson = 0.3
[materials.tissue]
young = "1 kPa"
poisson = 0.3
[[constraints]]
body = "c"
where = { box = { min = [-0.1, -1, -1], max = [-0.0199, 2, 2] } }
fix = "all"
[solver]
kind = "static"
accept = ["inverted", "unstable"]
[probes.R]
body = "c"
quantity = "force"
where = { box = { min = [-0.1, -1, -1], max = [-0.0199, 2, 2] } }
)");
  ASSERT_EQ(run.said(), "converged") << run.message();
  const double weight = 0.12 * 0.005 * 0.005 * 1000 * 9.81;
  std::printf("reaction %.9f N, weight %.9f N\n", run.component("R", 1), weight);
  EXPECT_NEAR(run.component("R", 1), weight, 1e-4 * weight);
}

/// A block that spins by 1 rad a step, 1e8 times longer than its vibrations: its momentum is 7.8e-8 N s.
TEST(Momentum, IsKeptOrTheRunHasNotConverged) {
  const std::string text = R"(
[bodies.b]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [1e-3, 1e-3, 1e-3], cells = [2, 2, 2] } }
density = 7800
material = { young = 2e11, poisson = 0.3 }
initial = { velocity = [1e-2, 0, 0], angular_velocity = [0, 0, 0.1] }
[solver]
kind = "implicit-euler"
time_step = 10
steps = 2
[probes.p]
quantity = "momentum"
)";
  for (const char* kind : {"implicit-euler", "midpoint"}) {
    const Ended run(text, {std::string("solver.kind='") + kind + "'"});
    const double p = run.component("p", 0);
    std::printf("%-16s %-14s momentum %.4g of 7.8e-8 N s\n", kind, run.said().c_str(), p);
    EXPECT_TRUE(run.said() != "converged" || std::abs(p - 7.8e-8) < 1e-3 * 7.8e-8) << kind << ": " << p;
  }
}

/// Pressed until J = 0: the states before are kept, and the status says that the run did not end well.
TEST(Failure, KeepsWhatWasComputedBeforeAStateThatCannotBeShown) {
  const Ended run(std::string(kCrushedCube) + kStressProbe);
  EXPECT_FALSE(run.ok());
  EXPECT_EQ(run.said(), "diverged");
  EXPECT_NE(run.message().find("not finite"), std::string::npos) << run.message();
}

/// A neo-Hookean cube whose one face must pass through the other: no state has arrived, and none is an equilibrium,
/// though that at rest balances its forces. A pull that it can follow arrives, with the force of several steps.
TEST(Failure, ABoundaryThatDoesNotArriveIsNotConverged) {
  const auto pushed = [](const std::string& kind, const std::string& cells, double by, int load_steps) {
    return Ended(R"(
[bodies.b]
model = ")" + kind + R"("
domain = { box = { min = [0, 0, 0], max = [0.02, 0.1, 0.1])" +
                     cells +
                     R"( } }
density = 1000
material = { young = 1e5, poisson = 0.3, law = "neo-hookean" }
[[constraints]]
body = "b"
where = { box = { min = [-0.1, -1, -1], max = [0.0001, 1, 1] } }
fix = "all"
[[constraints]]
body = "b"
where = { box = { min = [0.0199, -1, -1], max = [2, 1, 1] } }
move = { translate = [)" +
                     std::to_string(by) +
                     R"(, 0, 0] }
[solver]
kind = "static"
[probes.force]
body = "b"
where = { box = { min = [-0.1, -1, -1], max = [0.0001, 1, 1] } }
quantity = "force"
)" + (kind == "meshless" ? "[bodies.b.frames]\ngrid = [3, 3, 3]\n" : ""),
                 {"solver.load_steps=" + std::to_string(load_steps)});
  };
  for (const std::string kind : {"tetrahedra", "hexahedra", "meshless"}) {
    const std::string cells = kind == "meshless" ? "" : ", cells = [2, 2, 2]";
    const Ended crushed = pushed(kind, cells, -0.025, 1);
    EXPECT_FALSE(crushed.ok()) << kind;
    EXPECT_EQ(crushed.said(), "not-converged") << kind;
    const Ended once = pushed(kind, cells, 0.005, 1), slowly = pushed(kind, cells, 0.005, 4);
    EXPECT_EQ(once.said(), "converged") << kind << once.message();
    EXPECT_LT(once.component("force", 0), -250) << kind;  // 1e5 Pa on 0.01 m2, a quarter longer
    EXPECT_NEAR(once.component("force", 0) / slowly.component("force", 0), 1, 1e-6) << kind;
    std::printf("%-10s %.4f N, in four load steps %.4f N\n", kind.c_str(), once.component("force", 0),
                slowly.component("force", 0));
  }
}

/// One end of a line comes nearer and aside: shifts of an indefinite tangent that start too large do not get there.
TEST(Shifts, ASlackLineIsSolved) {
  const Ended run(R"(
[bodies.c]
model = "meshless"
domain = { line = { from = [0, 0, 0], to = [0.3, 0, 0] } }
radius = 0.0025
frames = { grid = [31] }
density = 1000
material = { young = 1e6, poisson = 0.3 }
[[constraints]]
body = "c"
where = { box = { min = [-0.1, -1, -1], max = [0.0001, 2, 2] } }
fix = "all"
[[constraints]]
body = "c"
where = { box = { min = [0.2999, -1, -1], max = [0.31, 2, 2] } }
move = { translate = [-0.1, 0.1, 0.0] }
[solver]
kind = "static"
accept = ["unstable"]
)");
  EXPECT_EQ(run.said(), "converged") << run.message();
  std::printf("%d iterations\n", run.summary().value("newton_iterations", -1));
  EXPECT_LE(run.summary().value("newton_iterations", 1000), 200);
}

/// Statuses that do not exist, and paths, which go on past unstable states anyway.
TEST(Accept, OfUnknownStatesAndOfPathsIsRefused) {
  EXPECT_EQ(Ended(column(1), {"solver.accept=['bent']"}).said(), "refused");
  EXPECT_EQ(Ended(column(1), {"solver.accept=['unstable']", "solver.control='arc-length'"}).said(), "refused");
}

}  // namespace
}  // namespace fascia::test::verdict_test
