// Implicit Euler against what the scheme must do exactly, and against statics.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::dynamics_test {
namespace {

using Vector = std::array<double, 3>;

double norm(const Vector& v) { return std::hypot(v[0], v[1], v[2]); }

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

TEST(Dynamics, FreeFall) {
  std::printf("step [s]  steps    u_y [m]            scheme             error      strain\n");
  for (const double h : {0.004, 0.04, 1.0}) {
    const int n = 25;
    const SolvedScene run("free_fall", {"solver.time_step=" + number(h)});
    const double exact = -9.81 * h * h * n * (n + 1) / 2;
    double worst = 0, strain = 0;
    for (const Vector& u : run.vectors("points"))
      worst = std::max(worst, std::hypot(u[0], u[1] - exact, u[2]) / std::abs(exact));
    for (const nlohmann::json& point : run.probe("strain"))
      for (const nlohmann::json& row : point)
        for (const nlohmann::json& e : row) strain = std::max(strain, std::abs(e.get<double>()));
    std::printf("%8.3f %6d  %18.12f %18.12f %9.1e %9.1e\n", h, n, run.vectors("points").at(1)[1], exact, worst, strain);
    EXPECT_LT(worst, 1e-10);
    EXPECT_LT(strain, 1e-10);
    EXPECT_LT(run.number("energy"), 1e-12 * 5 * 9.81);
  }
}

TEST(Dynamics, EnergyNeverGrowsWithoutLoad) {
  std::printf("step [s]  steps   energy first   last [J]   largest growth / first\n");
  const std::pair<double, int> cases[] = {{1e-3, 300}, {1e-2, 150}, {1e-1, 60}, {1, 30}};
  for (const auto& [h, steps] : cases) {
    const SolvedScene run("struck_beam", {"solver.time_step=" + number(h), "solver.steps=" + std::to_string(steps),
                                          "output.every_steps=1"});
    const auto rows = run.history();
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(steps) + 1);
    double growth = -INFINITY;
    for (std::size_t i = 1; i < rows.size(); ++i) growth = std::max(growth, (rows[i][1] - rows[i - 1][1]) / rows[0][1]);
    std::printf("%8.3f %6d %13.6f %11.6f %12.1e\n", h, steps, rows.front()[1], rows.back()[1], growth);
    EXPECT_GT(rows.front()[1], 50) << "the blow has energy";
    EXPECT_LT(growth, 1e-9);
  }
}

TEST(Dynamics, DampedRunEndsAtTheStaticAnswer) {
  const SolvedScene still("soft_cantilever", {grid_setting("beam", {9, 3, 3})});
  const Vector reference = still.vector("tip");
  std::printf("step [s]     u_x [m]      u_y [m]    static (%.6f, %.6f)   difference\n", reference[0], reference[1]);
  for (const double h : {0.1, 1.0}) {
    const SolvedScene run("settling_beam", {"solver.time_step=" + number(h)});
    const Vector u = run.vector("tip");
    const double error = norm({u[0] - reference[0], u[1] - reference[1], u[2] - reference[2]}) / norm(reference);
    std::printf("%8.2f %12.6f %12.6f %40.5f %%\n", h, u[0], u[1], 100 * error);
    EXPECT_LT(error, 1e-3);
  }
}

/// A box of 1 x 0.4 x 0.2 m and 2 kg, as in the scene.
constexpr Vector kSpin{0.4, -0.3, 3}, kInertia{2.0 / 12 * (0.16 + 0.04), 2.0 / 12 * (1 + 0.04), 2.0 / 12 * (1 + 0.16)};

TEST(Dynamics, TumblingBox) {
  Vector start{};
  double kinetic = 0.5 * 2 * (0.09 + 0.01 + 0.04);
  for (std::size_t a = 0; a < 3; ++a) {
    start[a] = kInertia[a] * kSpin[a];
    kinetic += 0.5 * kInertia[a] * kSpin[a] * kSpin[a];
  }
  std::printf("step [s]   L(0) error   KE(0) error   momentum error   |L| left   energy left\n");
  double previous_loss = 0;
  for (const double h : {0.02, 0.01, 0.005}) {
    const SolvedScene run("tumbling_box", {"solver.time_step=" + number(h), "output.every_steps=1"});
    const auto rows = run.history();  // time, momentum, angular momentum, kinetic and total energy
    ASSERT_GT(rows.size(), 10u);
    const Vector L0{rows[0][4], rows[0][5], rows[0][6]}, L{rows.back()[4], rows.back()[5], rows.back()[6]};
    const double spin_error = norm({L0[0] - start[0], L0[1] - start[1], L0[2] - start[2]}) / norm(start);
    const double kinetic_error = std::abs(rows[0][7] / kinetic - 1);
    double momentum_error = 0, growth = -INFINITY;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      momentum_error = std::max(momentum_error, norm({rows[i][1] - 0.6, rows[i][2] - 0.2, rows[i][3] + 0.4}));
      if (i > 0) growth = std::max(growth, (rows[i][8] - rows[i - 1][8]) / kinetic);
    }
    const double loss = 1 - norm(L) / norm(L0);
    std::printf("%8.3f %11.1e %12.1e %14.1e %14.6f %12.6f\n", h, spin_error, kinetic_error, momentum_error, 1 - loss,
                rows.back()[8] / kinetic);
    EXPECT_LT(spin_error, 1e-10);
    EXPECT_LT(kinetic_error, 1e-10);
    EXPECT_LT(momentum_error, 1e-9);
    EXPECT_LT(growth, 1e-9);
    EXPECT_GT(loss, 0) << "implicit Euler loses angular momentum";
    if (previous_loss > 0) {
      EXPECT_NEAR(previous_loss / loss, 2.0, 0.3) << "in proportion to the step";
    }
    previous_loss = loss;
  }
}

}  // namespace
}  // namespace fascia::test::dynamics_test
