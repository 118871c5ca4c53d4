// Other ways to the same answer, and what the other weights, rules and integrations are worth.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::options_test {
namespace {

using Vector = std::array<double, 3>;

double difference(const Vector& a, const Vector& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / std::hypot(b[0], b[1], b[2]);
}

const Settings kSmall{"bodies.beam.frames.grid=[9,3,3]", "world.gravity=[0,-0.981,0]"};

Settings with(Settings settings, const Settings& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

TEST(Options, ConjugateGradientsAgreeWithCholesky) {
  const SolvedScene direct("soft_cantilever", {"solver.linear.kind='cholesky'"});
  const SolvedScene iterative("soft_cantilever", {"solver.linear.kind='cg'", "solver.linear.max_iterations=5000"});
  const double d = difference(iterative.vector("tip"), direct.vector("tip"));
  std::printf("soft cantilever 21 x 3 x 3: Cholesky (%.9f, %.9f), CG (%.9f, %.9f), difference %.1e; %d CG iterations\n",
              direct.vector("tip")[0], direct.vector("tip")[1], iterative.vector("tip")[0], iterative.vector("tip")[1],
              d, iterative.summary().value("linear_iterations", -1));
  EXPECT_LT(d, 1e-6);
  EXPECT_GT(iterative.summary().value("linear_iterations", 0), 100);
}

TEST(Options, MaterialTangentConvergesToTheSameAnswer) {
  const SolvedScene full("soft_cantilever", kSmall);
  const SolvedScene material("soft_cantilever",
                             with(kSmall, {"solver.tangent='material'", "solver.newton.max_iterations=500"}));
  const double d = difference(material.vector("tip"), full.vector("tip"));
  std::printf("tangent    Newton   u_y [m]\nfull     %8d %12.9f\nmaterial %8d %12.9f   difference %.1e\n",
              full.newton_iterations(), full.vector("tip")[1], material.newton_iterations(), material.vector("tip")[1],
              d);
  EXPECT_LT(d, 1e-6);
}

/// Tip of the steel beam with linear weights against Euler-Bernoulli [%].
double linear_steel_error(int along, const char* weights) {
  const SolvedScene run("steel_cantilever", {grid_setting("beam", {along, 5, 5}), weights});
  return 100 * (-run.vector("tip")[1] / 0.150441 - 1);
}

TEST(Options, LinearWeightsOfTheSteelBeam) {
  std::printf("frames        drilling 0   measured before   default drilling\n");
  const std::pair<int, double> cases[] = {{5, -89}, {9, -68}, {13, -49}, {17, -36}, {25, -21}, {33, -13}, {49, -7.5}};
  for (const auto& [along, expected] : cases) {
    const double plain = linear_steel_error(along, "bodies.beam.weights={kind='linear',drilling=0}");
    const double tied = linear_steel_error(along, "bodies.beam.weights.kind='linear'");
    std::printf("%2d x 5 x 5 %10.2f %% %12.1f %% %14.2f %%\n", along, plain, expected, tied);
    EXPECT_NEAR(plain, expected, 1.0) << along << " frames along";
    EXPECT_LT(tied, plain) << "drilling stiffens";
  }
}

TEST(Options, LinearWeightsOfTheSoftBeam) {
  std::printf("frames        full blend, no drilling   measured before   default   (corner sag against 6.586 m)\n");
  const std::pair<std::array<int, 3>, double> cases[] = {{{9, 3, 3}, -33.9}, {{21, 3, 3}, -10.5}, {{33, 4, 4}, -5.0}};
  double previous = -100;
  for (const auto& [grid, expected] : cases) {
    const auto error = [&g = grid](const char* weights) {
      const SolvedScene run("soft_cantilever", {grid_setting("beam", g), weights, "probes.tip.at=[16,0.5,0.5]"});
      return 100 * (-run.vector("tip")[1] / 6.586 - 1);
    };
    const double full = error("bodies.beam.weights={kind='linear',blend='full',drilling=0}");
    const double standard = error("bodies.beam.weights.kind='linear'");
    std::printf("%2d x %d x %d %18.2f %% %20.1f %% %12.2f %%\n", grid[0], grid[1], grid[2], full, expected, standard);
    EXPECT_NEAR(full, expected, 4.0);
    EXPECT_GT(standard, previous) << "converges from below";
    previous = standard;
  }
}

TEST(Options, PaperRuleTurnsFramesAway) {
  const SolvedScene paper("paper_rule"), half("soft_cantilever", kSmall);
  const auto turned = paper.vectors("axis_rotation"), sound = half.vectors("axis_rotation");
  ASSERT_EQ(turned.size(), 5u);
  std::printf("x [m]     paper's rule (rx, ry, rz) [rad]      default\n");
  double largest = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    std::printf("%4zu   %9.4f %9.4f %9.4f   %9.4f %9.4f %9.4f\n", 4 * i, turned[i][0], turned[i][1], turned[i][2],
                sound[i][0], sound[i][1], sound[i][2]);
    largest = std::max(largest, std::hypot(turned[i][0], turned[i][1]));
    EXPECT_LT(std::hypot(sound[i][0], sound[i][1]), 1e-6);
  }
  std::printf("tip sag: paper's rule %.4f m, default %.4f m, reference 0.75081 m\n", -paper.vector("tip")[1],
              -half.vector("tip")[1]);
  EXPECT_GT(largest, 1.0) << "the frames turn about the beam's axis although nothing twists it";
  EXPECT_NEAR(-paper.vector("tip")[1] / 0.75081, 1.0, 0.05) << "the positions look right all the same";
}

TEST(Options, SelectiveIntegration) {
  struct Case {
    std::array<int, 3> grid;
    const char *poisson, *integration, *drilling;
    double expected;  // measured before, with a drilling stiffness of 0.001 [%]
  };
  const Case cases[] = {
      {{25, 5, 5}, "0.49", "auto", "0.1", 0.7},        {{25, 5, 5}, "0.49", "selective", "0.1", 0.7},
      {{25, 5, 5}, "0.49", "selective", "0.001", 0.7}, {{25, 5, 5}, "0.499", "selective", "0.001", 0.6},
      {{25, 3, 3}, "0.49", "selective", "0.001", 4.8}, {{25, 5, 5}, "0.49", "full", "0.001", -20},
      {{25, 5, 5}, "0.499", "full", "0.001", -46},     {{25, 3, 3}, "0.49", "full", "0.001", -25}};
  std::printf("frames        nu      integration  drilling   sag [m]    error    measured before\n");
  for (const Case& c : cases) {
    const SolvedScene run("nearly_incompressible",
                          {grid_setting("beam", c.grid), std::string("bodies.beam.material.poisson=") + c.poisson,
                           std::string("bodies.beam.points.integration='") + c.integration + "'",
                           std::string("bodies.beam.weights.drilling=") + c.drilling});
    const double sag = -run.vector("tip")[1], error = 100 * (sag / 0.150441 - 1);
    std::printf("%2d x %d x %d   %-6s  %-10s  %-6s %11.6f %+8.2f %% %+7.1f %%\n", c.grid[0], c.grid[1], c.grid[2],
                c.poisson, c.integration, c.drilling, sag, error, c.expected);
    EXPECT_NEAR(error, c.expected, 1.0) << c.integration;
  }
}

TEST(Options, ResultsDoNotDependOnTheUnitOfLength) {
  const double scales[] = {1, 1e-3, 1e3};
  Vector reference{};
  std::printf("length of beam [m]     u_x / L            u_y / L         difference\n");
  for (const double s : scales) {
    const auto list = [s](double x, double y, double z) {
      char text[120];
      std::snprintf(text, sizeof text, "[%.17g,%.17g,%.17g]", x * s, y * s, z * s);
      return std::string(text);
    };
    char mass[64], gravity[64];
    std::snprintf(mass, sizeof mass, "bodies.beam.mass=%.17g", 5 * s * s * s);
    std::snprintf(gravity, sizeof gravity, "world.gravity=[0,%.17g,0]", -9.81 / s);
    const std::string support = "{box={min=" + list(-0.01, -1, -1) + ",max=" + list(0.01, 1, 1) + "}}";
    const SolvedScene run("soft_cantilever",
                          {"bodies.beam.domain.box={min=" + list(0, -0.5, -0.5) + ",max=" + list(16, 0.5, 0.5) + "}",
                           mass, gravity, "constraints[0].where=" + support, "probes.support_force.where=" + support,
                           "probes.tip.at=" + list(16, 0, 0), "probes.tip_rotation.at=" + list(16, 0, 0),
                           "probes.axis_rotation.at=" + list(8, 0, 0), "solver.newton.tolerance=1e-11"});
    Vector u = run.vector("tip");
    for (double& c : u) c /= 16 * s;
    if (s == 1) reference = u;
    const double d = difference(u, reference);
    std::printf("%14.3g %22.14f %18.14f %12.1e\n", 16 * s, u[0], u[1], d);
    EXPECT_LT(d, 1e-9);
  }
}

}  // namespace
}  // namespace fascia::test::options_test
