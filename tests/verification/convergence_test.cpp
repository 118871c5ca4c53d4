// Error against the spacing of the frames.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::convergence_test {
namespace {

constexpr double kLength = 2, kYoung = 40e3, kPoisson = 0.3;
constexpr double kModulus = kYoung * (1 - kPoisson) / ((1 + kPoisson) * (1 - 2 * kPoisson));  // lambda + 2 mu

/// Stretch of the hanging column at X: modulus l (l^2 - 1) / 2 = rho g (L - X).
double stretch(double X) {
  double l = 1.3;
  for (int i = 0; i < 50; ++i)
    l -= (kModulus * l * (l * l - 1) / 2 - 1000 * 9.81 * (kLength - X)) / (kModulus * (3 * l * l - 1) / 2);
  return l;
}

/// Displacement at X: the integral of l - 1 (Gauss rule of two points on many parts).
double displacement(double X) {
  const int parts = 2000;
  const double h = X / parts, offset = h / (2 * std::sqrt(3.0));
  double sum = 0;
  for (int i = 0; i < parts; ++i) {
    const double middle = (i + 0.5) * h;
    sum += h / 2 * (stretch(middle - offset) + stretch(middle + offset) - 2);
  }
  return sum;
}

TEST(Convergence, HangingColumnIsOfSecondOrder) {
  const double X[] = {0.1, 0.7, 1.3, 1.9, 2.0};
  const double scale = displacement(kLength);
  std::printf("frames along   error / tip   order\n");
  double previous = 0;
  for (const int n : {3, 5, 9, 17, 33, 65}) {
    const SolvedScene run("hanging_column", {grid_setting("column", {n, 2, 2})});
    const auto u = run.vectors("along");
    ASSERT_EQ(u.size(), 5u);
    double error = 0;
    for (std::size_t i = 0; i < 5; ++i) error = std::max(error, std::abs(u[i][0] - displacement(X[i])) / scale);
    const double order = previous > 0 ? std::log2(previous / error) : 0;
    std::printf("%8d %16.3e %9.2f\n", n, error, order);
    if (n >= 9) {
      EXPECT_GT(order, 1.7);
    }
    previous = error;
  }
  EXPECT_LT(previous, 1e-3);
}

TEST(Convergence, SoftCantileverAtATenthOfGravity) {
  const double x = -0.020134, y = -0.75081;
  std::printf("frames            error      order\n");
  double previous = 0;
  for (const int n : {1, 2, 4}) {
    const std::array<int, 3> grid{8 * n + 1, 2 * n + 1, 2 * n + 1};
    const SolvedScene run("soft_cantilever", {grid_setting("beam", grid), "world.gravity=[0,-0.981,0]"});
    const auto u = run.vector("tip");
    const double error = std::hypot(u[0] - x, u[1] - y, u[2]) / std::hypot(x, y);
    const double order = previous > 0 ? std::log2(previous / error) : 0;
    std::printf("%2d x %d x %d %12.3f %% %9.2f\n", grid[0], grid[1], grid[2], 100 * error, order);
    if (previous > 0) {
      EXPECT_GT(order, 1.2);
    }
    previous = error;
  }
}

}  // namespace
}  // namespace fascia::test::convergence_test
