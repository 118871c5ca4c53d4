// Frames of 12 degrees of freedom: accuracy, exactness under rigid and uniform motions, beside rigid frames.
#include "tests/support/cases.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/solved_scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::affine_test {
namespace {

using Grid = std::array<int, 3>;
using Vector = std::array<double, 3>;

std::string affine(const std::string& body) { return "bodies." + body + ".frames.kind='affine'"; }

double largest_entry(const nlohmann::json& value) {
  if (value.is_number()) return std::abs(value.get<double>());
  double largest = value.is_array() ? 0 : INFINITY;
  for (const nlohmann::json& v : value) largest = std::max(largest, largest_entry(v));
  return largest;
}

/// |u - u_ref| / |u_ref| of the soft beam's tip [%]; prints a row.
double soft_error(const Grid& n, const std::string& drilling) {
  const SolvedScene run("affine_cantilever", {grid_setting("beam", n), "bodies.beam.weights.drilling=" + drilling});
  const Vector u = run.vector("tip");
  const double error = 100 * std::hypot(u[0] + 1.5987, u[1] + 6.5096, u[2]) / std::hypot(1.5987, 6.5096);
  std::printf("%2d x %d x %d   %-8s %10.4f %10.4f %8.2f %% %8d\n", n[0], n[1], n[2], drilling.c_str(), u[0], u[1],
              error, run.newton_iterations());
  EXPECT_NEAR(run.vector("support_force")[1], 5 * 9.81, 1e-6);
  return error;
}

/// Within 0.1 points of what was measured before with another program for 0.001, 0.003 and 0.01.
TEST(AffineCantilever, SoftBeam) {
  std::printf("frames        drilling      u_x        u_y      error     Newton   (reference -1.5987, -6.5096)\n");
  const struct {
    Grid grid;
    double bound;
    std::array<double, 3> before;
  } cases[] = {{{9, 3, 3}, 2, {1.10, 1.29, 1.66}}, {{21, 3, 3}, 0.6, {0.42, 0.49, 0.63}}};
  const char* drilling[] = {"0.001", "0.003", "0.01", "0.1"};
  for (const auto& c : cases) {
    double previous = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double error = soft_error(c.grid, drilling[k]);
      if (k == 1) {
        EXPECT_LT(error, c.bound) << "the default";
      }
      if (k < 3) {
        EXPECT_NEAR(error, c.before[k], 0.1);
      }
      EXPECT_GT(error, previous) << "stabilisation stiffens";
      previous = error;
    }
  }
}

TEST(AffineCantilever, DefaultDrillingIsThreeThousandths) {
  const SolvedScene standard("affine_cantilever"), set("affine_cantilever", {"bodies.beam.weights.drilling=0.003"});
  EXPECT_EQ(standard.summary()["probes"].dump(), set.summary()["probes"].dump());
}

/// Signed error of the steel beam's tip against `reference` [%]; prints a row.
double steel_error(const std::string& scene, const Grid& n, double reference, const Settings& more,
                   const std::string& label) {
  Settings settings{grid_setting("beam", n)};
  settings.insert(settings.end(), more.begin(), more.end());
  const SolvedScene run(scene, settings);
  const double sag = -run.vector("tip")[1], error = 100 * (sag / reference - 1);
  std::printf("%2d x %d x %d   %-32s %10.6f %+8.2f %%\n", n[0], n[1], n[2], label.c_str(), sag, error);
  return error;
}

TEST(AffineCantilever, SteelBeamWithOneCellAcross) {
  std::printf("frames        case                                sag [m]   error against 0.15017 m\n");
  const std::pair<const char*, double> cases[] = {{"0.001", -0.87}, {"0.003", -0.93}, {"0.01", -1.04}, {"0.1", -1.60}};
  for (const auto& [drilling, expected] : cases) {
    const double error =
        steel_error("steel_cantilever", {25, 2, 2}, 0.15017,
                    {affine("beam"), std::string("bodies.beam.weights.drilling=") + drilling}, drilling);
    EXPECT_NEAR(error, expected, 0.1);
    if (std::string(drilling) == "0.003") {
      EXPECT_LT(std::abs(error), 1.2);
    }
  }
  steel_error("steel_cantilever", {25, 2, 2}, 0.15017, {}, "rigid frames");
}

TEST(NearlyIncompressible, RigidFramesWithSelectiveIntegration) {
  std::printf("frames        case                                sag [m]   error against 0.150441 m\n");
  for (const char* nu : {"0.49", "0.499"})
    for (const int across : {5, 3}) {
      const double error = steel_error(
          "nearly_incompressible", {25, across, across}, 0.150441,
          {std::string("bodies.beam.material.poisson=") + nu, "bodies.beam.points.integration='selective'"}, nu);
      EXPECT_LT(std::abs(error), across == 5 ? 2 : 7);
    }
}

