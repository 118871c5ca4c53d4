// Forces of drivers: the work that they do, what they carry, and which of them pulls along which axis.
#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "fascia/stepper.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stop_token>

namespace fascia::driver_force_test {

namespace {

/// A rigid box of half a kilogram in a hand.
Scene held_box(SolverKind kind) {
  Scene scene = test::driven_block(kind);
  Body& box = scene.bodies[0];
  box.model = BodyModel::rigid;
  box.domain = BoxDomain{{{0, 0, 0}}, {{0.1, 0.1, 0.05}}};
  box.density = 1000;
  box.materials.clear();
  box.frames = {};
  scene.constraints[0].where = {};
  scene.constraints[0].driver = "hand";
  scene.probes.clear();
  return scene;
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance, const char* of) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << of << ' ' << k;
}

/// In a turned pose the hand carries the weight, at the arm from its center to that of the mass.
TEST(DriverForce, AHandCarriesTheWeight) {
  Stepper stepper(held_box(SolverKind::statics));
  const int hand = stepper.driver("hand");
  const RigidMotion pose{{{0.3, -0.1, 0.2}}, {{0.4, -0.9, 0.3}}, {{0.1, 0, 0}}};
  stepper.set_motion(hand, pose);
  ASSERT_TRUE(stepper.step(1).converged);
  const Mat3d R = Mat3d::identity() + rotation_increment(pose.rotation);
  const Vec3d weight{{0, 0, -9.81 * 0.5}}, arm = R * (Vec3d{{0.05, 0.05, 0.025}} - pose.center);
  const Wrench there = stepper.driver_force(hand);
  expect_near(there.force, -weight, 1e-13, "force");
  expect_near(there.moment, cross(arm, -weight), 1e-14, "moment");
  const Vec3d about{{-0.2, 0.5, 0.7}};
  expect_near(stepper.driver_force(hand, about).moment, cross(pose.center + pose.translation + arm - about, -weight),
              1e-13, "moment about a point");
}

/// The first implicit Euler step from rest by d takes the acceleration d / dt².
TEST(DriverForce, AHandAcceleratesTheMass) {
  Stepper stepper(held_box(SolverKind::implicit_euler));
  stepper.set_motion(0, {{{0.001, 0, 0.002}}, {}, {}});
  ASSERT_TRUE(stepper.step(0.01).converged);
  expect_near(stepper.driver_force(0).force, {{0.5 * 0.001 / 1e-4, 0, 0.5 * (0.002 / 1e-4 + 9.81)}}, 1e-11, "force");
}

/// A block whose frames all follow a hand.
Scene held_block(SolverKind kind, bool affine) {
  Scene scene = test::driven_block(kind);
  scene.bodies[0].affine = affine;
  scene.bodies[0].materials[0].material.mass_damping = 0;
  scene.bodies[0].materials[0].material.stiffness_damping = 0;
  scene.constraints[0].where = {};
  scene.probes.clear();
  return scene;
}

/// Turned about its center of mass by θ = 10 t², a body takes the moment I α from its hand, of all schemes, once the
/// scheme has started: a rigid body, rigid frames and affine ones.
TEST(DriverForce, AHandTurnsTheMass) {
  const double alpha = 20, dt = 0.01;
  for (const SolverKind kind :
       {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark, SolverKind::midpoint})
    for (const char* body : {"rigid", "frames", "affine"}) {
      const bool box = body == std::string("rigid");
      Scene scene = box ? held_box(kind) : held_block(kind, body == std::string("affine"));
      scene.world.gravity = {};
      const double mass = box ? 0.5 : 0.128, width = box ? 0.1 : 0.04, inertia = mass * width * width / 6;
      const Vec3d center = box ? Vec3d{{0.05, 0.05, 0.025}} : Vec3d{{0.02, 0.02, 0.04}};
      Stepper stepper(scene);
      for (int step = 1; step <= 8; ++step) {
        const double t = dt * step;
        stepper.set_motion(0, {{}, {{0, 0, 0.5 * alpha * t * t}}, center});
        ASSERT_TRUE(stepper.step(dt).converged);
        if (step < 4) continue;
        const Wrench there = stepper.driver_force(0);
        EXPECT_NEAR(there.moment[2], inertia * alpha, 0.01 * inertia * alpha)
            << body << ' ' << static_cast<int>(kind) << ' ' << step;
      }
    }
}

/// A hand that turns a box about changing axes exerts the rate of its angular momentum, which is differentiated here
/// from the rotations alone, to 1e-7. Newmark's inertia of what is held lags by a step: the error halves with the step.
TEST(DriverForce, AHandTurnsTheMassAboutAnyAxis) {
  const Vec3d center{{0.05, 0.05, 0.025}};
  const auto vector_at = [](double t) {
    return Vec3d{{0.3 * std::sin(5 * t), 0.2 * std::cos(4 * t) - 0.2, 0.8 * t + 2 * t * t}};
  };
  const auto turn_at = [&](double t) { return Mat3d::identity() + rotation_increment(vector_at(t)); };
  Mat3d rest{};  // of half a kilogram, 10 x 10 x 5 cm
  rest(0, 0) = rest(1, 1) = 0.5 / 12 * (0.1 * 0.1 + 0.05 * 0.05);
  rest(2, 2) = 0.5 / 12 * (0.1 * 0.1 + 0.1 * 0.1);
  const auto momentum_at = [&](double t) {
    const double h = 1e-4;
    const Mat3d R = turn_at(t), rate = (turn_at(t + h) - turn_at(t - h)) * (0.5 / h);
    const Mat3d W = times_transpose(rate, R);
    const Vec3d spin{{W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1)}};
    return R * (rest * (transpose(R) * (spin * 0.5)));
  };
  const double end = 0.32, h = 1e-3;
  const Vec3d exact = (momentum_at(end + h) - momentum_at(end - h)) * (0.5 / h);
  std::vector<double> errors;
  for (const int steps : {64, 128, 256}) {
    Scene scene = held_box(SolverKind::newmark);
    scene.world.gravity = {};
    Stepper stepper(scene);
    for (int step = 1; step <= steps; ++step) {
      stepper.set_motion(0, {{}, vector_at(end * step / steps), center});
      ASSERT_TRUE(stepper.step(end / steps).converged);
    }
    errors.push_back(norm(stepper.driver_force(0).moment - exact) / norm(exact));
  }
  EXPECT_LT(errors[2], 0.02);
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.3);
  EXPECT_NEAR(errors[1] / errors[2], 2, 0.2);
}

