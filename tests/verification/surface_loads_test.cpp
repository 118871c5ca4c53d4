// Pressure, fluids and loads on edges: closed forms and balances.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::test::surface_loads_test {
namespace {

constexpr double kCavity = 5.229826088854298e-4;  // at rest [m³]; 0.1 % below the sphere's

double sum_of_squares(const std::array<double, 3>& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

TEST(HollowSphere, SwellsAsLameSays) {
  const SolvedScene run("hollow_sphere");
  const double a = 0.05, b = 0.1, p = 10, E = 1e5, nu = 0.3;
  const auto exact = [&](double r) {
    return p * a * a * a / (b * b * b - a * a * a) * ((1 - 2 * nu) / E * r + (1 + nu) / (2 * E) * b * b * b / (r * r));
  };
  const double inside = run.vector("inside")[0], outside = -run.vector("outside")[2];
  std::printf("radius   u [m]          Lamé [m]       error\n");
  std::printf("0.05     %.6e  %.6e  %+.2f %%\n", inside, exact(a), 100 * (inside / exact(a) - 1));
  std::printf("0.10     %.6e  %.6e  %+.2f %%\n", outside, exact(b), 100 * (outside / exact(b) - 1));
  EXPECT_NEAR(inside / exact(a), 1, 0.006);  // the mesh: 0.5 %, 0.1 % with twice as many elements along each edge
  EXPECT_NEAR(outside / exact(b), 1, 0.006);
  EXPECT_EQ(run.number("pressure"), p);
  const double grown = run.number("cavity") - kCavity, thin = 4 * std::numbers::pi * a * a * inside;
  std::printf("growth of the cavity %.4e m3, 4 pi a2 u %.4e m3\n", grown, thin);
  EXPECT_NEAR(grown / thin, 1, 2e-3);  // the cavity of the mesh is 0.1 % smaller
  EXPECT_EQ(run.summary()["bodies"]["ball"]["fluid"]["volume"].get<double>(), run.number("cavity"));
}

TEST(HollowSphere, DoublesItsVolumeInAFewIterations) {
  for (const char* modulus : {"1e4", "1e6", "1e9"}) {
    const SolvedScene run("hollow_sphere",
                          {"materials.rubber.law=\"neo-hookean\"",
                           std::string("bodies.ball.fluid={bulk_modulus=") + modulus + ",volume=\"1 litre\"}"});
    std::printf("K = %s Pa: %d iterations, %.6f litre, %.1f Pa\n", modulus, run.newton_iterations(),
                1e3 * run.number("cavity"), run.number("pressure"));
    EXPECT_LE(run.newton_iterations(), 6);
    EXPECT_NEAR(run.number("pressure"), std::stod(modulus) * (1 - run.number("cavity") / 1e-3),
                1e-9 * std::stod(modulus));
  }
}

TEST(FilledBall, KeepsItsVolumeAndCarriesItsWeight) {
  const SolvedScene run("filled_ball");
  const double water = run.number("water"), at_rest = kCavity;
  const double support = run.vector("bottom")[2] + run.vector("top")[2];
  const double weight = 9.81 * (run.summary()["bodies"]["ball"]["mass"].get<double>() + 1000 * water);
  std::printf("volume %.9f of what it was; support %.9f N, weight %.9f N\n", water / at_rest, support, weight);
  EXPECT_NEAR(water / at_rest, 1, 5e-6);  // p / K = 1.1e-6
  EXPECT_NEAR(support / weight, 1, 1e-8);
  EXPECT_LE(run.newton_iterations(), 8);
}

TEST(FilledBall, DoesNotDependOnTheLinearSolverNorOnThreads) {
  const SolvedScene direct("filled_ball", {}, 1), threads("filled_ball", {}, 2),
      cg("filled_ball", {"solver.linear.kind=\"cg\""});
  EXPECT_EQ(direct.history(), threads.history());
  const auto a = direct.vector("side"), b = cg.vector("side");
  std::printf("CG: %d Newton iterations; Cholesky: %d\n", cg.newton_iterations(), direct.newton_iterations());
  EXPECT_LT(sum_of_squares({a[0] - b[0], a[1] - b[1], a[2] - b[2]}), 1e-12 * sum_of_squares(a));
  EXPECT_NEAR(cg.number("pressure") / direct.number("pressure"), 1, 1e-5);
}

/// The stable step knows the volume's stiffness, and what settles is the static state.
TEST(FilledBall, SettlesInExplicitDynamics) {
  const Settings fluid{"materials.rubber.law=\"neo-hookean\"",
                       "bodies.ball.fluid={bulk_modulus=1e6,volume=\"0.6 litre\",over=0.2,profile=\"smooth\"}"};
  const SolvedScene still("hollow_sphere", fluid);
  Settings moving = fluid;
  moving.insert(moving.end(),
                {"solver={kind=\"explicit\",time_step=\"auto\",duration=0.4}", "materials.rubber.damping={mass=50}"});
  const SolvedScene run("hollow_sphere", moving);
  std::printf("static %.6e m, explicit %.6e m\n", still.vector("inside")[0], run.vector("inside")[0]);
  EXPECT_NEAR(run.vector("inside")[0] / still.vector("inside")[0], 1, 1e-3);
  EXPECT_NEAR(run.number("pressure") / still.number("pressure"), 1, 1e-3);
}

constexpr const char* kElements =
    "domain={box={min=[0,0,0],max=[1,1,1],cells=[3,3,3]}},density=1000,material=\"rubber\"}";

TEST(PressedBlock, StressIsThePressureEverywhere) {
  const std::string frames = "density=1000,material=\"rubber\",domain={box={min=[0,0,0],max=[1,1,1]}},frames=";
  for (const std::string& body :
       {"{model=\"meshless\"," + frames + "{grid=[4,4,4]}}",
        "{model=\"meshless\"," + frames + "{grid=[4,4,4],kind=\"affine\"}}",
        std::string("{model=\"tetrahedra\",") + kElements, std::string("{model=\"tetrahedra\",order=2,") + kElements,
        std::string("{model=\"hexahedra\",") + kElements, std::string("{model=\"hexahedra\",order=2,") + kElements}) {
    const SolvedScene run("pressed_block", {"bodies.block=" + body});
    double largest = 0;
    for (const auto& stress : run.probe("stress"))
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          largest = std::max(largest, std::abs(stress[i][j].get<double>() + (i == j ? 2e4 : 0)));
    std::printf("%-60.60s stress within %.1e Pa, %d iterations\n", body.c_str(), largest, run.newton_iterations());
    EXPECT_LT(largest, 2e4 * 1e-7);  // Newton's tolerance, 1e-8 of all forces together
  }
}

/// A pressure on one face that follows it is a dead one turned with it.
TEST(PressedBlock, FollowsAFaceThatTurns) {
  const Settings turned{
      std::string("bodies.block={model=\"hexahedra\",") + kElements,
      "constraints=[{body=\"block\",where={box={min=[-1,-1,-1],max=[1e-6,2,2]}},move={rotate={axis=[0,0,1],angle="
      "\"90 degree\"}}}]",
      "loads=[{body=\"block\",where={box={min=[0.99,-1,-1],max=[2,2,2]}},pressure=1}]"};
  const SolvedScene run("pressed_block", turned);
  const auto foot = run.vector("foot");  // the face x = 1 looks along y in the end; pushed back, it is held forward
  std::printf("support (%.6f, %.6f, %.6f) N\n", foot[0], foot[1], foot[2]);
  EXPECT_NEAR(foot[0], 0, 1e-5);  // 1 Pa strains the block by 1e-5
  EXPECT_NEAR(foot[1], 1, 3e-5);
  EXPECT_NEAR(foot[2], 0, 1e-5);
}

/// A torque about an axis that turns with the material, on frames and on vertices.
TEST(PressedBlock, FollowerTorqueTurnsWithTheMaterial) {
  const std::string frames =
      "{model=\"meshless\",density=1000,material=\"rubber\",domain={box={min=[0,0,0],max=[1,1,1]}},frames=";
  for (const std::string& body : {frames + "{grid=[4,4,4]}}", frames + "{grid=[4,4,4],kind=\"affine\"}}",
                                  std::string("{model=\"hexahedra\",") + kElements})
    for (const bool follower : {true, false}) {
      const SolvedScene run(
          "pressed_block",
          {"bodies.block=" + body,
           "constraints=[{body=\"block\",where={box={min=[-1,-1,-1],max=[1e-6,2,2]}},move={rotate={axis=[0,0,1],"
           "angle=\"90 degree\"}}}]",
           std::string("loads=[{body=\"block\",where={box={min=[0.99,-1,-1],max=[2,2,2]}},total_torque=[1,0,0],"
                       "follower=") +
               (follower ? "true" : "false") + "}]"});
      const auto twist = run.vector("twist");
      std::printf("follower %d: support's moment (%.6f, %.6f, %.6f) N m\n", static_cast<int>(follower), twist[0],
                  twist[1], twist[2]);
      if (follower) {
        EXPECT_NEAR(twist[0], 0, 1e-3);  // the face warps, and its forces turn with their own places
        EXPECT_NEAR(twist[1], -1, 1e-3);
      } else {
        EXPECT_NEAR(twist[1], -0.5, 1e-3);  // half of the couple's arms shrink to nothing
      }
    }
}

TEST(LineForce, IsTheForceTimesTheLengthOfTheEdges) {
  const std::string sheet =
      "bodies.block={model=\"meshless\",density=1000,material={young=1e5,poisson=0.3},thickness=0.05,"
      "domain={rectangle={origin=[0,0,0],edge_u=[1,0,0],edge_v=[0,0.4,0]}},frames={grid=[6,4]}}";
  const std::string clamp = "constraints=[{body=\"block\",where={box={min=[-1,-1,-1],max=[1e-6,2,2]}},fix=\"all\"}]";
  const auto support = [&](const std::string& body, const std::string& min, const std::string& more) {
    return SolvedScene("pressed_block", {body, clamp,
                                         "loads=[{body=\"block\",where={box={min=" + min +
                                             ",max=[2,2,2]}},line_force=[0,0,0.01]" + more + "}]",
                                         "probes.stress.at=[0.5,0.2,0]"})
        .vector("foot");
  };
  EXPECT_NEAR(support(sheet, "[0.99,-1,-1]", "")[2], -0.004, 1e-9);
  // The inner edges beside the free ones do not count: 0.4 + 2 · 0.2 m.
  EXPECT_NEAR(support(sheet, "[0.79,-1,-1]", "")[2], -0.008, 1e-9);
  const std::string block = std::string("bodies.block={model=\"hexahedra\",") + kElements;
  EXPECT_NEAR(support(block, "[0.99,-1,0.99]", "")[2], -0.01, 1e-9);
  // A follower keeps its size.
  const auto f = support(sheet, "[0.99,-1,-1]", ",follower=true");
  EXPECT_NEAR(std::sqrt(sum_of_squares(f)), 0.004, 1e-7);
  EXPECT_GT(std::abs(f[0]), 1e-6);
}

}  // namespace
}  // namespace fascia::test::surface_loads_test
