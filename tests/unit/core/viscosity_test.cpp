#include "core/base/errors.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "tests/support/fading.hpp"
#include "tests/support/models.hpp"
#include "tests/support/shell_models.hpp"
#include "tests/support/statics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

/// Stresses that fade: a step's share of them, what a state remembers, statics, and where results see it.
namespace fascia::viscosity_test {
namespace {

using namespace test;

/// A growth at an even rate from 0 to 1 leaves the same in one step as in a thousand.
TEST(Viscosity, AStepIsExactForAnEvenGrowth) {
  for (const double ratio : {1e-12, 1e-3, 0.7, 30.0, 1e4}) {
    const ViscousBranch branch{0.4, 1};
    const BranchStep whole = BranchStep::of(branch, ratio), part = BranchStep::of(branch, ratio / 1000);
    double Q = 0;
    for (int k = 0; k < 1000; ++k) Q = part.decay * Q + part.gain / 1000;
    EXPECT_NEAR(whole.gain, Q, 1e-12 * Q) << ratio;
    EXPECT_NEAR(whole.decay, std::pow(part.decay, 1000), 1e-12) << ratio;
  }
  EXPECT_EQ(BranchStep::of({0.4, 1}, 0).gain, 0.4);
  EXPECT_EQ(BranchStep::of({0.4, 1}, 0).decay, 1);
  const BranchStep ever = BranchStep::of({0.4, 1}, std::numeric_limits<double>::infinity());
  EXPECT_EQ(ever.gain, 0);
  EXPECT_EQ(ever.decay, 0);
}

TEST(Viscosity, WhatNoMaterialHasIsRefused) {
  const auto with = [](Viscosity viscosity, double damping = 0) {
    BlockOptions o;
    o.viscosity = std::make_shared<const Viscosity>(std::move(viscosity));
    o.stiffness_damping = damping;
    return block(o);
  };
  EXPECT_THROW(with({{{0.6, 1}, {0.4, 2}}}), InputError);
  EXPECT_THROW(with({{{-0.1, 1}}}), InputError);
  EXPECT_THROW(with({{{0.1, 0}}}), InputError);
  EXPECT_THROW(with({{{0.1, 1}}}, 0.01), InputError);
  BlockOptions o;
  o.viscosity = two_branches(true);
  EXPECT_THROW(build_cloud(thin_spec({3, 3}, o)), InputError);
  EXPECT_THROW(shell_model(patch_mesh(
                               [](double u, double v) {
                                 return Vec3d{{u, v, 0}};
                               },
                               {}),
                           {.viscosity = two_branches(true)}),
               InputError);
}

/// Both ends of a bar, one of which a motion pulls.
Model pulled(const BlockOptions& options) {
  BlockOptions o = options;
  o.grid = {2, 2, 2};
  o.density = 1e-6;
  Model model = block(o).model;
  hold_face(model);
  hold_face(model, 1);
  PrescribedMotion motion;
  motion.translation = {{0.1, 0.02, 0}};
  model.motions.push_back(motion);
  for (FrameConstraint& c : model.constraints)
    if (model.rest_position[at(c.node)][0] > 0.5) c.translation_motion = {0, 0, 0};
  return model;
}

double pull(const MechanicalSystem& system) {
  double sum = 0;
  for (int i = 0; i < system.model().node_count(); ++i)
    if (system.model().rest_position[at(i)][0] > 0.5) sum += system.gradient()[at(system.model().points.dofs.begin(i))];
  return sum;
}

/// Pulled in one step and held: what acts fades as the series says, in every scheme and with any law.
TEST(Viscosity, HeldStretchRelaxesAsTheSeriesSays) {
  constexpr double kStep = 0.05;
  const FactorFunction hold = [](double t) { return std::vector<double>{std::min(1.0, t / kStep)}; };
  std::printf("%-20s %-10s %14s %14s %9s\n", "law", "scheme", "force left", "series", "error");
  for (const Law law : {Law::st_venant_kirchhoff, Law::neo_hookean, Law::mooney_rivlin})
    for (const TimeScheme scheme :
         {TimeScheme::implicit_euler, TimeScheme::bdf2, TimeScheme::newmark, TimeScheme::midpoint}) {
      BlockOptions o;
      o.law = law;
      const Model plain = pulled(o);
      o.viscosity = two_branches();
      const Model fading = pulled(o);
      ThreadPool pool(1);
      const SolverSettings settings;
      MechanicalSystem of_plain(plain, pool, settings), of_fading(fading, pool, settings);
      State a = State::at_rest(plain), b = State::at_rest(fading);
      const auto at_end = [&](MechanicalSystem& system, State& state, int steps) {
        const RunReport run = run_implicit(system, state, hold, settings, {scheme, kStep, steps}, nullptr);
        EXPECT_EQ(run.status, RunStatus::converged) << run.message;
        system.set_factors(std::vector<double>{1.0});
        system.look_at(state, kStep);
        return pull(system);
      };
      constexpr int kSteps = 7;
      const double elastic = at_end(of_plain, a, kSteps), left = at_end(of_fading, b, kSteps) / elastic;
      double series = o.viscosity->long_term();
      for (const ViscousBranch& branch : o.viscosity->branches)
        series += BranchStep::of(branch, kStep).gain * std::exp(-(kSteps - 1) * kStep / branch.time);
      std::printf("%-20d %-10d %14.10f %14.10f %9.1e\n", static_cast<int>(law), static_cast<int>(scheme), left, series,
                  std::abs(left / series - 1));
      EXPECT_NEAR(left, series, 1e-9) << static_cast<int>(law) << static_cast<int>(scheme);
    }
}

/// A bar under its weight, which creeps.
BuiltModel creeping(bool shear_only = false) {
  BlockOptions o;
  o.grid = {4, 2, 2};
  o.size = {{1, 0.3, 0.3}};
  o.viscosity = two_branches(shear_only);
  BuiltModel built = block(o);
  hold_face(built.model);
  add_gravity(built.model, {{0, 0, -0.5}});
  return built;
}

/// Factors of each tangent, which know nothing of steps before.
SolverSettings direct() {
  SolverSettings settings;
  settings.linear = LinearMethod::cholesky;
  return settings;
}

State stepped(MechanicalSystem& system, State state, double dt, int steps) {
  const SolverSettings settings = direct();
  const RunReport run =
      run_implicit(system, state, kAlways, settings, {TimeScheme::implicit_euler, dt, steps}, nullptr);
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  return state;
}

bool same(const State& a, const State& b) {
  bool equal = a.memory == b.memory && a.u.size() == b.u.size();
  for (std::size_t i = 0; equal && i < a.u.size(); ++i) equal = a.u[i] == b.u[i] && a.v[i] == b.v[i];
  return equal;
}

/// All that is remembered is in the state: another system goes on from a copy of it, bit for bit.
TEST(Viscosity, AStateHasAllThatIsRemembered) {
  const BuiltModel built = creeping();
  ThreadPool pool(1);
  MechanicalSystem first(built.model, pool, direct()), second(built.model, pool, direct());
  const State middle = stepped(first, State::at_rest(built.model), 0.02, 3);
  EXPECT_EQ(middle.memory.size(), built.model.points.memory.size());
  const State end = stepped(first, middle, 0.02, 3), again = stepped(second, middle, 0.02, 3);
  EXPECT_TRUE(same(end, again));
  double largest = 0;
  for (const double S : end.memory) largest = std::max(largest, std::abs(S));
  EXPECT_GT(largest, 1);
}

/// A step that is begun and left has not happened.
TEST(Viscosity, AStepThatIsGivenUpIsForgotten) {
  const BuiltModel built = creeping();
  ThreadPool pool(1);
  MechanicalSystem straight(built.model, pool, direct()), halving(built.model, pool, direct());
  const State middle = stepped(straight, State::at_rest(built.model), 0.02, 3);
  const State copy = stepped(halving, State::at_rest(built.model), 0.02, 3);
  halving.begin_step(copy, 0.5);
  halving.evaluate();
  halving.direction();
  halving.apply(0.7);
  halving.evaluate();
  EXPECT_TRUE(same(stepped(straight, middle, 0.01, 2), stepped(halving, copy, 0.01, 2)));
}

/// A strained state that remembers nothing has rested so: what acts at once is what lasts.
TEST(Viscosity, AStateWithoutAMemoryHasRestedAsItIs) {
  const BuiltModel built = creeping();
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  const State start = random_state(built.model, 0.01, 0.1);
  const auto forces = [&](double dt) {
    system.begin_step(start, dt);
    system.evaluate();
    return std::vector<double>(system.gradient().begin(), system.gradient().end());
  };
  system.set_factors(std::vector<double>{0.0});
  const std::vector<double> waits = forces(0);
  system.look_at(start, 0.01);
  const std::vector<double> acts(system.gradient().begin(), system.gradient().end());
  double apart = 0;
  for (std::size_t i = 0; i < acts.size(); ++i) apart = std::max(apart, std::abs(acts[i] - waits[i]));
  EXPECT_LT(apart, 1e-12 * norm(waits));
}

/// Central differences at nearly their stable step, which stays short of what fades within it.
TEST(Viscosity, AutomaticExplicitStepsStayStable) {
  BlockOptions o;
  o.grid = {3, 2, 2};
  o.size = {{1, 0.3, 0.3}};
  for (const double ratio : {0.1, 1.0, 10.0}) {  // of the step to the time in which nine tenths fade
    o.viscosity = nullptr;
    BuiltModel plain = block(o);
    ThreadPool pool(1);
    MechanicalSystem of_plain(plain.model, pool, {});
    const double stable = stable_time_step(of_plain);
    o.viscosity = std::make_shared<const Viscosity>(Viscosity{{{0.9, stable / ratio}}, false, false});
    BuiltModel built = block(o);
    hold_face(built.model);
    add_gravity(built.model, {{0, 0, -0.1}});
    MechanicalSystem system(built.model, pool, {});
    State state = State::at_rest(built.model);
    ExplicitSettings settings{stable, 0, {}};
    settings.duration = 2000 * stable;
    settings.automatic = true;
    const RunReport run = run_explicit(system, state, kAlways, settings, nullptr);
    EXPECT_EQ(run.status, RunStatus::converged) << run.message;
    double fastest = 0;
    for (const Vec3d& v : state.v) fastest = std::max(fastest, norm(v));
    EXPECT_LT(fastest, 1) << ratio;
  }
}

/// Statics with what lasts equal those of a softer law; at once, those of the law.
TEST(Viscosity, StaticsWaitOrDoNot) {
  const auto sag = [](double young, std::shared_ptr<const Viscosity> viscosity) {
    BlockOptions o;
    o.grid = {4, 2, 2};
    o.size = {{1, 0.3, 0.3}};
    o.young = young;
    o.drilling = 0;  // numerical stiffness does not fade
    o.weights = GridWeightKind::trilinear;
    o.viscosity = std::move(viscosity);
    BuiltModel built = block(o);
    hold_face(built.model);
    add_gravity(built.model, {{0, 0, -0.05}});
    ThreadPool pool(1);
    const SolverSettings settings;
    MechanicalSystem system(built.model, pool, settings);
    State state = State::at_rest(built.model);
    const RunReport run = run_statics(system, state, kRamp, settings, {}, nullptr);
    EXPECT_EQ(run.status, RunStatus::converged) << run.message;
    double largest = 0;
    for (const Vec3d& u : state.u) largest = std::max(largest, -u[2]);
    return largest;
  };
  Viscosity at_once = *two_branches();
  at_once.instantaneous_statics = true;
  const double soft = sag(5e3, nullptr), stiff = sag(1e4, nullptr);
  EXPECT_NEAR(sag(1e4, two_branches()), soft, 1e-8 * soft);
  EXPECT_NEAR(sag(1e4, std::make_shared<const Viscosity>(at_once)), stiff, 1e-8 * stiff);
}

/// Where nothing has faded yet, stresses are those of the law everywhere, between the points and at the faces too.
TEST(Viscosity, StressesBetweenPointsAreThoseOfTheLaw) {
  const auto bent = [](std::shared_ptr<const Viscosity> viscosity) {
    BlockOptions o;
    o.viscosity = std::move(viscosity);
    BuiltModel built = build_cloud(thin_spec({7, 3}, o));
    hold_face(built.model);
    add_gravity(built.model, {{0, 0, -0.02}});
    return built;
  };
  Viscosity at_once = *two_branches();
  at_once.instantaneous_statics = true;
  std::vector<Mat3d> found[2];
  for (const bool fades : {false, true}) {
    const BuiltModel built = bent(fades ? std::make_shared<const Viscosity>(at_once) : nullptr);
    const State end = solved(built.model, {}).end;
    CloudBody body = built.clouds[0];
    body.blocks.groups.count = built.model.points.group_count();
    body.find_memories(built.model.points);
    for (const double z : {-0.01, -0.003, 0.0, 0.01}) {
      const Vec3d X{{0.21, 0.4, z}};
      std::size_t nearest = 0;
      for (std::size_t q = 0; q < body.points().size(); ++q)
        if (norm(body.points()[q].X - X) < norm(body.points()[nearest].X - X)) nearest = q;
      found[fades ? 1 : 0].push_back(body.tensors_at(body.attach(X), nearest, end).stress);
    }
  }
  double largest = 0, apart = 0;
  for (std::size_t k = 0; k < found[0].size(); ++k) {
    largest = std::max(largest, norm(found[0][k]));
    apart = std::max(apart, norm(found[0][k] - found[1][k]));
  }
  EXPECT_GT(largest, 1);
  EXPECT_LT(apart, 1e-6 * largest);
}

/// Between points the same part is left, however far the stress has swung; where the law's stress passes through zero
/// at the point, as in a swing, nothing grows beyond what is left there and what branches take at once.
TEST(Viscosity, WhatIsLeftNearAPointIsBounded) {
  Mat3d fading, left, other;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      fading(i, j) = 1 + i * j;
      other(i, j) = i == j ? 40 : -3;
    }
  left = fading * 0.2;
  EXPECT_LT(norm(RememberedStress{fading, left, 0.4}.at(fading * -1.7) - left * -1.7), 1e-12 * norm(left));
  EXPECT_EQ(norm(RememberedStress{fading, left, 0.4}.at(fading) - left), 0);
  EXPECT_EQ(norm(RememberedStress{{}, left, 0.4}.at(other) - left), 0);
  for (const double swing : {1e-3, 1e-9, 1e-100}) {
    const RememberedStress past{fading * swing, left, 0.4};
    EXPECT_LE(norm(past.at(other) - left), (1 + 1e-12) * (norm(left) + 0.4 * norm(other - past.fading))) << swing;
    // A stress that swings alike is told without error at any moment.
    EXPECT_LT(norm(past.at(past.fading * 1.7) - left * 1.7), 1e-12 * norm(left)) << swing;
  }
}

/// Explicit steps and implicit ones go to the same motion; reported stresses are those that act.
TEST(Viscosity, ExplicitStepsAndReportedStressesAgree) {
  const BuiltModel built = creeping(true);
  const SolverSettings settings;
  ThreadPool pool(1);
  MechanicalSystem implicit(built.model, pool, settings), central(built.model, pool, settings);
  const double dt = 0.25 * stable_time_step(central);
  const int steps = static_cast<int>(0.4 / dt);
  State a = State::at_rest(built.model), b = a;
  run_implicit(implicit, a, kAlways, settings, {TimeScheme::newmark, dt, steps}, nullptr);
  const RunReport run = run_explicit(central, b, kAlways, {dt, steps, {}}, nullptr);
  EXPECT_EQ(run.status, RunStatus::converged) << run.message;
  double moved = 0, apart = 0, stress = 0, difference = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    moved = std::max(moved, norm(a.u[i]));
    apart = std::max(apart, norm(a.u[i] - b.u[i]));
  }
  GridBody body = built.bodies[0];
  body.blocks.groups.count = built.model.points.group_count();
  body.find_memories(built.model.points);
  const auto of_implicit = body.tensors(a), of_explicit = body.tensors(b);
  for (std::size_t q = 0; q < of_implicit.size(); ++q) {
    stress = std::max(stress, norm(of_implicit[q].stress));
    difference = std::max(difference, norm(of_implicit[q].stress - of_explicit[q].stress));
  }
  std::printf("after %d steps: displacements apart by %.1e, stresses by %.1e\n", steps, apart / moved,
              difference / stress);
  EXPECT_LT(apart, 1e-3 * moved);
  EXPECT_LT(difference, 1e-2 * stress);
}

