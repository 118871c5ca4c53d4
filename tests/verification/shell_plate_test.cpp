// Plates of triangle shells: thin and thick, static, vibrating, and in free flight.
#include "core/run/explicit_dynamics.hpp"
#include "core/run/modes.hpp"
#include "tests/support/shell_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::shell_plate_test {
namespace {

using namespace test;

bool on_x(const Vec3d& X) { return std::abs(X[0]) < 1e-9 || std::abs(X[0] - 1) < 1e-9; }
bool on_y(const Vec3d& X) { return std::abs(X[1]) < 1e-9 || std::abs(X[1] - 1) < 1e-9; }

ShellModel square(int n, double thickness, bool clamped, double jitter = 0) {
  ShellModel b = shell_model(patch_mesh(
                                 [](double u, double v) {
                                   return Vec3d{{u, v, 0}};
                                 },
                                 {n, n, Diagonals::alternating, jitter}),
                             {1e6, 0.3, thickness, 1000});
  hold(b.model, on_x, clamped ? "xyzXYZ" : "zX");
  hold(b.model, on_y, clamped ? "xyzXYZ" : "zY");
  if (clamped) return b;
  hold(
      b.model, [](const Vec3d& X) { return norm(X) < 1e-9; }, "xyZ");
  hold(
      b.model,
      [](const Vec3d& X) {
        return norm(X - Vec3d{{1, 0, 0}}) < 1e-9;
      },
      "y");
  return b;
}

/// Centre deflections of square plates under uniform load over q L⁴ / D.
/// Thin: 0.00406235 (Navier), 0.00126532 (Timoshenko and Woinowsky-Krieger 1959). Simply supported thick ones add the
/// membrane that shear makes, 0.0736713 q L² / (κ G t); clamped at t / L = 0.1: 0.0015046.
TEST(ShellPlates, NoShearLocking) {
  std::printf("centre / reference  t/L       8      16      32 (irregular 16)\n");
  for (const bool clamped : {false, true})
    for (const double t : {0.1, 0.01, 1e-3, 1e-4}) {
      const double D = 1e6 * t * t * t / 12 / 0.91, shear = 5.0 / 6 * 1e6 / 2.6 * t;
      const double thick = clamped ? (t == 0.1 ? 0.0015046 - 0.00126532 : t * t * (0.0015046 - 0.00126532) / 0.01)
                                   : 0.0736713 * D / shear;
      const double reference = ((clamped ? 0.00126532 : 0.00406235) + thick) / D;
      std::printf("%-18s %6g", clamped ? "clamped" : "simply supported", t);
      for (const auto& [n, jitter] : {std::pair{8, 0.0}, {16, 0.0}, {32, 0.0}, {16, 0.25}}) {
        ShellModel b = square(n, t, clamped, jitter);
        add_area_load(b, {{0, 0, 1}});
        double centre = 0;
        const Attachment a = b.body->attach({{0.5, 0.5, 0}});
        const State state = small_response(b.model, 1e-6 * D);
        for (std::size_t k = 0; k < a.nodes.size(); ++k) centre += a.influences[k].w * state.u[at(a.nodes[k])][2];
        std::printf("  %.4f", centre / reference);
        if (n >= 16) {
          EXPECT_NEAR(centre / reference, 1, 0.02) << t;
        }
      }
      std::printf("\n");
    }
}

/// ω L² √(ρ t / D) of a clamped square plate (Leissa 1969, table 4.23).
TEST(ShellPlates, ClampedFrequencies) {
  const double reference[] = {35.992, 73.413, 73.413, 108.27, 131.64, 132.25};
  const double t = 0.005, D = 1e6 * t * t * t / 12 / 0.91;
  for (const int n : {12, 24}) {
    const ShellModel b = square(n, t, true);
    ThreadPool pool(1);
    const Modes modes = natural_modes(b.model, pool, 6);
    std::printf("clamped plate, %d x %d:", n, n);
    for (std::size_t k = 0; k < 6; ++k) {
      const double value = 2 * std::numbers::pi * modes.frequency[k] * std::sqrt(1000 * t / D);
      std::printf(" %.2f (%+.2f %%)", value, 100 * (value / reference[k] - 1));
      if (n == 24) {
        EXPECT_NEAR(value / reference[k], 1, 0.03);
      }
    }
    std::printf("\n");
  }
}

/// Free plates: six modes that are none, then f / t that does not depend on the thickness, however thin.
TEST(ShellPlates, FreeThinPlatesVibrate) {
  for (const double t : {1e-2, 1e-4, 1e-6}) {
    const ShellModel b = shell_model(patch_mesh(
                                         [](double u, double v) {
                                           return Vec3d{{u, v, 0}};
                                         },
                                         {24, 24, Diagonals::alternating}),
                                     {1e6, 0.3, t, 1000});
    ThreadPool pool(1);
    const Modes modes = natural_modes(b.model, pool, 10);
    std::printf("free plate, t = %g, f / t:", t);
    for (const double f : modes.frequency) std::printf(" %.3f", f / t);
    std::printf("\n");
    EXPECT_TRUE(modes.converged);
    // ω L² √(ρ t / D) = 13.468, 19.596, 24.271 (Leissa 1969, table 4.76).
    const double unit = std::sqrt(1e6 / 12 / 0.91 / 1000) / (2 * std::numbers::pi);
    EXPECT_LT(modes.frequency[5], 0.1 * modes.frequency[6]);
    EXPECT_NEAR(modes.frequency[6] / t / unit, 13.468, 0.02 * 13.468);
    EXPECT_NEAR(modes.frequency[7] / t / unit, 19.596, 0.02 * 19.596);
    EXPECT_NEAR(modes.frequency[8] / t / unit, 24.271, 0.02 * 24.271);
  }
}

/// A spinning, bent shell: linear momentum under implicit Euler, angular under the midpoint rule; implicit Euler gains
/// no energy.
TEST(ShellPlates, FreeFlight) {
  const auto map = [](double u, double v) { return Vec3d{{u, v, 0.4 * u * (1 - u)}}; };
  const ShellModel b = shell_model(patch_mesh(map, {6, 6, Diagonals::alternating, 0.2}), {1e6, 0.3, 0.02, 1000});
  const State start = spinning_state(b.model, {{3, 1, 5}}, {{1, -2, 0.5}});
  const Momentum before = total_momentum(b.model, start);
  for (const TimeScheme scheme : {TimeScheme::implicit_euler, TimeScheme::midpoint}) {
    ThreadPool pool(1);
    SolverSettings settings;
    settings.tolerance = 1e-12;
    MechanicalSystem system(b.model, pool, settings);
    State state = start;
    double energy = before.kinetic_energy, largest_gain = 0;
    const RunReport run = run_implicit(system, state, kAlways, settings, {scheme, 0.01, 60},
                                       [&](const StepInfo&, const State& now, MechanicalSystem& s) {
                                         const double next =
                                             total_momentum(b.model, now).kinetic_energy + s.internal_energy().total();
                                         largest_gain = std::max(largest_gain, next - energy);
                                         energy = next;
                                         return true;
                                       });
    ASSERT_EQ(run.status, RunStatus::converged) << run.message;
    const Momentum after = total_momentum(b.model, state);
    const double linear = norm(after.linear - before.linear) / norm(before.linear);
    const double angular = norm(after.angular - before.angular) / norm(before.angular);
    const bool euler = scheme == TimeScheme::implicit_euler;
    std::printf("%-15s linear momentum %.1e, angular %.1e, largest gain of energy in a step %.1e\n",
                euler ? "implicit Euler" : "midpoint", linear, angular, largest_gain / before.kinetic_energy);
    EXPECT_LT(linear, 1e-9);
    if (euler)
      EXPECT_LT(largest_gain, 1e-10 * before.kinetic_energy);
    else
      EXPECT_LT(angular, 1e-9);
  }
}

/// A plate that a sudden load sets swinging, to and beyond its first turn: central differences against Newmark.
TEST(ShellPlates, ExplicitAgreesWithImplicit) {
  ShellModel b = square(12, 0.01, true);
  add_area_load(b, {{0, 0, -5}});
  const int centre = node_at(b.model, {{0.5, 0.5, 0}});
  ThreadPool pool(1);
  const SolverSettings settings;
  MechanicalSystem system(b.model, pool, settings);
  const double limit = stable_time_step(system, State::at_rest(b.model));
  const double speed = std::sqrt(1e6 / 0.91 / 1000), size = 1.0 / 12;
  std::printf("stable step %.3e s, %.2f of the time of a wave across an edge\n", limit, limit * speed / size);
  EXPECT_GT(limit, 0.4 * size / speed);
  const int steps = static_cast<int>(std::ceil(0.4 / (0.9 * limit)));
  State fast = State::at_rest(b.model), slow = fast;
  EXPECT_EQ(run_explicit(system, fast, kAlways, {0.4 / steps, steps, {}}, {}).status, RunStatus::converged);
  EXPECT_EQ(run_implicit(system, slow, kAlways, settings, {TimeScheme::newmark, 2e-3, 200}, {}).status,
            RunStatus::converged);
  const double u = fast.u[at(centre)][2], v = slow.u[at(centre)][2];
  std::printf("centre after 0.4 s: explicit %.5f m, Newmark %.5f m (%.2f %%)\n", u, v, 100 * (u / v - 1));
  EXPECT_NEAR(u / v, 1, 0.01);
}

/// The same roof in millimetres, metres and kilometres, soft and hard: bent by the same part of its size.
TEST(ShellPlates, SizesAndStiffnessesDoNotMatter) {
  double reference = 0;
  for (const auto& [size, young] : {std::pair{1.0, 1e6}, {1e-3, 1e6}, {1e3, 1e6}, {1.0, 1.0}, {1.0, 1e12}}) {
    const double length = size;
    const auto map = [=](double u, double v) { return Vec3d{{length * u, length * v, 0.3 * length * u * (1 - u)}}; };
    ShellModel b = shell_model(patch_mesh(map, {8, 8, Diagonals::alternating}), {young, 0.3, 0.01 * size, 1});
    hold(
        b.model, [=](const Vec3d& X) { return X[0] < 1e-9 * length; }, "xyzXYZ");
    add_area_load(b, {{0, 0, -young * 1e-6}});
    ThreadPool pool(1);
    SolverSettings settings;
    MechanicalSystem system(b.model, pool, settings);
    State state = State::at_rest(b.model);
    const RunReport run = run_statics(system, state, kRamp, settings, {1}, {});
    ASSERT_EQ(run.status, RunStatus::converged) << run.message;
    const double tip = state.u[at(node_at(b.model, {{length, 0, 0}}))][2] / size;
    std::printf("size %g m, %g Pa: %.12f, %d iterations\n", size, young, tip, run.newton_iterations);
    if (reference == 0) reference = tip;
    EXPECT_NEAR(tip / reference, 1, 1e-7);  // Newton's tolerance 1e-8 of the load
  }
}

}  // namespace
}  // namespace fascia::shell_plate_test
