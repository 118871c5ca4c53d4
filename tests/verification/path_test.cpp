// Static paths past limit points against closed forms and a published limit load.
#include "tests/support/paths.hpp"
#include "tests/support/solved_scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::test::path_test {
namespace {

/// The bar of snap_through.toml at a size: lengths `scale` times, the load of the same load factor scale² times.
struct Bar {
  double scale = 1;
  double E = 1e7, R = 0.1, h = 0.1, w = 1;
  double L() const { return scale * std::hypot(w, h); }
  double load(double drop) const {
    const double y = scale * h - drop, A = std::numbers::pi * scale * R * scale * R;
    return E * A * y * (scale * scale * h * h - y * y) / (2 * std::pow(L(), 3));
  }
  double limit() const { return load(scale * h * (1 - 1 / std::sqrt(3.0))); }
};

/// Largest deviation of a history of the guide's drop from the curve, over the limit load.
double off_the_curve(const SolvedScene& run, const Bar& bar, double load) {
  double worst = 0;
  for (const auto& row : run.history())
    worst = std::max(worst, std::abs(bar.load(-row[2]) - load * row[0]) / bar.limit());
  return worst;
}

/// Load factors of the limit points that the warnings name.
std::vector<double> limit_points(const SolvedScene& run) {
  std::vector<double> found;
  for (const nlohmann::json& warning : run.summary()["warnings"]) {
    const std::string text = warning, start = "limit point passed at load factor ";
    if (text.starts_with(start)) found.push_back(std::stod(text.substr(start.size())));
  }
  return found;
}

/// Newton's tolerance is relative to the reaction along the bar, ten times the load.
constexpr double kOnTheCurve = 1e-6;

TEST(Path, ABarSnapsThroughOnTheClosedForm) {
  for (const std::string control : {"arc-length", "displacement"}) {
    const SolvedScene run("snap_through", {"solver.control=" + control});
    ASSERT_TRUE(run.ok());
    const double off = off_the_curve(run, {}, 100);
    const std::vector<double> limits = limit_points(run);
    std::printf("bar, %s: %d steps, off the curve by %.1e of the limit load\n", control.c_str(),
                run.summary().value("steps", -1), off);
    EXPECT_LT(off, kOnTheCurve);
    ASSERT_EQ(limits.size(), 2u);
    // Six digits are printed; the step that ends there meets the extremum to second order.
    EXPECT_NEAR(limits[0], Bar{}.limit() / 100, 2e-6);
    EXPECT_NEAR(limits[1], -Bar{}.limit() / 100, 2e-6);
    EXPECT_EQ(run.history().back()[0], 1.0);
    EXPECT_GE(run.history().size(), 6u);
  }
}

TEST(Path, TheLoadMayBeAnyMultipleOfTheLimitLoad) {
  for (const double load : {59.0, 59.564, 1e4, 1e6}) {
    const SolvedScene run("snap_through", {"loads[0].total_force=[0," + std::to_string(-load) + ",0]"});
    ASSERT_TRUE(run.ok());
    EXPECT_LT(off_the_curve(run, {}, load), 1e-8 * std::max(1.0, load));
    EXPECT_EQ(limit_points(run).size(), load < 59.5643 ? 0u : 2u) << load;
    // Below the limit load the first of three equilibria is met.
    if (load < 59.5) {
      EXPECT_GT(run.history().back()[2], -0.0423);
    }
  }
}

TEST(Path, SizeDoesNotMatter) {
  const SolvedScene metres("snap_through");
  for (const double scale : {1e-3, 1e3}) {
    const auto n = [&](double v) { return std::to_string(v * 1e3) + " mm"; };
    const std::string top = "[\"" + n(scale) + "\",\"" + n(0.1 * scale) + "\",0]";
    const SolvedScene run(
        "snap_through",
        {"bodies.bar.domain.line.to=" + top, "bodies.bar.radius=\"" + n(0.1 * scale) + "\"",
         "constraints[1].where.nearest=" + top, "loads[0].where.nearest=" + top, "probes.guide.at=" + top,
         "loads[0].total_force=[0," + std::to_string(-100 * scale * scale) + ",0]"});
    ASSERT_TRUE(run.ok());
    const auto a = metres.history(), b = run.history();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a[i][0], b[i][0], 1e-7);
      EXPECT_NEAR(a[i][2], b[i][2] / scale, 1e-7);
    }
  }
}