/// Internal forces are the integral of the reported stress, Σ v P g, whatever the state remembers.
TEST(Viscosity, ReportedStressesMakeTheForces) {
  BlockOptions o;
  o.grid = {3, 3, 3};
  o.drilling = 0;
  o.law = Law::neo_hookean;
  o.viscosity = two_branches(true);
  const BuiltModel built = block(o);
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  State state = random_state(built.model, 0.02, 0.2);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-100, 100);
  state.memory.resize(built.model.points.memory.size());
  for (double& S : state.memory) S = uniform(random);
  const StressMemory<PoolSpace> memory(built.model.points.memory);
  AlignedVector<double> given(memory.given_size()), S_e(memory.stress_size());
  std::copy_n(memory.relaxing(), given.size(), given.data());
  system.executor().store_stress(state, given, S_e);
  std::copy(S_e.begin(), S_e.end(), state.memory.begin());
  system.look_at(state, 0.01);
  GridBody body = built.bodies[0];
  body.blocks.groups.count = built.model.points.group_count();
  body.find_memories(built.model.points);
  const std::vector<PointTensors> tensors = body.tensors(state);
  std::vector<Vec3d> force(state.u.size());
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const Attachment a = body.attach_point(q);
    const Mat3d F = Mat3d::identity() + field_at(a, state).H;
    const Mat3d P = tensors[q].stress * transpose(inverse(F)) * determinant(F);
    for (std::size_t k = 0; k < a.nodes.size(); ++k)
      force[at(a.nodes[k])] += P * a.influences[k].g * body.points()[q].volume;
  }
  double largest = 0, error = 0;
  for (int i = 0; i < built.model.node_count(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double acts = system.gradient()[at(built.model.points.dofs.begin(i) + k)];
      largest = std::max(largest, std::abs(acts));
      error = std::max(error, std::abs(acts - force[at(i)][k]));
    }
  EXPECT_LT(error, 1e-12 * largest);
}

}  // namespace
}  // namespace fascia::viscosity_test
