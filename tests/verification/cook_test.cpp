// Cook's membrane, and closed forms of the elastic laws in finite elements and in meshless bodies.
#include "tests/support/solved_scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace fascia::test::cook_test {
namespace {

using Vector = std::array<double, 3>;

SolvedScene run(const std::string& scene, const Settings& settings) { return SolvedScene(scene, settings, 1); }

std::string number(double v) {
  char line[40];
  std::snprintf(line, sizeof line, "%.17g", v);
  return line;
}

double percent(double value, double reference) { return 100 * (value / reference - 1); }

struct Family {
  const char* name;
  const char* model;
  int order;
};
constexpr Family kFamilies[] = {{"8-node hexahedra", "hexahedra", 1},
                                {"20-node hexahedra", "hexahedra", 2},
                                {"4-node tetrahedra", "tetrahedra", 1},
                                {"10-node tetrahedra", "tetrahedra", 2}};

Settings panel(const Family& f, int n) {
  const std::string side = std::to_string(n);
  return {std::string("bodies.panel.model='") + f.model + "'", "bodies.panel.order=" + std::to_string(f.order),
          "bodies.panel.domain.block.cells=[" + side + "," + side + ",1]"};
}

/// Prints how heights grow with the mesh; they must stay below the reference and end near it.
///
/// Displacements converge from below. Corners where held and free edges meet are singular, which limits the order, so
/// that half a percent remains with 32 quadratic elements a side.
void expect_convergence(const char* what, const Family& f, const std::array<double, 3>& heights, double reference) {
  std::printf("%-19s %-22s %9.4f %9.4f %9.4f   %8.4f %+7.2f %%\n", f.name, what, heights[0], heights[1], heights[2],
              reference, percent(heights[2], reference));
  EXPECT_LT(heights[0], heights[1]) << f.name << ", " << what;
  EXPECT_LT(heights[1], heights[2]) << f.name << ", " << what;
  EXPECT_LT(heights[2], reference) << f.name << ", " << what;
  if (f.order == 2) {
    EXPECT_NEAR(heights[2] / reference, 1, 0.005) << f.name << ", " << what;
  }
}

void print_panel_header() {
  std::printf("elements            quantity                8 a side        16        32  reference   error\n");
}

// The reference program's elements are integrated with fewer points, and approach the same values a little faster.
TEST(CookMembrane, LinearPlaneStress) {
  print_panel_header();
  for (const Family& f : kFamilies) {
    std::array<double, 3> middle{}, top{};
    for (std::size_t i = 0; i < 3; ++i) {
      const SolvedScene cook = run("cook_linear", panel(f, 8 << i));
      middle[i] = cook.vector("middle")[1];
      top[i] = cook.vector("top")[1];
    }
    expect_convergence("(48, 52)", f, middle, 23.963);
    expect_convergence("(48, 60)", f, top, 25.178);
  }
}

TEST(CookMembrane, ThicknessDoesNotMatter) {
  std::printf("thickness   u_y(48, 52)\n");
  std::array<double, 2> middle{};
  for (const double t : {0.5, 0.05}) {
    const std::string z = number(t);
    const SolvedScene cook =
        run("cook_linear", {"bodies.panel.domain.block.corners=[[0,0,0],[48,44,0],[48,60,0],[0,44,0],"
                            "[0,0," +
                            z + "],[48,44," + z + "],[48,60," + z + "],[0,44," + z + "]]"});
    middle[t < 0.1] = cook.vector("middle")[1];
    std::printf("%9.2f %13.5f\n", t, middle[t < 0.1]);
  }
  EXPECT_NEAR(middle[0] / middle[1], 1, 1e-4) << "at the held edge alone is the stress not plane";
}

TEST(CookMembrane, PlaneStrain) {
  print_panel_header();
  for (const Family& f : kFamilies) {
    std::array<double, 3> linear{}, large{};
    for (std::size_t i = 0; i < 3; ++i) {
      Settings settings = panel(f, 8 << i);
      large[i] = run("cook_neo_hookean", settings).vector("top")[1];
      settings.insert(settings.end(),
                      {"bodies.panel.formulation='linear'", "materials.panel.law='st-venant-kirchhoff'"});
      linear[i] = run("cook_neo_hookean", settings).vector("top")[1];
    }
    expect_convergence("linear", f, linear, 7.155);
    expect_convergence("neo-Hookean", f, large, 6.1469);
    if (f.order == 2) {
      const double ratio = (large[1] - large[0]) / (large[2] - large[1]);
      const double limit = large[2] + (large[2] - large[1]) / (ratio - 1);
      std::printf("%-19s %-22s %29.4f   %8.4f %+7.2f %%\n", f.name, "its extrapolated limit", limit, 6.1469,
                  percent(limit, 6.1469));
      EXPECT_NEAR(limit / 6.1469, 1, 1e-3) << "three levels do not give more";
    }
  }
}

/// A unit cube, E = 1 kPa, nu = 0.3, of one hexahedron or its tetrahedra, or of eight frames.
struct Cube {
  const char* name;
  const char* body;
  const char* cells;  ///< of its domain
};
constexpr Cube kCubes[] = {
    {"8 nodes", "model = \"hexahedra\"", ", cells = [1, 1, 1]"},
    {"20 nodes", "model = \"hexahedra\"\norder = 2", ", cells = [1, 1, 1]"},
    {"4 nodes", "model = \"tetrahedra\"", ", cells = [1, 1, 1]"},
    {"4 nodes, split 5", "model = \"tetrahedra\"", ", cells = [1, 1, 1], split = 5"},
    {"10 nodes", "model = \"tetrahedra\"\norder = 2", ", cells = [1, 1, 1]"},
    {"meshless", "model = \"meshless\"\nframes = { grid = [2, 2, 2] }\nweights = { drilling = 0 }", ""}};
constexpr double kYoung = 1000, kPoisson = 0.3, kMu = kYoung / (2 * (1 + kPoisson)),
                 kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));