TEST(Path, AControlledPointEndsTheRunWhereItShould) {
  const SolvedScene run("snap_through", {"solver.control='displacement'", "solver.load_steps=4",
                                         "solver.controlled={body='bar',at=[1,0.1,0],direction=[0,-2,0],to='0.15 m'}"});
  ASSERT_TRUE(run.ok());
  EXPECT_NEAR(run.history().back()[2], -0.15, 1e-12);
  EXPECT_LT(off_the_curve(run, {}, 100), kOnTheCurve);
}

/// At limit points the tangent is singular, and where the load is 0 nothing is relative to it: the guide's heights
/// h/√3 and −h/√3, 0 and −h.
TEST(Path, AControlledPointMayEndWhereTheLoadIsExtremeOrZero) {
  for (const double height : {0.1 / std::sqrt(3.0), 0.0, -0.1 / std::sqrt(3.0), -0.1})
    for (const char* steps : {"7", "10", "20"}) {
      char to[40];
      std::snprintf(to, sizeof to, "%.17g", 0.1 - height);
      const SolvedScene run(
          "snap_through",
          {"solver.control='displacement'", std::string("solver.load_steps=") + steps,
           std::string("solver.controlled={body='bar',at=[1,0.1,0],direction=[0,-1,0],to=") + to + "}"});
      ASSERT_TRUE(run.ok()) << height << " " << steps;
      EXPECT_NEAR(run.history().back()[2], height - 0.1, 1e-12) << steps;
      EXPECT_NEAR(100 * run.history().back()[0], Bar{}.load(0.1 - height), kOnTheCurve * Bar{}.limit()) << steps;
      EXPECT_LT(run.history().size(), 20U) << "steps";
      EXPECT_LT(off_the_curve(run, {}, 100), kOnTheCurve);
    }
}

/// A load that is there from the start, and one that grows.
TEST(Path, StartsFromTheEquilibriumOfConstantLoads) {
  const SolvedScene run("snap_through",
                        {"loads=[{body='bar',where={nearest=[1,0.1,0]},total_force=[0,-30,0],profile=[[0,1],[1,1]]},"
                         "{body='bar',where={nearest=[1,0.1,0]},total_force=[0,-70,0]}]"});
  ASSERT_TRUE(run.ok());
  for (const auto& row : run.history()) EXPECT_NEAR(Bar{}.load(-row[2]), 30 + 70 * row[0], 60 * kOnTheCurve);
  EXPECT_NEAR(limit_points(run).at(0), (Bar{}.limit() - 30) / 70, 2e-6);
}

/// A prescribed motion grows with the load factor too; past the limit point its force falls.
TEST(Path, FollowsAPrescribedMotion) {
  const SolvedScene run(
      "snap_through",
      {"loads=[]",
       "constraints[1]={body='bar',where={nearest=[1,0.1,0]},move={translate=[0,-0.2,0],axes=['x','y','z','rx','ry']}}",
       "probes.force={body='bar',where={nearest=[1,0.1,0]},quantity='force'}"});
  ASSERT_TRUE(run.ok());
  for (const auto& row : run.history()) {
    EXPECT_NEAR(row[2], -0.2 * row[0], 1e-12);
    EXPECT_NEAR(-row[5], Bar{}.load(-row[2]), 60 * kOnTheCurve);
  }
}

/// Stretch of a St Venant-Kirchhoff bar without lateral contraction: p = E l (1 − l²) / 2 in compression.
double pressure(double E, double l) { return 0.5 * E * l * (1 - l * l); }

TEST(Path, AColumnSnapsBackOnTheClosedForm) {
  const SolvedScene run("snap_back", {}, 1), two("snap_back", {}, 2);
  ASSERT_TRUE(run.ok() && two.ok());
  EXPECT_EQ(run.history(), two.history());
  double worst = 0, farthest = 0, before = 0;
  for (const auto& row : run.history()) {
    const double joint = row[1], end = row[4];
    worst = std::max({worst, std::abs(pressure(1000, 1 + joint / 0.1) - 250 * row[0]),
                      std::abs(pressure(2000, 1 + end - joint) - 250 * row[0])});
    EXPECT_LT(joint, before);  // the soft end alone goes one way
    before = joint;
    farthest = std::max(farthest, row[0] > 0.2 && joint > -0.09 ? -end : 0.0);
  }
  std::printf("column: off the curve by %.1e Pa of 250; turns back at %.4f m (0.1618)\n", worst, farthest);
  EXPECT_LT(worst, 250 * 1e-7);
  EXPECT_LT(farthest, 0.16184);
  EXPECT_GT(farthest, 0.158);
  // The step that ends at a limit point is one of a cubic's extremum: 2e-4 of this coarse step.
  EXPECT_NEAR(limit_points(run).at(0), 1000 / (3 * std::sqrt(3.0)) / 250, 2e-4);
}