/// Impulse and momentum of implicit Euler steps, exact for any motion of a soft block: F + m g = (p − p₋) / dt.
TEST(DriverForce, ChangesTheMomentum) {
  for (const bool elements : {false, true}) {
    Scene scene =
        elements ? test::driven_tetrahedra(SolverKind::implicit_euler) : test::driven_block(SolverKind::implicit_euler);
    scene.bodies[0].materials[0].material.mass_damping = 0;
    scene.solver.newton_tolerance = 1e-11;
    Probe momentum;
    momentum.name = "momentum";
    momentum.quantity = Quantity::momentum;
    scene.probes.push_back(momentum);
    Stepper stepper(scene);
    std::vector<double> before = stepper.probe("momentum");
    const double dt = 0.01, mass = 1000 * 0.04 * 0.04 * 0.08;
    for (int step = 1; step <= 5; ++step) {
      stepper.set_motion(0, {{{0.002 * step, 0.001 * step * step, 0}}, {{0.05 * step, 0, 0.1}}, {{0.02, 0, 0}}});
      ASSERT_TRUE(stepper.step(dt).converged);
      const std::vector<double> now = stepper.probe("momentum");
      const Wrench there = stepper.driver_force(0);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(there.force[k] + mass * scene.world.gravity[k], (now[at(k)] - before[at(k)]) / dt,
                    1e-8 * norm(there.force))
            << elements << ' ' << step;
      before = now;
    }
  }
}

/// A step that fails takes nothing with it of what led to the state before, once forces were asked for.
TEST(DriverForce, StaysAfterAStepThatFailed) {
  for (const SolverKind kind : {SolverKind::implicit_euler, SolverKind::newmark, SolverKind::midpoint}) {
    Stepper stepper(test::driven_block(kind)), other(test::driven_block(kind));
    stepper.driver_force(0);
    std::stop_source stop;
    stop.request_stop();
    for (Stepper* s : {&stepper, &other})
      for (int step = 1; step <= 3; ++step) {
        s->set_motion(0, {{{0.001 * step * step, 0, 0}}, {}, {}});
        ASSERT_TRUE(s->step(0.01).converged);
      }
    stepper.set_motion(0, {{{0.02, 0, 0}}, {}, {}});
    EXPECT_TRUE(stepper.step(0.01, stop.get_token()).stopped);
    const Wrench a = stepper.driver_force(0), b = other.driver_force(0);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a.force[k], b.force[k]) << static_cast<int>(kind);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a.moment[k], b.moment[k]) << static_cast<int>(kind);
  }
}

/// Two hands on one block: each has its share, and both together carry the weight.
TEST(DriverForce, OfTwoDriversAddsUp) {
  Scene scene = test::driven_block(SolverKind::statics);
  Constraint top = scene.constraints[0];
  top.where = in_box({{-1, -1, 0.079}}, {{1, 1, 1}});
  top.driver = "top";
  scene.constraints.push_back(top);
  Stepper stepper(scene);
  stepper.set_motion(stepper.driver("top"), {{{0, 0, 0.004}}, {}, {}});
  ASSERT_TRUE(stepper.step(1).converged);
  const Wrench below = stepper.driver_force(stepper.driver("foot")),
               above = stepper.driver_force(stepper.driver("top"));
  EXPECT_GT(above.force[2], 1);
  EXPECT_LT(below.force[2], 0);
  EXPECT_NEAR(above.force[2] + below.force[2], 9.81 * 1000 * 0.04 * 0.04 * 0.08, 1e-7);
}

