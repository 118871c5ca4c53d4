#include "core/run/explicit_dynamics.hpp"
#include "core/run/explicit_step.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>

/// Central differences with steps of unequal length: a last one that is cut, and steps that follow the state.
namespace fascia::explicit_auto_test {
namespace {

using namespace test;

constexpr double kDuration = 1, kStretch = 3;

/// A slender bar without lateral strain, held at one end; the other one is pulled to three times the length.
Model pulled_bar(double stiffness_damping = 0) {
  BlockOptions o;
  o.grid = {13, 2, 2};
  o.size = {{1, 0.1, 0.1}};
  o.young = 4e5;
  o.poisson = 0;
  o.stiffness_damping = stiffness_damping;
  Model model = vertex_block(o);
  hold_face(model);
  const std::size_t held = model.constraints.size();
  hold_face(model, 1);
  PrescribedMotion motion;
  motion.translation = {{kStretch - 1, 0, 0}};
  model.motions.push_back(motion);
  for (std::size_t k = held; k < model.constraints.size(); ++k) model.constraints[k].translation_motion = {0, 0, 0};
  return model;
}

std::vector<double> smooth(double t) {
  const double s = std::min(t / kDuration, 1.0);
  return {s * s * (3 - 2 * s)};
}

ExplicitSettings automatic(MechanicalSystem& system, double every = 0) {
  return {stable_time_step(system), 0, {}, kDuration, true, every};
}

/// Work of the boundary by the reaction at both ends of each step, against what the bar has gained.
TEST(ExplicitAuto, PullingABarToThreeTimesItsLengthKeepsTheEnergyBalance) {
  const Model model = pulled_bar();
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State state = State::at_rest(model), before = state;
  std::vector<double> reaction(at(model.dof_count()), 0.0);
  double work = 0, gained = 0, smallest = 1, largest = 0;
  const RunReport report = run_explicit(
      system, state, smooth, automatic(system), [&](const StepInfo& info, const State& now, MechanicalSystem& there) {
        for (const FrameConstraint& c : model.constraints)
          for (int k = 0; k < 3; ++k) {
            const auto dof = at(model.points.dofs.begin(c.node) + k);
            work += 0.5 * (reaction[dof] + there.gradient()[dof]) * (now.u[at(c.node)][k] - before.u[at(c.node)][k]);
          }
        reaction.assign(there.gradient().begin(), there.gradient().end());
        before = now;
        gained = there.internal_energy().total() + total_momentum(model, now).kinetic_energy;
        smallest = std::min(smallest, info.time_step);
        largest = std::max(largest, info.time_step);
        return true;
      });
  const double green = 0.5 * (kStretch * kStretch - 1), still = 0.5 * 4e5 * green * green * 0.01;
  std::printf("%d steps of %.2e to %.2e s; work %.4f J, gained %.4f J, at rest %.4f J\n", report.steps, smallest,
              largest, work, gained, still);
  ASSERT_EQ(report.status, RunStatus::converged) << report.message;
  EXPECT_EQ(state.time, kDuration);
  EXPECT_EQ(report.time, kDuration);
  EXPECT_NEAR(work, gained, 1e-3 * gained);
  EXPECT_NEAR(gained, still, 0.02 * still);  // it swings
  // St Venant-Kirchhoff: waves run at sqrt(E (3 λ² − 1) / (2 ρ)) of rest lengths, 3.6 times as fast at the end.
  EXPECT_LT(smallest, largest / 3.4);
  EXPECT_GT(smallest, largest / 4.2);
}

TEST(ExplicitAuto, ConstantStepsOfTheRestStateBlowUp) {
  const Model model = pulled_bar();
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State state = State::at_rest(model);
  const double dt = stable_time_step(system);
  const RunReport report = run_explicit(system, state, smooth, {dt, static_cast<int>(kDuration / dt), {}}, nullptr);
  EXPECT_EQ(report.status, RunStatus::diverged);
  EXPECT_LT(report.time, 0.3 * kDuration) << report.message;
}

/// A step ends at each saved time, whatever the limit is.
TEST(ExplicitAuto, StepsMeetTheSavedTimes) {
  const Model model = pulled_bar();
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State state = State::at_rest(model);
  std::vector<double> met;
  ExplicitSettings settings = automatic(system, 0.3);
  const RunReport report =
      run_explicit(system, state, smooth, settings, [&](const StepInfo& info, const State&, MechanicalSystem&) {
        if (std::abs(info.time / 0.3 - std::round(info.time / 0.3)) < 1e-9 || info.progress == 1)
          met.push_back(info.time);
        return true;
      });
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  EXPECT_EQ(met, (std::vector<double>{1 * 0.3, 2 * 0.3, 3 * 0.3, 1}));
}

/// At rest nothing changes: all steps are the same, and no longer than the limit.
TEST(ExplicitAuto, ABodyAtRestKeepsItsStep) {
  Model model = block().model;
  hold_face(model);
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State state = State::at_rest(model);
  const double limit = stable_time_step(system);
  double smallest = 1, largest = 0;
  run_explicit(system, state, kAlways, {limit, 0, {}, 500.5 * limit, true, 0},
               [&](const StepInfo& info, const State&, MechanicalSystem&) {
                 smallest = std::min(smallest, info.time_step);
                 largest = std::max(largest, info.time_step);
                 return true;
               });
  EXPECT_LE(largest, limit);
  EXPECT_GT(smallest, 0.99 * limit);
}

/// The running estimate against the one from nothing, at states far from rest.
TEST(ExplicitAuto, TheStableStepIsThatOfTheState) {
  std::printf("%-20s %12s %12s %8s\n", "body", "estimate", "from nothing", "ratio");
  for (const char* kind : {"vertices", "rigid", "affine", "held", "stiffness damping"}) {
    const std::string name = kind;
    BlockOptions o;
    o.grid = {4, 3, 3};
    o.affine = name == "affine";
    if (o.affine) o.drilling = 0.003;
    if (name == "stiffness damping") o.stiffness_damping = 5e-3;
    Model model = name == "vertices" ? vertex_block(o) : block(o).model;
    if (name == "held") hold_face(model, 2, 1);
    ThreadPool pool(2);
    MechanicalSystem system(model, pool, {});
    State state = random_state(model, 0.05, name == "held" ? 0.0 : 0.1);
    if (name == "held") state = State::at_rest(model);
    const double expected = stable_time_step(system, state) / kStableMargin;
    ExplicitStepper stepper(system, state, ExplicitPlan({1e-9 * expected, 2, {}}, 0), kAlways);
    stepper.advance();
    double found = expected;
    for (int look = 0; look < 3; ++look) found = stepper.stable_step();
    std::printf("%-20s %12.4e %12.4e %8.4f\n", kind, found, expected, found / expected);
    EXPECT_GT(found, 0.99 * expected) << kind;
    EXPECT_LT(found, 1.02 * expected) << kind;
  }
}

/// A parabola is met exactly by steps of any length, as is the motion of a boundary.
TEST(ExplicitAuto, FreeFallIsExactInUnequalSteps) {
  for (const bool vertices : {false, true}) {
    BlockOptions o;
    Model model = vertices ? vertex_block(o) : block(o).model;
    add_gravity(model, {{0, 0, -9.81}});
    ThreadPool pool(1);
    MechanicalSystem system(model, pool, {});
    State state = State::at_rest(model);
    const double limit = stable_time_step(system);
    ExplicitStepper stepper(system, state, ExplicitPlan({limit, 0, {}, 40 * limit, true, 0}, 0), kAlways);
    double shortest = limit;
    for (int k = 0; k < 40; ++k) {
      stepper.adopt((k % 8 < 4 ? 1 - 0.2 * (k % 4) : 1) * limit);  // shorter at once, longer by and by
      shortest = std::min(shortest, stepper.plan().step());
      stepper.advance();
    }
    EXPECT_LT(shortest, 0.5 * limit);
    stepper.report_velocities();
    const double time = stepper.plan().time();
    EXPECT_GT(time, 10 * limit);
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      EXPECT_NEAR(stepper.pose().u[i][2], -9.81 * time * time / 2, 1e-12);
      EXPECT_NEAR(stepper.pose().v[i][2], -9.81 * time, 1e-11);
    }
  }
}

/// Runs end at their duration, with a last step that is shorter: exact in free fall for all of second order.
TEST(LastStep, IsCut) {
  Model model = vertex_block();
  add_gravity(model, {{0, 0, -9.81}});
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  const double dt = 0.5 * stable_time_step(system), end = 6.3 * dt;
  for (const TimeScheme scheme :
       {TimeScheme::implicit_euler, TimeScheme::bdf2, TimeScheme::newmark, TimeScheme::midpoint}) {
    State state = State::at_rest(model);
    const RunReport report = run_implicit(system, state, kAlways, {}, {scheme, dt, 7, end}, nullptr);
    EXPECT_EQ(report.status, RunStatus::converged) << report.message;
    EXPECT_EQ(report.steps, 7);
    EXPECT_EQ(state.time, end);
    EXPECT_EQ(report.time, end);
    const double sum = (21 * dt * dt + 6.3 * 0.3 * dt * dt) * 9.81;  // implicit Euler: Σ dt v at the ends
    const double expected = scheme == TimeScheme::implicit_euler ? sum : 9.81 * end * end / 2;
    for (const Vec3d& u : state.u) EXPECT_NEAR(u[2], -expected, 1e-7 * expected);
  }
  State state = State::at_rest(model);
  const RunReport report = run_explicit(system, state, kAlways, {dt, 7, {}, end}, nullptr);
  EXPECT_EQ(report.steps, 7);
  EXPECT_EQ(state.time, end);
  for (const Vec3d& u : state.u) EXPECT_NEAR(u[2], -9.81 * end * end / 2, 1e-12);
}

TEST(LastStep, IsWholeUpToRounding) {
  const DynamicsSettings whole{TimeScheme::midpoint, 0.1, 3, 0.3};
  EXPECT_EQ(whole.end_of(3), 0.3);
  EXPECT_EQ(whole.length_of(3), 0.1);
  EXPECT_EQ(whole.end_of(2), 0.2);
  const DynamicsSettings cut{TimeScheme::midpoint, 0.1, 4, 0.35};
  EXPECT_EQ(cut.end_of(4), 0.35);
  EXPECT_NEAR(cut.length_of(4), 0.05, 1e-16);
  EXPECT_EQ(cut.length_of(3), 0.1);
}

}  // namespace
}  // namespace fascia::explicit_auto_test