/// The far face turns back: displacement control stops there and does not leap to another path.
TEST(Path, DisplacementControlStopsAtSnapBack) {
  const SolvedScene run = SolvedScene::of_file("snap_back", {"solver.control=displacement"});
  EXPECT_EQ(run.status(), "not-converged");
  EXPECT_NE(run.message().find("snap-back"), std::string::npos) << run.message();
  // Past the limit point and short of 0.16183 m, where the load factor is 0.74.
  ASSERT_FALSE(run.history().empty());
  EXPECT_LT(run.history().back()[0], 0.77);
  EXPECT_GT(run.history().back()[0], 0.70);
}

/// DaDeppo and Schmidt, J. Appl. Mech. 42 (1975): a circular arch of 215 degrees, clamped and hinged, inextensible, has
/// its limit load at 8.97 E I / R². Here R = 100, E I = 1e6, E A = 1e8; chords stiffen it, by 0.7 % with 160.
TEST(Path, ADeepArchHasThePublishedLimitLoad) {
  constexpr int kChords = 160;
  const TemporaryFolder folder;
  const double half = 107.5 * std::numbers::pi / 180;
  std::string points, frames, cells, types;
  const auto number = [](double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", v);
    return std::string(text);
  };
  for (int i = 0; i <= kChords; ++i) {
    const double a = half * (2.0 * i / kChords - 1);
    const std::string x = number(100 * std::sin(a)), y = number(100 * std::cos(a));
    points += x + " " + y + " 0\n";
    frames += (i > 0 ? ",[" : "[") + x + "," + y + ",0]";
    if (i > 0) cells += "2 " + std::to_string(i - 1) + " " + std::to_string(i) + "\n";
    if (i > 0) types += "3\n";
  }
  const std::string n = std::to_string(kChords);
  std::ofstream(folder.path / "arch.vtk")
      << "# vtk DataFile Version 3.0\narch\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << kChords + 1 << " double\n"
      << points << "CELLS " << n << " " << 3 * kChords << "\n"
      << cells << "CELL_TYPES " << n << "\n"
      << types;
  const std::string end = number(100 * std::sin(half)), low = number(100 * std::cos(half));
  const auto at = [](const std::string& x, const std::string& y) {
    return "body = \"arch\"\nwhere = { nearest = [" + x + ", " + y + ", 0] }\n";
  };
  std::ofstream(folder.path / "arch.toml")
      << "[bodies.arch]\nmodel = \"meshless\"\ndomain = { file = \"arch.vtk\" }\nradius = 0.2\ndensity = 1000\n"
      << "material = { young = " << number(1e8 / (0.04 * std::numbers::pi)) << ", poisson = 0.3 }\n"
      << "frames = { positions = [" << frames << "] }\n"
      << "[[constraints]]\nbody = \"arch\"\nwhere = \"all\"\nfix = [\"z\", \"rx\", \"ry\"]\n"
      << "[[constraints]]\n"
      << at("-" + end, low) << "fix = \"all\"\n"
      << "[[constraints]]\n"
      << at(end, low) << "fix = [\"x\", \"y\"]\n"
      << "[[loads]]\n"
      << at("0", "100") << "total_force = [0, -905, 0]\n"
      << "[solver]\ncontrol = \"arc-length\"\n"
      << "[probes.crown]\nbody = \"arch\"\nat = [0, 100, 0]\nquantity = \"displacement\"\n";
  const SolvedScene run((folder.path / "arch").string());
  ASSERT_TRUE(run.ok());
  const std::vector<double> limits = limit_points(run);
  ASSERT_EQ(limits.size(), 2u);
  std::printf("arch: limit loads %.2f and %.2f (published 897), %d steps, %d iterations\n", 905 * limits[0],
              905 * limits[1], run.summary().value("steps", -1), run.newton_iterations());
  EXPECT_NEAR(905 * limits[0], 897, 0.01 * 897);
  EXPECT_LT(limits[1], 0);
}

}  // namespace
}  // namespace fascia::test::path_test