/// Affine frames hardly lock: everything at every point is right for them; with lambda at one point of a cell they are
/// too soft.
TEST(NearlyIncompressible, AffineFrames) {
  std::printf("frames        case                                sag [m]   error against 0.150441 m\n");
  for (const std::string nu : {"0.49", "0.499"})
    for (const std::string integration : {"auto", "full", "selective"}) {
      const double error = steel_error("nearly_incompressible", {25, 3, 3}, 0.150441,
                                       {affine("beam"), "bodies.beam.material.poisson=" + nu,
                                        "bodies.beam.points.integration='" + integration + "'"},
                                       nu + " " + integration);
      if (integration != "selective") {
        EXPECT_LT(std::abs(error), 3) << integration;
      }
    }
}

struct Turn {
  const char *axis, *angle;
  Vector n;
  double degrees;
};

TEST(AffineMotion, LedByOneEnd) {
  std::printf("turn                           energy/(mu V)   strain    place [m]   Newton\n");
  const Turn turns[] = {{"[0,0,1]", "20 degree", {0, 0, 1}, 20},
                        {"[0,0,1]", "720 degree", {0, 0, 1}, 720},
                        {"[0,1,0]", "700 degree", {0, 1, 0}, 700},
                        {"[1,-2,0.7]", "77 degree", {1, -2, 0.7}, 77}};
  for (const Turn& t : turns) {
    const SolvedScene run("led_by_one_end",
                          {affine("beam"), std::string("constraints[0].move.rotate.axis=") + t.axis,
                           std::string("constraints[0].move.rotate.angle='") + t.angle + "'",
                           "probes.strain={body='beam',at=[[0,0,0],[0.2,0.1,0.1],[1,0.3,0.2]],quantity='strain'}"});
    const double length = std::hypot(t.n[0], t.n[1], t.n[2]), a = t.degrees * std::acos(-1.0) / 180;
    const Vector X{1, 0.15, 0.1}, n{t.n[0] / length, t.n[1] / length, t.n[2] / length}, u = run.vector("end");
    const Vector cross{n[1] * X[2] - n[2] * X[1], n[2] * X[0] - n[0] * X[2], n[0] * X[1] - n[1] * X[0]};
    double place = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = n[0] * X[0] + n[1] * X[1] + n[2] * X[2];
      const double x = X[k] * std::cos(a) + cross[k] * std::sin(a) + n[k] * along * (1 - std::cos(a));
      place = std::hypot(place, X[k] + u[k] - x);
    }
    const double energy = run.number("energy") / (10e3 / 2.6 * 0.06), strain = largest_entry(run.probe("strain"));
    std::printf("%-12s %-17s %14.1e %9.1e %11.1e %8d\n", t.axis, t.angle, energy, strain, place,
                run.newton_iterations());
    EXPECT_LT(energy, 1e-20);
    EXPECT_LT(strain, 1e-9);
    EXPECT_LT(place, 1e-9);
  }
}

/// One end turns against the other by a whole turn: the way counts, though the end is where it was.
TEST(AffineMotion, AWholeTwistIsNotForgotten) {
  const auto energy = [](const char* kind, const char* steps) {
    const SolvedScene run("led_by_one_end",
                          {std::string("bodies.beam.frames={grid=[5,3,3],kind='") + kind + "'}",
                           "constraints=[{body='beam',where={box={min=[-0.01,-1,-1],max=[0.01,1,1]}},fix='all'},"
                           "{body='beam',where={box={min=[0.99,-1,-1],max=[1.01,1,1]}},"
                           "move={rotate={axis=[1,0,0],angle='360 degree',center=[1,0.15,0.1]}}}]",
                           std::string("solver.load_steps=") + steps, "solver.newton.max_iterations=100",
                           "solver.accept=['unstable','inverted']"});
    std::printf("360 degrees, %-6s load_steps = %-6s energy %.6f J, %d Newton iterations\n", kind, steps,
                run.number("energy"), run.newton_iterations());
    return run.number("energy");
  };
  const double rigid = energy("rigid", "'auto'");
  EXPECT_NEAR(energy("rigid", "20") / rigid, 1, 1e-6);
  EXPECT_GT(energy("affine", "'auto'"), 0.2 * rigid) << "affine frames may give way, but not untwist";
}

TEST(AffineDynamics, FreeFallIsTheSchemesWithoutStrain) {
  const SolvedScene run("free_fall", {affine("beam")});
  const double exact = -9.81 * 0.04 * 0.04 * 25 * 26 / 2;
  for (const Vector& u : run.vectors("points")) {
    EXPECT_NEAR(u[1] / exact, 1, 1e-12);
    EXPECT_NEAR(std::hypot(u[0], u[2]), 0, 1e-12);
  }
  std::printf("strain %.1e, energy %.1e J, momentum %.12f of %.12f\n", largest_entry(run.probe("strain")),
              run.number("energy"), run.vector("momentum")[1], -5 * 9.81);
  EXPECT_LT(largest_entry(run.probe("strain")), 1e-12);
  EXPECT_LT(run.number("energy"), 1e-18);
  EXPECT_NEAR(run.vector("momentum")[1] / (-5 * 9.81), 1, 1e-12);
}

