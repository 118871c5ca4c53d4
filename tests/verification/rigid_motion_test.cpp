// Rigid motions strain nothing.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::rigid_motion_test {
namespace {

using Vector = std::array<double, 3>;

constexpr double kMu = 10e3 / 2.6, kVolume = 0.06, kFace = 0.06;

/// Rotation of X about an axis through the origin (Rodrigues).
Vector rotated(const Vector& X, Vector n, double angle) {
  const double length = std::hypot(n[0], n[1], n[2]);
  for (double& c : n) c /= length;
  const Vector cross{n[1] * X[2] - n[2] * X[1], n[2] * X[0] - n[0] * X[2], n[0] * X[1] - n[1] * X[0]};
  const double dot = n[0] * X[0] + n[1] * X[1] + n[2] * X[2], c = std::cos(angle), s = std::sin(angle);
  Vector x;
  for (std::size_t a = 0; a < 3; ++a) x[a] = X[a] * c + cross[a] * s + n[a] * dot * (1 - c);
  return x;
}

double largest_entry(const nlohmann::json& value) {
  if (value.is_number()) return std::abs(value.get<double>());
  double largest = 0;
  for (const nlohmann::json& v : value) largest = std::max(largest, largest_entry(v));
  return largest;
}

struct Turn {
  const char* name;
  std::string setting;
  Vector axis;
  double degrees;
};

const Turn kTurns[] = {{"720 degrees about z",
                        "constraints[0].move.rotate={axis=[0,0,1],angle='720 degree',center=[0,0,0]}",
                        {0, 0, 1},
                        720},
                       {"77 degrees, skew axis",
                        "constraints[0].move.rotate={axis=[1,-2,0.7],angle='77 degree',center=[0,0,0]}",
                        {1, -2, 0.7},
                        77}};

double placement_error(const SolvedScene& run, const Turn& turn) {
  const Vector X{1, 0.15, 0.1}, x = rotated(X, turn.axis, turn.degrees * std::acos(-1.0) / 180), u = run.vector("end");
  return std::hypot(X[0] + u[0] - x[0], X[1] + u[1] - x[1], X[2] + u[2] - x[2]);
}

TEST(RigidMotion, AllFramesPrescribed) {
  std::printf("motion                   energy/(mu V)   stress/mu   strain   force/(mu A)   place [m]   volume\n");
  for (const Turn& turn : kTurns) {
    const SolvedScene run("rigid_turn", {turn.setting});
    const double energy = run.number("energy") / (kMu * kVolume), s = largest_entry(run.probe("stress")) / kMu;
    const double strain = largest_entry(run.probe("strain")), force = largest_entry(run.probe("force")) / (kMu * kFace);
    const double place = placement_error(run, turn), volume = std::abs(run.number("volume") / kVolume - 1);
    std::printf("%-24s %12.1e %11.1e %9.1e %13.1e %11.1e %9.1e\n", turn.name, energy, s, strain, force, place, volume);
    EXPECT_LT(energy, 1e-20);
    EXPECT_LT(s, 1e-12);
    EXPECT_LT(strain, 1e-12);
    EXPECT_LT(force, 1e-12);
    EXPECT_LT(place, 1e-12);
    EXPECT_LT(volume, 1e-12);
    EXPECT_LT(run.summary().value("stabilization_energy", 1.0) / (kMu * kVolume), 1e-20);
  }
}

TEST(RigidMotion, LedByOneEnd) {
  std::printf("motion                   energy/(mu V)   place [m]\n");
  for (const Turn& turn : kTurns) {
    const SolvedScene run("led_by_one_end", {turn.setting});
    const double energy = run.number("energy") / (kMu * kVolume), place = placement_error(run, turn);
    std::printf("%-24s %12.1e %11.1e\n", turn.name, energy, place);
    EXPECT_LT(energy, 1e-20);
    EXPECT_LT(place, 1e-10);
  }
}

}  // namespace
}  // namespace fascia::test::rigid_motion_test
