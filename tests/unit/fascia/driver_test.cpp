#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "fascia/stepper.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace fascia::driver_test {

using test::copied;

namespace {

constexpr SolverKind kKinds[] = {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark,
                                 SolverKind::midpoint, SolverKind::statics};

Vec3d moved(const RigidMotion& m, const Vec3d& X) {
  return m.center + rotation_increment(m.rotation) * (X - m.center) + (X - m.center) + m.translation;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

/// The foot turns about one axis after the other, and about other centers: its nodes go where the motion says, whatever
/// the kind of node and of scheme.
TEST(Drivers, HeldNodesFollowAnyMotion) {
  for (const SolverKind kind : kKinds)
    for (const bool elements : {false, true}) {
      Scene scene = elements ? test::driven_tetrahedra(kind) : test::driven_block(kind);
      scene.world.gravity = {};
      Stepper stepper(scene);
      const Rows X = stepper.positions();
      const std::vector<double> rest = copied(X);
      const RigidMotion motions[] = {{{{0.01, 0, 0}}, {{0.4, 0, 0}}, {{0.02, 0.02, 0}}},
                                     {{{0.01, 0.02, 0}}, {{0.4, 0.3, 0}}, {{0, 0, 0}}},
                                     {{{0, 0.02, -0.01}}, {{-0.2, 0.3, 0.6}}, {{0.05, 0, 0.1}}},
                                     {{{0, 0.02, -0.01}}, {{-0.2, 0.3, 0.6}}, {{0.05, 0, 0.1}}},
                                     {}};
      for (const RigidMotion& motion : motions) {
        stepper.set_motion(0, motion);
        const StepReport report = stepper.step(kind == SolverKind::statics ? 0.1 : 0.05);
        ASSERT_TRUE(report.converged) << report.message;
        for (int i = 0; i < X.rows; ++i) {
          const double* r = rest.data() + 3 * at(i);
          if (r[2] > 1e-9) continue;
          const Vec3d target = moved(motion, {{r[0], r[1], r[2]}});
          for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(X[i][k], target[static_cast<int>(k)], 1e-15) << static_cast<int>(kind) << " node " << i;
        }
      }
    }
}

/// Turned about two axes in turn, all of a free block ends where its foot has turned to.
TEST(Drivers, WhatHangsOnItTurnsAlong) {
  Scene scene = test::driven_block(SolverKind::statics);
  scene.world.gravity = {};
  Stepper stepper(scene);
  const Rows x = stepper.positions(), Q = stepper.rotations();
  const std::vector<double> rest = copied(x);
  const RigidMotion first{{{0, 0, 0.02}}, {{0.5, 0, 0}}, {{0.02, 0.02, 0}}};
  const RigidMotion last{{{0, 0.1, 0.02}}, {{0.7, 1.1, -0.6}}, {{0, 0.02, 0.3}}};
  stepper.set_motion(0, first);
  ASSERT_TRUE(stepper.step(0.1).converged);
  stepper.set_motion(0, last);
  ASSERT_TRUE(stepper.step(0.1).converged);
  const Mat3d R = Mat3d::identity() + rotation_increment(last.rotation);
  for (int i = 0; i < x.rows; ++i) {
    const double* r = rest.data() + 3 * at(i);
    const Vec3d target = moved(last, {{r[0], r[1], r[2]}});
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(x[i][at(k)], target[k], 1e-9);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) EXPECT_NEAR(Q[i][at(3 * a + b)], R(a, b), 1e-8);
  }
}

/// One axis, even speed: a driver and the motion of a schedule are two ways to the same states.
TEST(Drivers, AgreesWithAScheduledMotion) {
  for (const SolverKind kind : kKinds) {
    Scene driven = test::driven_block(kind), scheduled = driven;
    Constraint& foot = scheduled.constraints[0];
    foot.driver.clear();
    foot.motion = Motion{{{0.02, 0, 0}}, {{0, 0, 1}}, 1.2, {{0.02, 0.02, 0}}};
    foot.schedule.over = kind == SolverKind::statics ? 0 : 0.125;
    foot.schedule.has_over = kind != SolverKind::statics;
    Stepper one(driven), other(scheduled);
    const double dt = kind == SolverKind::statics ? 0.125 : 0.015625;
    for (int step = 1; step <= 8; ++step) {
      one.set_motion(0, {{{0.02 * step / 8, 0, 0}}, {{0, 0, 1.2 * step / 8}}, {{0.02, 0.02, 0}}});
      ASSERT_TRUE(one.step(dt).converged);
      ASSERT_TRUE(other.step(dt).converged);
    }
    const std::vector<double> u = copied(one.displacements()), v = copied(other.displacements());
    double apart = 0;
    for (std::size_t i = 0; i < u.size(); ++i) apart = std::max(apart, std::abs(u[i] - v[i]));
    // Newton's method ends at other last bits; the schedule's tolerance is a residual of 1e-8.
    EXPECT_LE(apart, 1e-8 * largest_of(u)) << static_cast<int>(kind);
  }
}

/// Scattered frames, whose weights do not interpolate: the material follows its tethers.
TEST(Drivers, MaterialOfScatteredFramesFollows) {
  Scene scene = test::driven_block(SolverKind::statics);
  scene.world.gravity = {};
  scene.bodies[0].frames = CountedSamples{40, 1};
  scene.probes[0].at = {Vec3d{{0.03, 0.01, 0}}};
  Stepper stepper(scene);
  const RigidMotion motion{{{0.01, 0, 0.02}}, {{0.3, 0.2, -0.4}}, {{0, 0, 0.1}}};
  stepper.set_motion(0, motion);
  const StepReport report = stepper.step(0.5);
  ASSERT_TRUE(report.converged) << report.message;
  const std::vector<double> x = stepper.probe("top");
  const Vec3d target = moved(motion, {{0.03, 0.01, 0}});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(x[at(k)], target[k], 1e-6);
}

TEST(Drivers, SomeRotationsAloneAreRefused) {
  Scene scene = test::driven_block(SolverKind::statics);
  scene.constraints[0].fixed = {true, true, true, true, false, false};
  try {
    Stepper stepper(scene);
    FAIL();
  } catch (const SceneError& e) {
    EXPECT_STREQ(e.what(),
                 "constraints[0]: is moved by the driver \"foot\" and holds some rotations only; name \"rx\", \"ry\" "
                 "and \"rz\" in axes, or none of them");
  }
}

/// Two drivers, or a driver and a support, cannot hold one node.
TEST(Drivers, OneNodeHasOneDriver) {
  for (const char* other : {"hand", ""}) {
    Scene scene = test::driven_block(SolverKind::statics);
    scene.constraints.push_back(scene.constraints[0]);
    scene.constraints[1].driver = other;
    EXPECT_THROW(Stepper{scene}, SceneError);
  }
  Scene scene = test::driven_block(SolverKind::statics);
  scene.constraints.push_back(scene.constraints[0]);
  EXPECT_NO_THROW(Stepper{scene});  // one driver named twice
  scene.constraints[0].fixed = {true, false, false, false, false, false};
  scene.constraints[1].fixed = {false, true, false, false, false, false};
  scene.constraints[1].driver.clear();
  scene.constraints.push_back(scene.constraints[1]);
  scene.constraints.push_back(scene.constraints[0]);
  scene.bodies[0].model = BodyModel::tetrahedra;
  scene.bodies[0].cells = MeshCells{{2, 2, 4}};
  scene.solver.kind = SolverKind::implicit_euler;
  EXPECT_NO_THROW(Stepper{scene});  // another axis is another matter
}

}  // namespace

}  // namespace fascia::driver_test
