#include "tests/support/paths.hpp"
#include "tests/support/solved_scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

/// What constraints and loads do to bodies whose weights do not interpolate, or whose frames are affine, where a
/// plausible program goes wrong in silence.
namespace fascia::test::constraints_test {
namespace {

constexpr const char* kFrames[] = {"grid = [9, 3, 3]", "grid = [9, 3, 3], kind = \"affine\"", "poisson_disk = 0.12"};

std::string region(double from, double to) {
  return "where = { box = { min = [" + std::to_string(from) + ", -9, -9], max = [" + std::to_string(to) +
         ", 9, 9] } }\n";
}
const std::string kStart = region(-0.001, 0.001), kEnd = region(0.999, 1.001);

/// A bar of 1 × 0.25 × 0.25 m, clamped at x = 0.
std::string bar(const std::string& frames, const std::string& more) {
  return R"([bodies.bar]
model = "meshless"
domain = { box = { min = [0, 0, 0], max = [1, 0.25, 0.25] } }
density = 1000
material = { young = 1e4, poisson = 0.3 }
frames = { )" +
         frames + " }\n[[constraints]]\nbody = \"bar\"\n" + kStart +
         "fix = \"all\"\n[solver]\nkind = \"static\"\n[probes.energy]\nquantity = \"energy\"\n"
         "[probes.turn]\nbody = \"bar\"\nat = [0.5, 0.125, 0.125]\nquantity = \"rotation\"\n" +
         more;
}

/// A rod of length 1 and a radius, clamped at x = 0.
std::string rod(double radius, const std::string& frames, const std::string& fix, const std::string& more) {
  return "[bodies.rod]\nmodel = \"meshless\"\ndomain = { line = { from = [0, 0, 0], to = [1, 0, 0] } }\nradius = " +
         std::to_string(radius) + "\ndensity = 1000\nmaterial = { young = 1e5, poisson = 0.3 }\nframes = { " + frames +
         " }\n[[constraints]]\nbody = \"rod\"\n" + kStart + fix + "\n" + more;
}

std::string move_end(const std::string& motion) { return "[[constraints]]\nbody = \"bar\"\n" + kEnd + motion + "\n"; }

nlohmann::json solve(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "case";
  std::ofstream(file.string() + ".toml") << text;
  const SolvedScene run(file.string());
  return run.summary();
}

double energy(const nlohmann::json& summary) { return SolvedScene::as_number(summary["probes"]["energy"]["value"]); }

/// Half a turn, prescribed on positions alone; and a whole turn of a thinner bar, which no increment tells from none.
TEST(Constraints, ATurnOfPositionsWindsTheBody) {
  const auto turn = [](const char* angle) {
    return move_end(std::string("move = { rotate = { axis = [1, 0, 0], angle = \"") + angle +
                    "\", center = [0, 0.125, 0.125] }, axes = [\"x\", \"y\", \"z\"] }");
  };
  for (const char* frames : kFrames) {
    const nlohmann::json s = solve(bar(frames, turn("180 degree")));
    std::printf("%-36s 180 degrees: %.2f J, %d steps\n", frames, energy(s), s["steps"].get<int>());
    EXPECT_NEAR(energy(s), 10.5, 0.5) << frames;
  }
  std::string thin = bar("grid = [33, 3, 3]", turn("360 degree"));
  const std::string box = "[0, 0, 0], max = [1, 0.25, 0.25]";
  thin.replace(thin.find(box), box.size(), "[0, 0.1, 0.1], max = [1, 0.15, 0.15]");
  const nlohmann::json s = solve(thin);
  const double shear = 1e4 / 2.6, theory = 0.5 * shear * 0.1406 * std::pow(0.05, 4) * std::pow(2 * std::numbers::pi, 2);
  std::printf("thin bar, 360 degrees: %.4f of G J theta^2 / 2, %d steps\n", energy(s) / theory, s["steps"].get<int>());
  EXPECT_NEAR(energy(s) / theory, 1, 0.1) << "the turned positions leave the end free to warp";
  EXPECT_GE(s["steps"].get<int>(), 18) << "about 0.35 rad a step";
}

/// A moved region of a scattered body: as quick as on a grid, and about as stiff.
TEST(Constraints, AMovedScatteredRegionConvergesAsOnAGrid) {
  double grid = 0;
  for (const char* frames : kFrames) {
    const nlohmann::json s = solve(bar(frames, move_end("move = { translate = [0, 0.05, 0] }")));
    std::printf("%-36s %.5f J, %d iterations\n", frames, energy(s), s["newton_iterations"].get<int>());
    if (grid == 0) grid = energy(s);
    EXPECT_NEAR(energy(s) / grid, 1, 0.06) << frames;
    EXPECT_LE(s["newton_iterations"].get<int>(), 8) << frames;
  }
}

TEST(Constraints, ContradictionsOnScatteredMaterialAreRefused) {
  const SolvedScene r =
      SolvedScene::of_text(bar(kFrames[2], move_end("fix = \"position\"") +
                                               move_end("move = { translate = [0.02, 0, 0], axes = [\"x\", \"y\"] }")));
  EXPECT_EQ(r.status(), "refused");
  EXPECT_NE(r.message().find("constraints[2]: prescribes another value than an earlier constraint"), std::string::npos)
      << r.message();
}

/// The torque of a point reaches the section as a torque: half way, no frame knows how it was applied.
TEST(Constraints, APointTorqueTwistsAffineBodiesAsRigidOnes) {
  double rigid = 0;
  for (const char* frames : kFrames) {
    const nlohmann::json s =
        solve(bar(frames, "[[loads]]\nbody = \"bar\"\nat = [1, 0.125, 0.125]\ntorque = [1e-4, 0, 0]\n"));
    const double turn = SolvedScene::as_vector(s["probes"]["turn"]["value"])[0];
    std::printf("%-36s turned by %.4e rad in the middle\n", frames, turn);
    if (rigid == 0) rigid = turn;
    EXPECT_NEAR(turn / rigid, 1, 0.1) << frames;
  }
}

/// Holding all of a region does not depend on the axes in which that is said.
TEST(Constraints, AllIsAllInAnyAxes) {
  for (const char* kind : {"rigid", "affine"}) {
    std::array<double, 3> first{};
    for (const char* axes : {"", "axes = [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]]\n"}) {
      const nlohmann::json s = solve(
          rod(0.05, std::string("poisson_disk = 0.12, kind = \"") + kind + "\"", std::string(axes) + "fix = \"all\"",
              "[[loads]]\nbody = \"rod\"\nat = [1, 0, 0]\nforce = [0, 2e-2, 1e-2]\n[solver]\nkind = \"static\"\n"
              "[probes.tip]\nbody = \"rod\"\nat = [1, 0, 0]\nquantity = \"displacement\"\n"));
      const std::array<double, 3> tip = SolvedScene::as_vector(s["probes"]["tip"]["value"]);
      std::printf("%-8s tip %.8f %.8f %.8f\n", kind, tip[0], tip[1], tip[2]);
      if (*axes == '\0') first = tip;
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(tip[k], first[k], 1e-7 * std::abs(first[1])) << kind;
    }
  }
}

/// Tethers know the size of their body: the same relative answer and no higher floor in millimetres and kilometres.
TEST(Constraints, TethersScaleWithTheBody) {
  double unit = 0;
  for (const double size : {1.0, 1e-3, 1e3}) {
    const auto m = [size](double x) { return std::to_string(x * 1e3 * size) + "e-3"; };
    const auto box = [&](double from, double to) {
      return "where = { box = { min = [" + m(from) + ", " + m(-1) + ", " + m(-1) + "], max = [" + m(to) + ", " + m(1) +
             ", " + m(1) + "] } }\n";
    };
    const nlohmann::json s =
        solve("[bodies.bar]\nmodel = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [" + m(1) + ", " +
              m(0.25) + ", " + m(0.25) +
              "] } }\ndensity = 1000\nmaterial = { young = 1e4, poisson = 0.3 }\nframes = { poisson_disk = " + m(0.12) +
              " }\n[[constraints]]\nbody = \"bar\"\n" + box(-0.1, 0.001) +
              "fix = \"all\"\n[[constraints]]\nbody = \"bar\"\n" + box(0.999, 1.1) + "move = { translate = [0, " +
              m(0.05) + ", 0] }\n[solver]\nkind = \"static\"\n[probes.energy]\nquantity = \"energy\"\n");
    const double relative = energy(s) / (size * size * size);
    std::printf("size %-6g energy / size^3 %.12f, floor %.1e\n", size, relative, s["residual_floor"].get<double>());
    if (size == 1.0) unit = relative;
    EXPECT_NEAR(relative / unit, 1, 1e-4) << "rounding decides ties of the sampling";
    EXPECT_LT(s["residual_floor"].get<double>(), 1e-9);
  }
}

/// Modes of a very slender rod, 1 : 5000: bending is ten orders softer than stretching.
TEST(Constraints, ModesOfAVerySlenderRod) {
  const double theory = std::pow(1.875104069, 2) / (2 * std::numbers::pi) * std::sqrt(1e5 / 1000) * 0.5e-4;
  const std::string solver = "[solver]\nkind = \"modes\"\ncount = 2\n[probes.f]\nquantity = \"frequency\"\n";
  const nlohmann::json grid = solve(rod(1e-4, "grid = [21]", "fix = \"all\"", solver));
  const nlohmann::json scattered = solve(rod(1e-4, "poisson_disk = 0.05", "fix = \"all\"", solver));
  for (const nlohmann::json& s : {grid, scattered}) {
    const nlohmann::json f = s["probes"]["f"]["value"];
    std::printf("f / theory %.6f %.6f\n", f[0].get<double>() / theory, f[1].get<double>() / theory);
    EXPECT_NEAR(f[0].get<double>() / f[1].get<double>(), 1, 1e-6) << "a round rod bends alike in both directions";
  }
  EXPECT_NEAR(grid["probes"]["f"]["value"][0].get<double>() / theory, 1, 2e-3);
  // Scattered lines lock when so thin (12 %), and say so.
  EXPECT_NE(scattered["warnings"].dump().find("clamped bending comes out too stiff"), std::string::npos);
}

/// A bar twisted by a whole turn between too few frames unwinds: zero energy is an equilibrium, and no answer.
TEST(Constraints, ALostTurnIsSaid) {
  std::string twisted =
      bar("grid = [13, 3, 3]", move_end("move = { rotate = { axis = [1, 0, 0], angle = \"360 degree\", "
                                        "center = [0, 0.125, 0.125] } }"));
  const nlohmann::json s = solve(twisted);
  const bool lost = energy(s) < 1e-6;
  std::printf("whole turn of a thick bar: %.3g J, %s\n", energy(s), lost ? "lost" : "kept");
  EXPECT_EQ(s["warnings"].dump().find("snapped to another equilibrium") != std::string::npos, lost);
  const nlohmann::json kept = solve(bar("grid = [13, 3, 3]", move_end("move = { translate = [0, 0.05, 0] }")));
  EXPECT_EQ(kept["warnings"].dump().find("snapped"), std::string::npos);
}

/// Frames that reach no point leave; what remains still carries a rigid motion at any place.
TEST(Constraints, DroppedFramesLeaveNoHoleInTheField) {
  const std::string far =
      "positions = [[0, 0, 0], [1, 0, 0], [0, 0.25, 0], [1, 0.25, 0], [0, 0, 0.25], [1, 0, 0.25], "
      "[0, 0.25, 0.25], [1, 0.25, 0.25], [0.5, 0.125, 0.125], [0.25, 0.12, 0.1], [0.75, 0.1, 0.12], "
      "[0.5, 0.755, 0.125]]";
  std::string moved = bar(far,
                          "[bodies.bar.points]\ncount = 300\n[bodies.bar.weights]\nradius = 0.52\n"
                          "[probes.there]\nbody = \"bar\"\nat = [[0.5, 0.25, 0.125], [0.4, 0.25, 0.2]]\n"
                          "quantity = \"displacement\"\n");
  const std::string held = kStart + "fix = \"all\"";
  moved.replace(moved.find(held), held.size(), region(-1, 2) + "move = { translate = [0.1, 0.2, 0] }");
  const nlohmann::json s = solve(moved);
  EXPECT_EQ(s["status"], "converged");
  EXPECT_EQ(s["bodies"]["bar"]["frames"], 11) << "one of the twelve is out of reach";
  for (const nlohmann::json& u : s["probes"]["there"]["value"]) {
    EXPECT_NEAR(u[0].get<double>(), 0.1, 1e-9);
    EXPECT_NEAR(u[1].get<double>(), 0.2, 1e-9);
  }
}

}  // namespace
}  // namespace fascia::test::constraints_test
