// AFNOR/VPCS traction of a cylinder: Bosman, Duriez and Cotin 2014, table 1.
#include "tests/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::test::traction_test {
namespace {

constexpr double kForce = 1e6 * std::numbers::pi * 3e-3 / 6;  // E A eps [N]
constexpr double kStations[] = {0.0625, 0.125, 0.25, 0.375, 0.5};

TEST(Traction, FreeEnds) {
  const SceneRun run("traction_free_ends");
  const auto u = run.vectors("surface");
  ASSERT_EQ(u.size(), 5u);
  const double exact = std::sqrt(1 - 0.3 * (std::pow(1 + 3e-3 / 6, 2) - 1)) - 1;
  std::printf("x/L       u_r [m]          exact [m]        error\n");
  for (std::size_t i = 0; i < u.size(); ++i) {
    std::printf("%.4f   %.8e  %.8e  %+.1e\n", kStations[i], u[i][1], exact, u[i][1] / exact - 1);
    EXPECT_NEAR(u[i][1] / exact, 1.0, 1e-4);
    EXPECT_NEAR(u[i][1] / -1.500488e-4, 1.0, 1e-4);
  }
  const double force = run.vector("pull")[0];
  std::printf("force    %.3f N        E A eps %.3f N    %+.3f %%\n", force, kForce, 100 * (force / kForce - 1));
  EXPECT_NEAR(force / kForce, 1.0, 0.01);
}

TEST(Traction, ClampedEnds) {
  const SceneRun run("traction_clamped");
  const auto u = run.vectors("surface");
  ASSERT_EQ(u.size(), 5u);
  const double reference[] = {-1.2397e-4, -1.4928e-4, -1.5395e-4, -1.5289e-4, -1.5268e-4};
  std::printf("x/L       u_r [m]       solid [m]     error\n");
  for (std::size_t i = 0; i < u.size(); ++i)
    std::printf("%.4f   %.4e   %.4e   %+6.2f %%\n", kStations[i], u[i][1], reference[i],
                100 * (u[i][1] / reference[i] - 1));
  EXPECT_NEAR(u[4][1] / reference[4], 1.0, 0.02);
  const double factor = run.vector("pull")[0] / kForce;
  std::printf("force / (E A eps)  %.4f     1.018     %+6.2f %%\n", factor, 100 * (factor / 1.018 - 1));
  EXPECT_NEAR(factor / 1.018, 1.0, 0.02);
}

}  // namespace
}  // namespace fascia::test::traction_test