std::string constraint(const std::string& low, const std::string& high, const std::string& what) {
  return "[[constraints]]\nbody = \"cube\"\nwhere = { box = { min = [" + low + "], max = [" + high + "] } }\n" + what +
         "\n";
}

/// @param actions  constraints and loads
SolvedScene run_cube(const Cube& cube, const std::string& law, const std::string& actions) {
  const TemporaryFolder folder;
  const std::string file = (folder.path / "case").string();
  std::string held;
  if (cube.cells[0] == '\0') held = "[[constraints]]\nbody = \"cube\"\nwhere = \"all\"\nfix = \"rotation\"\n";
  std::ofstream(file + ".toml") << "[bodies.cube]\n" + std::string(cube.body) +
                                       "\ndomain = { box = { min = [0, 0, 0], max = [1, 1, 1]" + cube.cells +
                                       " } }\ndensity = 1000\nmaterial = { law = \"" + law +
                                       "\", young = 1000, poisson = 0.3 }\n" + held + actions + R"(
[solver]
kind = "static"
accept = ["unstable", "inverted"]
newton = { tolerance = 1e-12 }
[probes.corner]
body = "cube"
at = [1, 1, 1]
quantity = "displacement"
[probes.stress]
body = "cube"
at = [0.3, 0.6, 0.2]
quantity = "stress"
[probes.volume]
body = "cube"
quantity = "volume"
[probes.force]
body = "cube"
where = { box = { min = [-1, 0.99, -1], max = [2, 2, 2] } }
quantity = "force"
)";
  return run(file, {});
}

/// Three faces slide in their planes.
std::string sliding() {
  return constraint("-1, -0.01, -1", "2, 0.01, 2", "fix = [\"y\"]") +
         constraint("-0.01, -1, -1", "0.01, 2, 2", "fix = [\"x\"]") +
         constraint("-1, -1, -0.01", "2, 2, 0.01", "fix = [\"z\"]");
}

/// The cube stretched along y, its sides free or held.
SolvedScene stretched(const Cube& cube, const std::string& law, double stretch, bool confined) {
  const std::string top = constraint("-1, 0.99, -1", "2, 2, 2",
                                     "move = { translate = [0, " + number(stretch - 1) + ", 0], axes = [\"y\"] }");
  const std::string sides =
      constraint("0.99, -1, -1", "2, 2, 2", "fix = [\"x\"]") + constraint("-1, -1, 0.99", "2, 2, 2", "fix = [\"z\"]");
  return run_cube(cube, law, sliding() + top + (confined ? sides : ""));
}

/// Nominal stress and lateral stretch.
struct Uniaxial {
  double P, side;
};

/// P = mu (l - 1/l) + lambda ln J / l with J = l w^2, where w makes mu (w - 1/w) + lambda ln J / w vanish.
Uniaxial neo_hookean(double l) {
  double low = 0.1, high = 10;  // the lateral force grows with w
  for (int i = 0; i < 200; ++i) {
    const double w = 0.5 * (low + high);
    (kMu * (w * w - 1) + kLambda * std::log(l * w * w) > 0 ? high : low) = w;
  }
  return {kMu * (l - 1 / l) + kLambda * std::log(l * low * low) / l, low};
}

Uniaxial st_venant_kirchhoff(double l) { return {kYoung * l * (l * l - 1) / 2, std::sqrt(1 - kPoisson * (l * l - 1))}; }

/// Prints and checks one value; errors are relative to the exact one.
void compare(const char* body, const char* what, double l, double computed, double exact) {
  std::printf("%-18s %-20s %7.4f %18.10f %18.10f %9.1e\n", body, what, l, computed, exact,
              std::abs(computed / exact - 1));
  EXPECT_NEAR(computed / exact, 1, 1e-9) << body << ", " << what << " at " << l << ": Newton's tolerance is 1e-12";
}

