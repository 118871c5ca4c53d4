#include "fascia/stepper.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <malloc.h>
#include <cmath>

namespace fascia::snapshot_test {

using test::copied;
using test::same_bits;

namespace {

RigidMotion shaken(int step) {
  return {{{2e-3 * std::sin(0.7 * step), 0, 0}}, {{0.1 * std::sin(0.3 * step), 0.05 * step, 0}}, {{0.02, 0.02, 0}}};
}

void go_on(Stepper& stepper, int from, int count, double dt) {
  for (int step = from; step < from + count; ++step) {
    stepper.set_motion(0, shaken(step));
    ASSERT_TRUE(stepper.step(dt).converged);
  }
}

Scene with_solver(Scene scene, LinearMethod method, PreconditionerKind preconditioner) {
  scene.solver.linear = method;
  scene.solver.preconditioner = preconditioner;
  return scene;
}

/// The steps after a snapshot are the same whether the stepper went on or came back: of all schemes, with direct solves
/// and with preconditioners that are kept from solve to solve.
TEST(Snapshots, WhatFollowsIsTheSameBitForBit) {
  for (const SolverKind kind :
       {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark, SolverKind::midpoint, SolverKind::statics})
    for (const auto& [method, preconditioner] : {std::pair{LinearMethod::automatic, PreconditionerKind::automatic},
                                                 {LinearMethod::cholesky, PreconditionerKind::automatic},
                                                 {LinearMethod::cg, PreconditionerKind::block_jacobi},
                                                 {LinearMethod::cg, PreconditionerKind::multigrid},
                                                 {LinearMethod::cg, PreconditionerKind::cholesky}}) {
      Scene scene = with_solver(test::driven_block(kind), method, preconditioner);
      scene.bodies[0].materials[0].material.stiffness_damping = 0;
      scene.bodies[0].materials[0].material.viscosity = std::make_shared<Viscosity>(Viscosity{{{0.4, 0.05}}});
      Stepper stepper(scene);
      const double dt = kind == SolverKind::statics ? 0.05 : 0.01;
      go_on(stepper, 0, 4, dt);
      const Snapshot snapshot = stepper.snapshot();
      go_on(stepper, 4, 4, dt);
      const std::vector<double> u = copied(stepper.displacements()), v = copied(stepper.velocities());
      const std::vector<double> force = stepper.probe("force");
      go_on(stepper, 8, 2, dt);
      stepper.restore(snapshot);
      EXPECT_NEAR(stepper.time(), 4 * dt, 1e-12);
      go_on(stepper, 4, 4, dt);
      EXPECT_TRUE(same_bits(copied(stepper.displacements()), u)) << static_cast<int>(kind);
      EXPECT_TRUE(same_bits(copied(stepper.velocities()), v)) << static_cast<int>(kind);
      EXPECT_TRUE(same_bits(stepper.probe("force"), force)) << static_cast<int>(kind);
    }
}

/// Forces at a state have the inertia of the step that led there. A program that keeps a state, comes back to it, or
/// tries a step that fails sees no jump of the forces.
TEST(Snapshots, ForcesStayWhereTheStateStays) {
  test::take_host_as_device();
  for (const char* backend : {"cpu", "cuda"})
    for (const SolverKind kind : {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark,
                                  SolverKind::midpoint, SolverKind::statics}) {
      Scene scene = test::driven_block(kind);
      scene.solver.backend = backend;
      Stepper stepper(scene);
      go_on(stepper, 0, 3, 0.01);
      const std::vector<double> force = stepper.probe("force");
      const Snapshot snapshot = stepper.snapshot();
      EXPECT_TRUE(same_bits(stepper.probe("force"), force)) << static_cast<int>(kind);
      const Rows forces = stepper.forces();
      const std::vector<double> all = copied(forces);
      stepper.set_motion(0, {{{1e3, 0, 0}}, {{0, 0, 3}}, {}});
      const bool converged = stepper.step(0.01).converged;
      EXPECT_TRUE(converged || same_bits(stepper.probe("force"), force));
      stepper.restore(snapshot);
      go_on(stepper, 3, 2, 0.01);
      stepper.restore(snapshot);
      EXPECT_TRUE(same_bits(stepper.probe("force"), force)) << static_cast<int>(kind);
      EXPECT_TRUE(same_bits(copied(forces), all)) << static_cast<int>(kind);
    }
}

TEST(Snapshots, OfAGpuToo) {
  test::take_host_as_device();
  for (const SolverKind kind : {SolverKind::bdf2, SolverKind::midpoint}) {
    Scene scene = test::driven_block(kind);
    scene.solver.backend = "cuda";
    Stepper stepper(scene);
    go_on(stepper, 0, 3, 0.01);
    const Snapshot snapshot = stepper.snapshot();
    go_on(stepper, 3, 3, 0.01);
    const std::vector<double> u = copied(stepper.displacements());
    stepper.restore(snapshot);
    go_on(stepper, 3, 3, 0.01);
    EXPECT_TRUE(same_bits(copied(stepper.displacements()), u));
  }
}

/// The pull of tethers is told of the state at hand, whatever was told before.
TEST(Snapshots, ForcesOfTethersAreThoseOfTheState) {
  test::take_host_as_device();
  for (const char* backend : {"cpu", "cuda"}) {
    Scene scene = test::driven_block(SolverKind::midpoint);
    scene.bodies[0].frames = CountedSamples{40, 1};
    scene.solver.backend = backend;
    Stepper stepper(scene);
    go_on(stepper, 0, 2, 0.01);
    const Snapshot first = stepper.snapshot();
    const std::vector<double> then = stepper.probe("force");
    go_on(stepper, 2, 2, 0.01);
    const Snapshot second = stepper.snapshot();
    stepper.probe("force");
    stepper.restore(first);
    EXPECT_TRUE(same_bits(stepper.probe("force"), then)) << backend;
    stepper.restore(second);
    stepper.restore(first);
    EXPECT_TRUE(same_bits(stepper.probe("force"), then)) << backend;
  }
}

/// A thousand times there and back: the same bits, and no more memory.
TEST(Snapshots, AThousandTimes) {
  Stepper stepper(test::driven_tetrahedra(SolverKind::newmark));
  go_on(stepper, 0, 2, 0.01);
  const Snapshot snapshot = stepper.snapshot();
  std::vector<double> first;
  std::size_t held = 0;
  for (int round = 0; round < 1000; ++round) {
    stepper.restore(snapshot);
    go_on(stepper, 2, 1, 0.01);
    const std::vector<double> u = copied(stepper.displacements());
    if (round == 0) first = u;
    ASSERT_TRUE(same_bits(u, first)) << round;
    if (round == 10) held = mallinfo2().uordblks;
  }
  EXPECT_LE(mallinfo2().uordblks, held + 10000);
}

}  // namespace

}  // namespace fascia::snapshot_test
