// Rigid bodies: mass and inertia against closed forms, places, free flight, refused input.
#include "coupling/rigid_body.hpp"

#include "core/base/errors.hpp"
#include "shells/generate.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace fascia::rigid_body_test {
namespace {

struct Built {
  Model model;
  std::unique_ptr<RigidBody> body;
};

Built build(const RigidBodySpec& spec) {
  Built built;
  PointSetBuilder points;
  built.body = std::make_unique<RigidBody>(spec, built.model, points);
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

RigidBodySpec box(const Vec3d& min, const Vec3d& max) {
  RigidBodySpec spec;
  spec.surface = box_surface(min, max, 2, 3, 1);
  spec.closed = true;
  spec.density = 1200;
  return spec;
}

TriangleMesh rectangle_surface() {
  ShellMesh mesh = rectangle({{1, 1, 1}}, {{2, 0, 0}}, {{0, 0.5, 0}}, {4, 3}, Diagonal::right);
  return {mesh.nodes, mesh.triangles};
}

std::string message_of(const RigidBodySpec& spec) {
  try {
    build(spec);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

Mat3d diagonal(double a, double b, double c) { return Mat3d::from_columns({{a, 0, 0}}, {{0, b, 0}}, {{0, 0, c}}); }

TEST(RigidBody, BoxHasTheMomentsOfABox) {
  const Vec3d corner{{100, -50, 3}}, size{{0.4, 0.3, 0.2}};
  const Built b = build(box(corner, corner + size));
  const double volume = 0.4 * 0.3 * 0.2, mass = 1200 * volume;
  EXPECT_NEAR(b.body->volume(), volume, 1e-14);
  EXPECT_NEAR(b.body->mass(), mass, 1e-12 * mass);
  EXPECT_LT(norm(b.model.rest_position[0] - (corner + size * 0.5)), 1e-13);
  const Mat3d expected = diagonal(0.16, 0.09, 0.04) * (mass / 12);
  EXPECT_LT(norm(b.model.inertia[0].second - expected), 1e-12 * norm(expected));
  EXPECT_EQ(b.model.inertia[0].first, Vec3d{});
  EXPECT_NEAR(b.body->size(), norm(size), 1e-12);
  EXPECT_EQ(b.body->node_count(), 1);
  EXPECT_EQ(b.model.frame_kind[0], FrameKind::rigid);
}

/// Of second order in the length of edges: (2/5) m r² and its like.
TEST(RigidBody, EllipsoidConvergesToTheClosedForm) {
  const Vec3d radii{{0.3, 0.2, 0.1}};
  double before = 0;
  for (const int n : {8, 16, 32}) {
    RigidBodySpec spec;
    spec.surface = ellipsoid_surface({{1, 2, 3}}, radii, n);
    spec.closed = true;
    spec.density = 1000;
    const Built b = build(spec);
    const double mass = 1000 * 4.0 / 3 * std::numbers::pi * radii[0] * radii[1] * radii[2];
    const Mat3d expected = diagonal(0.09, 0.04, 0.01) * (mass / 5);
    const double error = norm(b.model.inertia[0].second - expected) / norm(expected);
    std::printf("n = %d: mass %.2e, second moment %.2e\n", n, b.body->mass() / mass - 1, error);
    EXPECT_LT(norm(b.model.rest_position[0] - Vec3d{{1, 2, 3}}), 1e-12);
    if (before > 0) {
      EXPECT_NEAR(before / error, 4, 0.4);
    }
    before = error;
  }
  EXPECT_LT(before, 0.02);
}

/// An open surface carries its mass evenly over its area.
TEST(RigidBody, OpenSurfaceIsAPlate) {
  RigidBodySpec spec;
  spec.surface = rectangle_surface();
  spec.mass = 3;
  const Built b = build(spec);
  EXPECT_EQ(b.body->volume(), 0);
  EXPECT_LT(norm(b.model.rest_position[0] - Vec3d{{2, 1.25, 1}}), 1e-14);
  EXPECT_LT(norm(b.model.inertia[0].second - diagonal(1, 0.0625, 0)), 1e-13);
  EXPECT_DOUBLE_EQ(b.body->distance({{2, 1.25, 1.5}}), 0.5);
}

/// I = diag(2, 3, 4): S = tr(I)/2 − I.
TEST(RigidBody, GivenInertiaCounts) {
  RigidBodySpec spec = box({{0, 0, 0}}, {{1, 1, 1}});
  spec.density.reset();
  spec.mass = 5;
  spec.inertia = diagonal(2, 3, 4);
  EXPECT_LT(norm(build(spec).model.inertia[0].second - diagonal(2.5, 1.5, 0.5)), 1e-14);
  spec.inertia = diagonal(1, 2, 3);  // a flat body, just so
  EXPECT_LT(norm(build(spec).model.inertia[0].second - diagonal(2, 1, 0)), 1e-14);
  spec.closed = false;
  spec.surface = rectangle_surface();
  EXPECT_LT(norm(build(spec).model.rest_position[0] - Vec3d{{2, 1.25, 1}}), 1e-14);
}

TEST(RigidBody, CarriesAllPlaces) {
  const Built b = build(box({{0, 0, 0}}, {{1, 2, 3}}));
  const Mat3d D = rotation_increment({{0.4, -1, 2}});
  const State state = test::rigid_state(b.model, D, {{0.1, 0.2, 0.3}});
  for (const Vec3d& X : {Vec3d{{0, 0, 0}}, Vec3d{{1, 2, 3}}, Vec3d{{-4, 7, 1}}}) {
    const FieldValue f = field_at(b.body->attach(X), state);
    EXPECT_LT(norm(f.u - (D * X + Vec3d{{0.1, 0.2, 0.3}})), 1e-14);
    EXPECT_LT(norm(f.H - D), 1e-15);
    EXPECT_LT(norm(f.D - D), 1e-15);
  }
  EXPECT_EQ(norm(b.body->tensors_at(b.body->attach({}), 0, state).stress), 0);
  EXPECT_EQ(norm(b.body->strain_at(b.body->attach({}), state)), 0);
  EXPECT_TRUE(b.body->tensors(state).empty());
  EXPECT_EQ(b.body->distance({{0.5, 1, 1.5}}), 0);
  EXPECT_NEAR(b.body->distance({{0.5, 1, 3.25}}), 0.25, 1e-15);
}

/// A tumbling box: the midpoint rule keeps both momenta, implicit Euler the linear one; its spin converges.
TEST(RigidBody, FreeFlightKeepsItsMomentum) {
  const Built b = build(box({{1, 0, 0}}, {{2, 0.6, 0.3}}));
  const State start = test::spinning_state(b.model, {{1, -2, 3.7}}, {{0.3, 0.2, 0}});
  const Momentum first = test::total_momentum(b.model, start);
  double before = 0;
  for (const TimeScheme scheme : {TimeScheme::midpoint, TimeScheme::implicit_euler})
    for (const int steps : {200, 400}) {
      ThreadPool pool(1);
      SolverSettings settings;
      settings.tolerance = 1e-11;
      MechanicalSystem system(b.model, pool, settings);
      State state = start;
      const RunReport report = run_implicit(
          system, state, [](double) { return std::vector<double>{}; }, settings, {scheme, 1.0 / steps, steps}, nullptr);
      ASSERT_EQ(report.status, RunStatus::converged) << report.message;
      const Momentum last = test::total_momentum(b.model, state);
      const double linear = norm(last.linear - first.linear) / norm(first.linear);
      const double spin = norm(last.angular - first.angular) / norm(first.angular);
      const double energy = last.kinetic_energy / first.kinetic_energy - 1;
      std::printf("%s, %d steps: momentum %.1e, spin %.1e, energy %.1e\n",
                  scheme == TimeScheme::midpoint ? "midpoint" : "implicit Euler", steps, linear, spin, energy);
      EXPECT_LT(linear, 1e-9);
      EXPECT_LT(norm(state.u[0] - Vec3d{{0.3, 0.2, 0}} - cross(Vec3d{{1, -2, 3.7}}, b.model.rest_position[0])), 1e-9);
      if (scheme == TimeScheme::midpoint) {
        EXPECT_LT(spin, 1e-9);
        EXPECT_LT(std::abs(energy), 1e-3);
        continue;
      }
      if (before > 0) {
        EXPECT_NEAR(before / spin, 2, 0.2);
      }
      before = spin;
    }
}

TEST(RigidBody, RefusesWhatNoBodyIs) {
  RigidBodySpec plate;
  plate.surface = rectangle_surface();
  plate.density = 1000;
  EXPECT_NE(message_of(plate).find("open: a density has no volume there; give its mass"), std::string::npos);
  plate.density.reset();
  EXPECT_NE(message_of(plate).find("no mass"), std::string::npos);
  plate.mass = 0;
  EXPECT_NE(message_of(plate).find("must be above 0"), std::string::npos);
  plate.mass = 1;
  plate.density = 1;
  EXPECT_NE(message_of(plate).find("one of the two"), std::string::npos);
  plate.density.reset();
  plate.inertia = diagonal(1, 2, 4);
  EXPECT_NE(message_of(plate).find("larger than the sum"), std::string::npos);
  plate.inertia = diagonal(1, 2, -1);
  EXPECT_NE(message_of(plate).find("not positive"), std::string::npos);
  plate.inertia = diagonal(0, 1, 1);
  EXPECT_NE(message_of(plate).find("not positive"), std::string::npos);
  plate.inertia = diagonal(2, 2, 2) + skew(Vec3d{{0, 0, 0.1}});
  EXPECT_NE(message_of(plate).find("not symmetric"), std::string::npos);
  plate.inertia = diagonal(std::nan(""), 2, 2);
  EXPECT_NE(message_of(plate).find("not positive"), std::string::npos);
  plate.inertia.reset();
  for (Vec3d& X : plate.surface.points) X[1] = 1;
  EXPECT_NE(message_of(plate).find("no area"), std::string::npos);
  RigidBodySpec inward = box({{0, 0, 0}}, {{1, 1, 1}});
  for (auto& t : inward.surface.triangles) std::swap(t[0], t[1]);
  EXPECT_NE(message_of(inward).find("turn its triangles outward"), std::string::npos);
}

}  // namespace
}  // namespace fascia::rigid_body_test