// Below a stretch of 0.62 a cube of ten-node St Venant-Kirchhoff tetrahedra has states of less energy, which are not
// even.
TEST(ElementLaws, UniaxialStress) {
  for (const Cube& cube : kCubes) {
    for (const double l : {0.3, 0.8, 3.0}) {
      const SolvedScene cube_run = stretched(cube, "neo-hookean", l, false);
      const Uniaxial exact = neo_hookean(l);
      compare(cube.name, "neo-Hookean force", l, cube_run.vector("force")[1], exact.P);
      compare(cube.name, "neo-Hookean side", l, 1 + cube_run.vector("corner")[0], exact.side);
    }
    for (const double l : {0.65, 1.5}) {
      const SolvedScene cube_run = stretched(cube, "st-venant-kirchhoff", l, false);
      const Uniaxial exact = st_venant_kirchhoff(l);
      compare(cube.name, "St V.-K. force", l, cube_run.vector("force")[1], exact.P);
      compare(cube.name, "St V.-K. side", l, 1 + cube_run.vector("corner")[0], exact.side);
    }
  }
}

TEST(ElementLaws, Confined) {
  for (const Cube& cube : kCubes)
    for (const double l : {0.5, 2.0}) {
      compare(cube.name, "St V.-K. confined", l, stretched(cube, "st-venant-kirchhoff", l, true).vector("force")[1],
              (kLambda + 2 * kMu) * l * (l * l - 1) / 2);
      compare(cube.name, "neo-Hookean confined", l, stretched(cube, "neo-hookean", l, true).vector("force")[1],
              kMu * (l - 1 / l) + kLambda * std::log(l) / l);
    }
}

// P = mu (F - F^-T) of the neo-Hookean law: the volume does not change. On the top P12 and P22.
TEST(ElementLaws, SimpleShear) {
  for (const Cube& cube : kCubes)
    for (const double g : {0.5, 1.0}) {
      const std::string actions =
          constraint("-1, -0.01, -1", "2, 0.01, 2", "fix = \"position\"") +
          constraint("-1, 0.99, -1", "2, 2, 2",
                     "move = { translate = [" + number(g) + ", 0, 0], axes = [\"x\", \"y\", \"z\"] }");
      // Ten and twenty nodes have some in between, which are held at their share.
      const std::string middle =
          constraint("-1, 0.49, -1", "2, 0.51, 2",
                     "move = { translate = [" + number(g / 2) + ", 0, 0], axes = [\"x\", \"y\", \"z\"] }");
      const bool quadratic = std::string(cube.body).find("order = 2") != std::string::npos;
      const double M = kLambda + 2 * kMu;
      const Vector svk = run_cube(cube, "st-venant-kirchhoff", actions + (quadratic ? middle : "")).vector("force");
      const SolvedScene neo = run_cube(cube, "neo-hookean", actions + (quadratic ? middle : ""));
      compare(cube.name, "St V.-K. shear", g, svk[0], kMu * g + M * g * g * g / 2);
      compare(cube.name, "St V.-K. normal", g, svk[1], M * g * g / 2);
      compare(cube.name, "neo-Hookean shear", g, neo.vector("force")[0], kMu * g);
      compare(cube.name, "its Cauchy stress", g, neo.probe("stress")[0][0].get<double>(), kMu * g * g);
    }
}

// Under a growing dead load St Venant-Kirchhoff has no state beyond -E / (3 sqrt 3), at a stretch of 0.577: the cube
// turns inside out, which the program says. The neo-Hookean one goes on to 0.3.
TEST(ElementLaws, StrongCompression) {
  const auto pushed = [](const Cube& cube, const std::string& law, double P) {
    return run_cube(
        cube, law,
        sliding() +
            "[[loads]]\nbody = \"cube\"\nwhere = { box = { min = [-1, 0.99, -1], max = [2, 2, 2] } }\ntraction = [0, " +
            number(P) + ", 0]\n");
  };
  std::printf("elements           law            P / E    stretch   closed form\n");
  for (const Cube* cube : {&kCubes[0], &kCubes[2]}) {
    for (const double l : {0.7, 0.6}) {
      const double P = st_venant_kirchhoff(l).P,
                   reached = 1 + pushed(*cube, "st-venant-kirchhoff", P).vector("corner")[1];
      std::printf("%-18s St V.-K.    %8.4f %10.6f %10.6f\n", cube->name, P / kYoung, reached, l);
      EXPECT_NEAR(reached, l, 1e-6) << "next to the limit point";
    }
    const SolvedScene beyond = pushed(*cube, "st-venant-kirchhoff", -0.195 * kYoung);
    std::printf("%-18s St V.-K.    %8.4f %10.6f  none\n", cube->name, -0.195, 1 + beyond.vector("corner")[1]);
    EXPECT_LT(beyond.number("volume"), 0);
    EXPECT_EQ(beyond.summary()["warnings"].size(), 1u);
    for (const double l : {0.5, 0.4, 0.3}) {
      const double P = neo_hookean(l).P, reached = 1 + pushed(*cube, "neo-hookean", P).vector("corner")[1];
      std::printf("%-18s neo-Hookean %8.4f %10.6f %10.6f\n", cube->name, P / kYoung, reached, l);
      EXPECT_NEAR(reached, l, 1e-9);
    }
  }
}

}  // namespace
}  // namespace fascia::test::cook_test
