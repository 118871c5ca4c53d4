// Bosman, Duriez and Cotin 2014, figures 3, 6, 7 and 8: beams under their own weight.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::cantilever_test {
namespace {

using Grid = std::array<int, 3>;
using Vector = std::array<double, 3>;

constexpr double kEulerBernoulli = 0.150441, kSolid = 0.15017;  // tip of the steel beam [m]

/// Signed error of the steel beam's tip against Euler-Bernoulli [%]; prints a row.
double steel_error(const Grid& grid) {
  const SolvedScene run("steel_cantilever", {grid_setting("beam", grid)});
  const double sag = -run.vector("tip")[1];
  const double error = 100 * (sag / kEulerBernoulli - 1);
  std::printf("%2d x %d x %d   %10.6f   %8.6f %+7.2f %%   %7.5f %+7.2f %%\n", grid[0], grid[1], grid[2], sag,
              kEulerBernoulli, error, kSolid, 100 * (sag / kSolid - 1));
  return error;
}

void print_steel_header() { std::printf("frames       sag [m]      beam                   solid\n"); }

TEST(SteelCantilever, Sections) {
  print_steel_header();
  const double expected[] = {-9.9, -3.7, -2.2, -1.65, -1.4};
  for (int n = 2; n <= 6; ++n) {
    const double error = steel_error({25, n, n});
    EXPECT_NEAR(error, expected[n - 2], 0.5) << n << " frames across";
    if (n >= 3) {
      EXPECT_LT(std::abs(error), 4.0);
    }
  }
}

TEST(SteelCantilever, AlongTheLength) {
  print_steel_header();
  const int along[] = {5, 9, 13, 17, 25, 33, 49, 65};
  const double expected[] = {-5.8, -3.0, -2.3, -2.0, -1.65, -1.5, -1.3, -1.2};
  double previous = -100;
  for (std::size_t i = 0; i < std::size(along); ++i) {
    const double error = steel_error({along[i], 5, 5});
    EXPECT_NEAR(error, expected[i], 0.5) << along[i] << " frames along";
    EXPECT_GT(error, previous) << "the sag must grow towards the reference with every refinement";
    EXPECT_LT(error, 0);
    previous = error;
  }
}

/// Rest positions of all frames, in the order of x, y, z loops, as a TOML list.
std::string frame_positions(const Grid& n) {
  std::string list = "[";
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        char text[96];
        std::snprintf(text, sizeof text, "%s[%.10g,%.10g,%.10g]", list.size() > 1 ? "," : "", 16.0 * i / (n[0] - 1),
                      -0.5 + 1.0 * j / (n[1] - 1), -0.5 + 1.0 * k / (n[2] - 1));
        list += text;
      }
  return list + "]";
}

/// Unit quaternion (w, x, y, z) of a rotation vector.
std::array<double, 4> quaternion(const Vector& r) {
  const double angle = std::hypot(r[0], r[1], r[2]), s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), s * r[0], s * r[1], s * r[2]};
}

double angle_between(const Vector& a, const Vector& b) {
  const auto p = quaternion(a), q = quaternion(b);
  double sum = 0, difference = 0;  // |p - q| is accurate where acos(p · q) is not
  for (std::size_t i = 0; i < 4; ++i) {
    sum += (p[i] + q[i]) * (p[i] + q[i]);
    difference += (p[i] - q[i]) * (p[i] - q[i]);
  }
  return 4 * std::atan2(std::sqrt(std::min(sum, difference)), std::sqrt(std::max(sum, difference)));
}

/// Largest rotation of a frame against a neighbour along a grid line [rad].
double largest_turn(const std::vector<Vector>& rotations, const Grid& n) {
  const int stride[3] = {1, n[0], n[0] * n[1]};
  double largest = 0;
  for (int f = 0; f < static_cast<int>(rotations.size()); ++f) {
    const int index[3] = {f % n[0], f / n[0] % n[1], f / (n[0] * n[1])};
    for (std::size_t a = 0; a < 3; ++a)
      if (index[a] + 1 < n[a])
        largest = std::max(largest, angle_between(rotations[static_cast<std::size_t>(f)],
                                                  rotations[static_cast<std::size_t>(f + stride[a])]));
  }
  return largest;
}