Scene clamped(const char* kind) {
  Scene scene = kind == std::string("tetrahedra") ? test::driven_tetrahedra(SolverKind::statics)
                                                  : test::driven_block(SolverKind::statics);
  if (kind == std::string("scattered")) scene.bodies[0].frames = CountedSamples{40, 1};
  if (kind == std::string("affine")) scene.bodies[0].affine = true;
  scene.world.gravity = {};
  scene.solver.newton_tolerance = 1e-12;
  Constraint top = scene.constraints[0];
  top.where = in_box({{-1, -1, 0.079}}, {{1, 1, 1}});
  top.driver.clear();
  scene.constraints.push_back(top);
  Probe energy;
  energy.name = "energy";
  energy.quantity = Quantity::total_energy;
  scene.probes.push_back(energy);
  return scene;
}

/// Slow motions do the work that the energy gains: dE = F · du + M · dθ, with M about the driver's center, of large
/// deformation. Differences of 1e-4 of the size leave about 1e-7.
TEST(DriverForce, DoesTheWorkThatTheEnergyGains) {
  for (const char* kind : {"frames", "affine", "tetrahedra", "scattered"}) {
    Stepper stepper(clamped(kind));
    const RigidMotion pose{{{0.01, -0.004, 0.006}}, {{0.2, 0.1, -0.4}}, {{0.02, 0.03, -0.05}}};
    double time = 0;
    const auto energy_at = [&](const RigidMotion& motion) {
      stepper.set_motion(0, motion);
      const StepReport step = stepper.step(time == 0 ? 1 : 0.01);
      EXPECT_TRUE(step.converged) << step.message;
      time = stepper.time();
      return stepper.probe("energy")[0];
    };
    energy_at(pose);
    const Wrench there = stepper.driver_force(0);
    for (int k = 0; k < 6; ++k) {
      const double size = k < 3 ? 4e-6 : 1e-4;
      const auto moved = [&](double by) {
        RigidMotion m = pose;
        if (k < 3) {
          m.translation[k] += by;
        } else {
          Vec3d turn;
          turn[k - 3] = by;
          m.rotation = rotation_vector(compose_increments(rotation_increment(turn), rotation_increment(pose.rotation)));
        }
        return m;
      };
      const double slope = (energy_at(moved(size)) - energy_at(moved(-size))) / (2 * size);
      const double scale = k < 3 ? norm(there.force) : norm(there.moment);
      EXPECT_NEAR(k < 3 ? there.force[k] : there.moment[k - 3], slope, 1e-6 * scale) << kind << ' ' << k;
    }
  }
}

/// A probe over the region of a driver sums the same forces, in dynamics and on a GPU's way of stepping too.
TEST(DriverForce, IsThatOfAProbeOverItsRegion) {
  test::take_host_as_device();
  for (const char* backend : {"cpu", "cuda"})
    for (const SolverKind kind : {SolverKind::statics, SolverKind::newmark, SolverKind::midpoint}) {
      Scene scene = test::driven_block(kind);
      scene.solver.backend = backend;
      Probe moment = scene.probes[1];
      moment.name = "moment";
      moment.quantity = Quantity::moment;
      moment.about = Vec3d{{0.3, 0.1, -0.2}};
      scene.probes.push_back(moment);
      Stepper stepper(scene);
      stepper.set_motion(0, {{{0.001, 0, 0}}, {{0, 0.03, 0}}, {{0.02, 0.02, 0}}});
      ASSERT_TRUE(stepper.step(0.05).converged);
      const Wrench there = stepper.driver_force(0, moment.about);
      const std::vector<double> force = stepper.probe("force"), about = stepper.probe("moment");
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(there.force[k], force[at(k)], 1e-14) << backend;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(there.moment[k], about[at(k)], 1e-15) << backend;
    }
}

/// Where a support holds the same nodes along another axis, its force is not the driver's.
TEST(DriverForce, IsAlongTheAxesThatTheDriverMoves) {
  Scene scene = test::driven_tetrahedra(SolverKind::statics);
  scene.constraints[0].fixed = {true, false, true, false, false, false};
  Constraint side = scene.constraints[0];
  side.fixed = {false, true, false, false, false, false};
  side.driver.clear();
  scene.constraints.push_back(side);
  scene.world.gravity = {{1, 2, -9.81}};
  Stepper stepper(scene);
  ASSERT_TRUE(stepper.step(1).converged);
  const Wrench there = stepper.driver_force(0);
  const std::vector<double> all = stepper.probe("force");
  EXPECT_NEAR(there.force[0], all[0], 1e-14);
  EXPECT_EQ(there.force[1], 0);
  EXPECT_GT(std::abs(all[1]), 0.1);
  EXPECT_NEAR(there.force[2], all[2], 1e-14);
}

TEST(DriverForce, RefusesWhatIsNotThere) {
  Stepper stepper(test::driven_block(SolverKind::statics));
  EXPECT_THROW(stepper.driver_force(1), InputError);
  EXPECT_THROW(stepper.driver_force(-1), InputError);
  EXPECT_THROW(stepper.driver_force(0, Vec3d{{std::numeric_limits<double>::quiet_NaN(), 0, 0}}), InputError);
}

}  // namespace

}  // namespace fascia::driver_force_test