/// Implicit Euler keeps the linear momentum; what it loses of the angular momentum falls with the step, and is what
/// rigid frames lose.
TEST(AffineDynamics, ATumblingBoxKeepsItsMomentum) {
  const Vector inertia{2.0 / 12 * (0.16 + 0.04), 2.0 / 12 * (1 + 0.04), 2.0 / 12 * (1 + 0.16)};
  const Vector start{inertia[0] * 0.4, inertia[1] * -0.3, inertia[2] * 3}, momentum{0.6, 0.2, -0.4};
  const auto loss = [&](const Settings& settings, const char* label) {
    const SolvedScene run("tumbling_box", settings);
    const Vector p = run.vector("momentum"), L = run.vector("angular_momentum");
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(p[k], momentum[k], 1e-12);
    const double lost =
        std::hypot(L[0] - start[0], L[1] - start[1], L[2] - start[2]) / std::hypot(start[0], start[1], start[2]);
    std::printf("%-16s angular momentum lost %.3e of itself\n", label, lost);
    return lost;
  };
  const double coarse = loss({affine("box"), "solver.duration=0.4", "solver.time_step=0.01"}, "affine, 10 ms");
  const double fine = loss({affine("box"), "solver.duration=0.4", "solver.time_step=0.005"}, "affine, 5 ms");
  const double rigid = loss({"solver.duration=0.4", "solver.time_step=0.005"}, "rigid, 5 ms");
  EXPECT_NEAR(coarse / fine, 2, 0.2);
  EXPECT_NEAR(fine / rigid, 1, 0.05);
}

/// The third constraint, against sliding, holds a frame of an end face in the scene, and one of the middle here.
TEST(AffineTraction, LateralContractionIsExact) {
  const double exact = std::sqrt(1 - 0.3 * (std::pow(1 + 3e-3 / 6, 2) - 1)) - 1;
  const auto error = [&](const Settings& settings, const char* label) {
    const SolvedScene run("traction_free_ends", settings);
    double largest = 0;
    for (const Vector& u : run.vectors("surface")) largest = std::max(largest, std::abs(u[1] / exact - 1));
    std::printf("%-26s largest error of u_r %.1e, force %.4f N\n", label, largest, run.vector("pull")[0]);
    return largest;
  };
  error({}, "rigid frames");
  EXPECT_LT(error({affine("cylinder"), "constraints[2].where={nearest=[3,0,0]}"}, "affine, held in the middle"), 1e-9);
  EXPECT_LT(error({affine("cylinder")}, "affine, held at the end"), 1e-4);
}

/// Each stops iterating where its own residual is small: a tight tolerance takes that difference away.
TEST(AffineBesideRigid, EachBodyIsTheSameAsAlone) {
  const Settings tight{"solver.newton.tolerance=1e-12"};
  const SolvedScene both("affine_beside_rigid", tight);
  const char *names[] = {"rigid", "affine"}, *others[] = {"affine", "rigid"};
  for (std::size_t k = 0; k < 2; ++k) {
    std::ifstream file(fascia::test::source_dir().string() + "/scenes/affine_beside_rigid.toml");
    std::string text{std::istreambuf_iterator<char>(file), {}}, alone, block;
    const auto keep = [&] {
      if (block.find(std::string("[bodies.") + others[k] + "]") == std::string::npos &&
          block.find(std::string("body = \"") + others[k] + "\"") == std::string::npos)
        alone += block;
      block.clear();
    };
    for (const std::string& line : lines_of(text)) {
      if (line.starts_with("[")) keep();
      block += line + "\n";
    }
    keep();
    const TemporaryFolder folder;
    const std::string path = (folder.path / "alone").string();
    std::ofstream(path + ".toml") << alone;
    const SolvedScene run(path, tight);
    const std::string probe = names[k] + std::string("_tip");
    const Vector a = run.vector(probe), b = both.vector(probe);
    const double d = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / std::hypot(a[0], a[1], a[2]);
    std::printf("%-7s tip (%.6f, %.6f) alone, differs by %.1e beside the other\n", names[k], a[0], a[1], d);
    EXPECT_EQ(run.summary()["bodies"].size(), 1u);
    EXPECT_LT(d, 1e-9);
  }
}

TEST(AffineModes, AFreeGridHasSixZeroFrequencies) {
  std::printf("frames      drilling   number 6 [1/s]   number 7\n");
  for (const Grid& n : {Grid{4, 3, 3}, full_size() ? Grid{7, 5, 5} : Grid{5, 4, 4}})
    for (const char* drilling : {"0.001", "0.003", "0.1", "1"}) {
      const SolvedScene run("free_modes", {affine("block"), grid_setting("block", n),
                                           std::string("bodies.block.weights.drilling=") + drilling});
      const nlohmann::json f = run.probe("frequency");
      ASSERT_EQ(f.size(), 10u);
      std::printf("%d x %d x %d   %-8s %16.1e %10.4f\n", n[0], n[1], n[2], drilling, f[5].get<double>(),
                  f[6].get<double>());
      EXPECT_LT(f[5].get<double>(), 1e-4 * f[6].get<double>());
      EXPECT_GT(f[6].get<double>(), 0.05);
    }
}

}  // namespace
}  // namespace fascia::test::affine_test