/// |u - u_ref| / |u_ref| of the tip's centre [%].
double tip_error(const Vector& tip, double x, double y) {
  return 100 * std::hypot(tip[0] - x, tip[1] - y, tip[2]) / std::hypot(x, y);
}

struct SoftCase {
  Grid grid;
  double bound;  // [%]; infinite: the issue sets none for this grid
};

TEST(SoftCantilever, FullLoad) {
  std::printf(
      "frames          u_x [m]    u_y [m]   reference (-1.5987, -6.5096)   error   Newton  tip [rad]  neighbours "
      "[rad]\n");
  const SoftCase cases[] = {{{9, 3, 3}, 5}, {{21, 3, 3}, 3.5}, {{33, 4, 4}, INFINITY}, {{65, 5, 5}, 1.5}};
  double previous = 100;
  for (const auto& [grid, bound] : cases) {
    const SolvedScene run("soft_cantilever",
                          {grid_setting("beam", grid), "probes.axis_rotation.at=" + frame_positions(grid)});
    const Vector tip = run.vector("tip");
    const double error = tip_error(tip, -1.5987, -6.5096), turn = largest_turn(run.vectors("axis_rotation"), grid);
    const double slope = run.vector("tip_rotation")[2];
    std::printf("%2d x %d x %d   %10.5f %10.5f %35.2f %% %7d %10.4f %10.4f\n", grid[0], grid[1], grid[2], tip[0],
                tip[1], error, run.newton_iterations(), slope, turn);
    EXPECT_LE(error, bound);
    EXPECT_LT(error, previous);
    EXPECT_LE(run.newton_iterations(), 60);
    EXPECT_NEAR(slope, -0.54, 0.02);
    EXPECT_LE(turn, 0.3);
    EXPECT_NEAR(run.vector("support_force")[1], 5 * 9.81, 1e-6);
    previous = error;
  }
}

TEST(SoftCantilever, SmallerLoadAndStifferMaterial) {
  const Grid grid{33, 4, 4};
  struct Case {
    const char* name;
    std::string setting;
    double x, y;
  };
  const Case cases[] = {{"g/10", "world.gravity=[0,-0.981,0]", -0.020134, -0.75081},
                        {"160 kPa", "materials.silicone.young='160 kPa'", -0.12403, -1.86025}};
  std::printf("33 x 4 x 4       u_x [m]     u_y [m]    reference [m]            error\n");
  for (const Case& c : cases) {
    const SolvedScene run("soft_cantilever", {grid_setting("beam", grid), c.setting});
    const Vector tip = run.vector("tip");
    const double error = tip_error(tip, c.x, c.y);
    std::printf("%-12s %11.6f %11.6f   (%.6f, %.5f) %7.2f %%\n", c.name, tip[0], tip[1], c.x, c.y, error);
    EXPECT_LE(error, 2.5) << c.name;
  }
}

TEST(ThreeBeams, StifferHangsLess) {
  const SolvedScene run("three_beams");
  const double young[] = {50e3, 100e3, 500e3};
  const char* names[] = {"soft", "medium", "stiff"};
  double previous = 1;
  std::printf("Young [kPa]   sag [m]   small-deflection beam [m]\n");
  for (std::size_t i = 0; i < 3; ++i) {
    const double sag = -run.vector(names[i] + std::string("_tip"))[1];
    const double beam = 0.3 * 9.81 / (8 * young[i] * 1e-4 / 12);
    std::printf("%8.0f %12.4f %15.4f\n", young[i] / 1e3, sag, beam);
    EXPECT_LT(sag, previous);
    EXPECT_LT(sag, beam) << "a large deflection stiffens";
    EXPECT_EQ(run.summary()["bodies"][names[i]]["points"], 20 * 36) << "36 points in each of 20 planes";
    EXPECT_NEAR(run.summary()["bodies"][names[i]]["mass"].get<double>(), 0.3, 1e-12);
    previous = sag;
  }
  const double sag = -run.vector("stiff_tip")[1], beam = 0.3 * 9.81 / (8 * 500e3 * 1e-4 / 12);
  EXPECT_NEAR(sag / beam, 1.0, 0.06) << "the stiff beam is close to small-deflection theory";
}

}  // namespace
}  // namespace fascia::test::cantilever_test
