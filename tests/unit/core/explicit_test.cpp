#include "core/base/errors.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>

/// Central differences: what they keep, their limit, their order, and what holds, drives and damps a body.
namespace fascia::explicit_test {
namespace {

using namespace test;

struct Outcome {
  RunReport report;
  State state;
  double energy_error = 0;  ///< largest change of the total energy, relative to the kinetic energy at the start
  double momentum_error = 0, spin_error = 0;
};

/// Without loads and boundaries, also follows what must stay.
Outcome run(const Model& model, const State& start, double dt, int steps, const FactorFunction& factors = kAlways) {
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  Outcome r;
  r.state = start;
  const Momentum first = total_momentum(model, start);
  r.report = run_explicit(system, r.state, factors, {dt, steps, {}},
                          [&](const StepInfo&, const State& state, MechanicalSystem& at_state) {
                            const Momentum m = total_momentum(model, state);
                            const double energy = m.kinetic_energy + at_state.internal_energy().total();
                            r.energy_error = std::max(r.energy_error, std::abs(energy / first.kinetic_energy - 1));
                            r.momentum_error = std::max(r.momentum_error, norm(m.linear - first.linear));
                            r.spin_error = std::max(r.spin_error, norm(m.angular - first.angular));
                            return true;
                          });
  r.momentum_error /= norm(first.linear);
  r.spin_error /= norm(first.angular);
  return r;
}

double limit_of(const Model& model) {
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  return stable_time_step(system) / kStableMargin;
}

TEST(Explicit, TumblingBlockKeepsEnergyAndMomentum) {
  std::printf("%-8s %6s %10s %12s %12s %12s\n", "frames", "dt/lim", "steps", "energy", "momentum", "spin");
  for (const bool affine : {false, true}) {
    BlockOptions o;
    o.grid = {5, 3, 3};
    o.size = {{1, 0.5, 0.5}};
    o.young = 4e5;
    o.affine = affine;
    if (affine) o.drilling = 0.003;
    const BuiltModel built = block(o);
    const double limit = limit_of(built.model);
    const State start = spinning_state(built.model, {{1, -2, 3.7}}, {{0.3, 0.2, 0}});
    for (const double part : {0.45, 0.9, 1.05}) {
      const int steps = static_cast<int>(2 / (part * limit));
      const Outcome r = run(built.model, start, part * limit, steps);
      std::printf("%-8s %6.2f %10d %12.1e %12.1e %12.1e %s\n", affine ? "affine" : "rigid", part, r.report.steps,
                  r.energy_error, r.momentum_error, r.spin_error, r.report.message.c_str());
      if (part > 1) {
        EXPECT_EQ(r.report.status, RunStatus::diverged);
        continue;
      }
      EXPECT_EQ(r.report.status, RunStatus::converged) << r.report.message;
      EXPECT_LT(r.energy_error, 1e-4);
      EXPECT_LT(r.momentum_error, 1e-12);
      EXPECT_LT(r.spin_error, 1e-12);
    }
  }
}

TEST(Explicit, FreeFallIsExact) {
  BuiltModel built = block();
  add_gravity(built.model, {{0, 0, -9.81}});
  const double dt = 0.9 * limit_of(built.model);
  const int n = 50;
  const Outcome r = run(built.model, State::at_rest(built.model), dt, n);
  const double expected = -9.81 * dt * dt * n * n / 2;
  for (const Vec3d& u : r.state.u) EXPECT_NEAR(u[2], expected, 1e-12 * std::abs(expected));
  for (const Vec3d& v : r.state.v) EXPECT_NEAR(v[2], -9.81 * dt * n, 1e-12 * 9.81 * dt * n);
}

State settle(const Model& model, const State& start, double time, int steps, const FactorFunction& factors) {
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State state = start;
  const RunReport report = run_explicit(system, state, factors, {time / steps, steps, {}}, nullptr);
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  return state;
}

double distance(const State& a, const State& b, bool velocities) {
  double sum = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    sum += squared_norm(velocities ? a.v[i] - b.v[i] : a.u[i] - b.u[i]);
    const Mat3d d = velocities ? a.Q_dot[i] - b.Q_dot[i] : a.D[i] - b.D[i];
    sum += 0.1 * contract(d, d);
  }
  return std::sqrt(sum);
}

/// Second order in displacements and in velocities, whatever holds and drives the body (stiffness damping lags: first),
/// and the motion of the midpoint rule.
TEST(Explicit, OrderInTime) {
  std::printf("%-20s %10s %7s %10s %7s %12s\n", "body", "u", "ratio", "v", "ratio", "to midpoint");
  for (const char* kind : {"rigid", "affine", "vertices", "mass damping", "stiffness damping", "sliding on a plane",
                           "pinned", "turned boundary", "vertices, driven"}) {
    const std::string name = kind;
    BlockOptions o;
    o.grid = {3, 2, 2};
    o.size = {{1, 0.5, 0.3}};
    o.affine = name == "affine";
    if (o.affine) o.drilling = 0.003;
    if (name == "mass damping") o.mass_damping = 2;
    if (name == "stiffness damping") o.stiffness_damping = 2e-4;
    Model model = name.starts_with("vertices") ? vertex_block(o) : block(o).model;
    State start = State::at_rest(model);
    FactorFunction factors = kAlways;
    if (name == "turned boundary" || name == "vertices, driven") {
      hold_face(model);
      PrescribedMotion motion;
      motion.axis = {{1, 0, 0}};
      motion.angle = 0.5;
      motion.translation = {{0.1, 0, 0}};
      model.motions.push_back(motion);
      for (FrameConstraint& c : model.constraints) {
        c.translation_motion = {0, 0, 0};
        c.rotation_motion = {0, 0, 0};
      }
      factors = [](double t) { return std::vector<double>{t * t * t * t * 256}; };
    } else {
      add_gravity(model, {{0, 0, -3}});
      if (name == "sliding on a plane") hold_face(model, 1, 2);
      if (name == "pinned") hold_face(model, 3, 0);
      if (name == "sliding on a plane") start = spinning_state(model, {{2, 0, 0}}, {});
      for (std::size_t i = 0; i < start.v.size() && !model.constraints.empty(); ++i)
        start.v[i][0] += 0.5 * model.rest_position[i][0];
      if (model.constraints.empty()) start = spinning_state(model, {{1, -2, 3}}, {{0.3, 0.2, 0}});
    }
    start.turned.resize(model.constraints.size());
    const double time = 0.25;
    const int steps = 2 * static_cast<int>(time / limit_of(model)) + 8;
    State ends[3];
    for (int k = 0; k < 3; ++k) ends[k] = settle(model, start, time, steps << k, factors);
    ThreadPool pool(1);
    MechanicalSystem system(model, pool, {});
    State implicit = start;
    run_implicit(system, implicit, factors, {}, {TimeScheme::midpoint, time / (4 * steps), 4 * steps}, nullptr);
    const double u = distance(ends[0], ends[1], false) / distance(ends[1], ends[2], false);
    const double v = distance(ends[0], ends[1], true) / distance(ends[1], ends[2], true);
    const double apart = distance(ends[2], implicit, false) / distance(ends[2], start, false);
    std::printf("%-20s %10.2e %7.2f %10.2e %7.2f %12.1e\n", kind, distance(ends[1], ends[2], false), u,
                distance(ends[1], ends[2], true), v, apart);
    const double expected = name == "stiffness damping" ? 2 : 4;
    EXPECT_GT(u, 0.8 * expected) << kind;
    EXPECT_GT(v, 0.75 * expected) << kind;
    EXPECT_LT(apart, 3e-3) << kind;
  }
}

/// A small motion with stiffness damping: stable just below the limit, unstable just above.
TEST(Explicit, StiffnessDampingLowersTheLimit) {
  std::printf("%-10s %12s\n", "beta [s]", "limit [s]");
  double previous = 1e300;
  for (const double beta : {0.0, 1e-3, 1e-2, 1e-1}) {
    BlockOptions o;
    o.stiffness_damping = beta;
    BuiltModel built = block(o);
    hold_face(built.model);
    add_gravity(built.model, {{0, 0, -1e-6}});
    const double limit = limit_of(built.model);
    std::printf("%-10.0e %12.3e\n", beta, limit);
    EXPECT_LT(limit, previous);
    previous = limit;
    EXPECT_EQ(run(built.model, State::at_rest(built.model), 0.98 * limit, 2000).report.status, RunStatus::converged);
    const Outcome above = run(built.model, State::at_rest(built.model), 1.03 * limit, 2000);
    EXPECT_EQ(above.report.status, RunStatus::diverged) << beta;
    for (const Vec3d& u : above.state.u) EXPECT_TRUE(std::isfinite(norm(u)));
  }
}

/// A gliding body: exp(−α t), by central differences ((1 − α h/2) / (1 + α h/2))ⁿ.
TEST(Explicit, MassDampingSlowsAFreeBody) {
  for (const bool vertices : {false, true}) {
    BlockOptions o;
    o.mass_damping = 3;
    const Model model = vertices ? vertex_block(o) : block(o).model;
    State start = State::at_rest(model);
    for (Vec3d& v : start.v) v = {{1, 0, 0}};
    const double h = 0.5 * limit_of(model), a = 0.5 * 3 * h;
    const int n = 40;
    const State end = settle(model, start, n * h, n, kAlways);
    for (const Vec3d& v : end.v) EXPECT_NEAR(v[0], std::pow((1 - a) / (1 + a), n), 1e-12);
  }
}

/// Boundaries that jump, ramps and loads set bodies in motion without a false alarm, and end on their targets.
TEST(Explicit, DrivenBodiesAreNotCalledUnstable) {
  for (const bool vertices : {false, true}) {
    BlockOptions o;
    o.grid = {4, 3, 3};
    Model model = vertices ? vertex_block(o) : block(o).model;
    hold_face(model);
    PrescribedMotion motion;
    motion.translation = {{0.002, 0.001, 0}};
    model.motions.push_back(motion);
    for (FrameConstraint& c : model.constraints) c.translation_motion = {0, 0, 0};
    const double dt = limit_of(model) * kStableMargin;
    const State end = settle(model, State::at_rest(model), 400 * dt, 400,
                             [&](double t) { return std::vector<double>{t > 50 * dt ? 1.0 : 0.0}; });
    for (const FrameConstraint& c : model.constraints) EXPECT_LT(norm(end.u[at(c.node)] - motion.translation), 1e-14);
  }
}

TEST(Explicit, RefusesNodesWithoutInertia) {
  BuiltModel built = block();
  built.model.inertia[5].second = {};
  built.model.inertia[5].first = {};
  ThreadPool pool(1);
  MechanicalSystem system(built.model, pool, {});
  EXPECT_THROW(stable_time_step(system), InputError);
  Model model = vertex_block();
  model.inertia[3].mass = 0;
  MechanicalSystem vertices(model, pool, {});
  EXPECT_THROW(stable_time_step(vertices), InputError);
}

/// Only chosen steps are seen, and results do not depend on that or on threads.
TEST(Explicit, ObserverSeesChosenSteps) {
  BuiltModel built = block();
  add_gravity(built.model, {{0, 0, -1}});
  hold_face(built.model);
  State ends[2];
  for (int k = 0; k < 2; ++k) {
    ThreadPool pool(k + 1);
    MechanicalSystem system(built.model, pool, {});
    ends[k] = State::at_rest(built.model);
    std::vector<int> seen;
    const auto tenth = [](const StepInfo& info) { return info.step % 10 == 0; };
    ExplicitSettings settings{1e-3, 25, {}};
    if (k == 1) settings.observed = tenth;
    run_explicit(system, ends[k], kAlways, settings, [&](const StepInfo& info, const State&, MechanicalSystem&) {
      seen.push_back(info.step);
      return true;
    });
    EXPECT_EQ(seen.size(), k == 0 ? 25U : 3U);
  }
  for (std::size_t i = 0; i < ends[0].u.size(); ++i) {
    EXPECT_EQ(ends[0].u[i], ends[1].u[i]);
    EXPECT_EQ(ends[0].v[i], ends[1].v[i]);
  }
}

}  // namespace
}  // namespace fascia::explicit_test
