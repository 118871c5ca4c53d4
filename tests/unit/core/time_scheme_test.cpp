#include "core/run/drivers.hpp"
#include "core/run/modes.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/structure/inertia.hpp"
#include "tests/support/fading.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <string>

/// Implicit schemes: order in time, what each does exactly, and what it keeps.
namespace fascia::time_scheme_test {
namespace {

using namespace test;

constexpr TimeScheme kSchemes[] = {TimeScheme::implicit_euler, TimeScheme::bdf2, TimeScheme::newmark,
                                   TimeScheme::midpoint};
const char* name_of(TimeScheme scheme) {
  constexpr const char* kNames[] = {"implicit Euler", "BDF2", "Newmark", "midpoint"};
  return kNames[static_cast<int>(scheme)];
}

SolverSettings tight() {
  SolverSettings settings;
  settings.tolerance = 1e-11;
  return settings;
}

State run(const Model& model, State state, TimeScheme scheme, double time, int steps,
          const FactorFunction& factors = kAlways) {
  ThreadPool pool(1);
  const SolverSettings settings = tight();
  MechanicalSystem system(model, pool, settings);
  const RunReport report = run_implicit(system, state, factors, settings, {scheme, time / steps, steps}, nullptr);
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  return state;
}

/// Distance of two states, rotations weighted with a length.
double distance(const State& a, const State& b, double length) {
  double sum = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i)
    sum += squared_norm(a.u[i] - b.u[i]) + length * length * contract(a.D[i] - b.D[i], a.D[i] - b.D[i]);
  return std::sqrt(sum);
}

struct Case {
  std::string name;
  Model model;
  State start;
  FactorFunction factors = kAlways;
};

/// Tumbling bodies under gravity, which stretch too, and one that a boundary turns.
Case make_case(const std::string& name) {
  BlockOptions o;
  o.grid = {3, 2, 2};
  o.size = {{1, 0.5, 0.3}};
  if (name == "affine frames") {
    o.affine = true;
    o.drilling = 0.003;
  }
  if (name == "mass damping") o.mass_damping = 2;
  if (name.ends_with("stiffness damping")) o.stiffness_damping = 0.002;
  if (name.ends_with("fading")) o.viscosity = two_branches();
  Case c{name, name.starts_with("vertices") ? vertex_block(o) : block(o).model, {}};
  if (name == "sliding on a plane") hold_face(c.model, 1, 2);
  if (name == "pinned") hold_face(c.model, 3, 0);
  if (name.starts_with("held")) hold_face(c.model);
  if (name == "turned boundary") {
    hold_face(c.model);
    PrescribedMotion motion;
    motion.axis = {{1, 0, 0}};
    motion.angle = 0.5;
    motion.translation = {{0.1, 0, 0}};
    c.model.motions.push_back(motion);
    for (FrameConstraint& constraint : c.model.constraints) {
      constraint.translation_motion = {0, 0, 0};
      constraint.rotation_motion = {0, 0, 0};
    }
    c.start = State::at_rest(c.model);
    c.factors = [](double t) { return std::vector<double>{t * t * t * t * 256}; };
    return c;
  }
  add_gravity(c.model, {{0, 0, -3}});
  if (!c.model.constraints.empty()) {
    c.start = name == "pinned" ? State::at_rest(c.model) : spinning_state(c.model, {{2, 0, 0}}, {});
    for (std::size_t i = 0; i < c.start.v.size(); ++i) c.start.v[i][0] += 0.5 * c.model.rest_position[i][0];
    stop_held(c.model, c.start);
    return c;
  }
  c.start = spinning_state(c.model, {{1, -2, 3}}, {{0.3, 0.2, 0}});
  for (std::size_t i = 0;
       i < c.start.v.size() && (o.stiffness_damping == 0 || name.find("stretching") != std::string::npos); ++i)
    c.start.v[i][0] += 0.5 * c.model.rest_position[i][0];
  return c;
}

/// Errors under step halving fall by 2 (implicit Euler) or 4.
TEST(TimeScheme, OrderInTime) {
  std::printf("%-28s %-15s %10s %10s %7s\n", "body", "scheme", "dt", "dt/2", "ratio");
  for (const char* name :
       {"rigid frames", "affine frames", "vertices", "mass damping", "stiffness damping", "vertices, stiffness damping",
        "stretching, stiffness damping", "vertices, stretching, stiffness damping", "held, stiffness damping",
        "sliding on a plane", "pinned", "turned boundary", "held, fading", "fading"}) {
    const Case c = make_case(name);
    for (const TimeScheme scheme : kSchemes) {
      State ends[3];
      for (int k = 0; k < 3; ++k) ends[k] = run(c.model, c.start, scheme, 0.075, 30 << k, c.factors);
      const double coarse = distance(ends[0], ends[1], 0.3), fine = distance(ends[1], ends[2], 0.3);
      const double expected = scheme == TimeScheme::implicit_euler ? 2 : 4;
      std::printf("%-28s %-15s %10.2e %10.2e %7.2f\n", name, name_of(scheme), coarse, fine, coarse / fine);
      EXPECT_NEAR(coarse / fine, expected, 0.15 * expected) << name << " " << name_of(scheme);
    }
  }
}

/// Implicit Euler's rule keeps nothing that it predicts, and takes nothing that another scheme has left in the system.
TEST(TimeScheme, EulerFollowsOtherSchemes) {
  const double dt = 0.01;
  for (const char* name : {"rigid frames", "vertices", "mass damping"}) {
    const Case c = make_case(name);
    ThreadPool pool(1);
    const SolverSettings settings = tight();
    MechanicalSystem fresh(c.model, pool, settings), used(c.model, pool, settings);
    used.begin_step(c.start, dt, TimeScheme::midpoint, {});
    used.evaluate();
    double energies[2];
    for (int k = 0; k < 2; ++k) {
      MechanicalSystem& system = k == 0 ? fresh : used;
      system.begin_step(c.start, 0.5 * dt, TimeScheme::implicit_euler, {});
      energies[k] = system.evaluate().energy;
    }
    EXPECT_GT(energies[0], 0) << name;
    EXPECT_EQ(energies[0], energies[1]) << name;
  }
}

/// All schemes of second order go to the same motion.
TEST(TimeScheme, SchemesAgree) {
  for (const char* name : {"rigid frames", "stiffness damping", "turned boundary"}) {
    const Case c = make_case(name);
    const State a = run(c.model, c.start, TimeScheme::bdf2, 0.1, 400, c.factors);
    const State b = run(c.model, c.start, TimeScheme::newmark, 0.1, 400, c.factors);
    const State d = run(c.model, c.start, TimeScheme::midpoint, 0.1, 400, c.factors);
    const double moved = distance(a, c.start, 0.3);
    EXPECT_LT(distance(a, b, 0.3), 2e-4 * moved) << name;
    EXPECT_LT(distance(d, b, 0.3), 2e-4 * moved) << name;
  }
}

/// −g t²/2 for all but implicit Euler, from rest, without strain and with one Newton iteration a step.
TEST(TimeScheme, FreeFallIsExact) {
  for (const TimeScheme scheme : kSchemes) {
    for (const double h : {1e-6, 1e-3, 0.05}) {
      BuiltModel built = block();
      add_gravity(built.model, {{0, 0, -9.81}});
      ThreadPool pool(1);
      SolverSettings settings;
      settings.tolerance = 1e-13;
      MechanicalSystem system(built.model, pool, settings);
      State state = State::at_rest(built.model);
      const int n = 20;
      const RunReport report = run_implicit(system, state, kAlways, settings, {scheme, h, n}, nullptr);
      EXPECT_EQ(report.status, RunStatus::converged) << report.message;
      EXPECT_LE(report.newton_iterations, n + 1) << name_of(scheme);
      const double steps = scheme == TimeScheme::implicit_euler ? n * (n + 1) : n * n;
      const double expected = -9.81 * h * h * steps / 2;
      for (const Vec3d& u : state.u) EXPECT_NEAR(u[2], expected, 1e-12 * std::abs(expected)) << name_of(scheme);
      for (const Vec3d& v : state.v) EXPECT_NEAR(v[2], -9.81 * h * n, 1e-11 * 9.81 * h * n) << name_of(scheme);
    }
  }
}

/// One small mode: amplitude factor a step 1/sqrt(1 + (ω h)²) of implicit Euler, 1 of Newmark and midpoint; BDF2 loses
/// (ω h)⁴ / 4.
TEST(TimeScheme, AmplitudeOfOneMode) {
  BlockOptions o;
  o.grid = {4, 2, 2};
  o.size = {{1, 0.3, 0.3}};
  BuiltModel built = block(o);
  hold_face(built.model);
  ThreadPool pool(1);
  const Modes modes = natural_modes(built.model, pool, 1);
  const double omega = 2 * std::numbers::pi * modes.frequency[0], h = 0.1 / omega;
  const double largest = *std::max_element(modes.shape[0].begin(), modes.shape[0].end());
  State start = moved(built.model, State::at_rest(built.model), modes.shape[0], 0.0);
  for (std::size_t i = 0; i < start.v.size(); ++i) {
    const double* d = modes.shape[0].data() + 6 * i;
    start.v[i] = Vec3d{{d[0], d[1], d[2]}} * (1e-7 / largest);
    start.Q_dot[i] = skew(Vec3d{{d[3], d[4], d[5]}} * (1e-7 / largest));
  }
  const int n = 100;
  std::printf("%-15s %18s %14s\n", "scheme", "energy left", "expected");
  for (const TimeScheme scheme : kSchemes) {
    MechanicalSystem system(built.model, pool, tight());
    const SolverSettings settings = tight();
    State state = start;
    run_implicit(system, state, kAlways, settings, {scheme, h, n}, nullptr);
    system.begin_step(state, 0);
    system.evaluate();
    const double before = total_momentum(built.model, start).kinetic_energy;
    const double left = (total_momentum(built.model, state).kinetic_energy + system.internal_energy().total()) / before;
    const double x = omega * h;
    double expected = 1;
    if (scheme == TimeScheme::implicit_euler) expected = std::pow(1 + x * x, -n);
    if (scheme == TimeScheme::bdf2) expected = std::exp(-0.5 * x * x * x * x * n);
    std::printf("%-15s %18.9f %14.9f\n", name_of(scheme), left, expected);
    EXPECT_NEAR(left, expected, scheme == TimeScheme::bdf2 ? 1e-3 : 1e-5) << name_of(scheme);
  }
}

/// Free tumbling for some turns. Midpoint keeps both momenta; Newmark and BDF2 to second order.
TEST(TimeScheme, MomentumAndEnergyOfATumblingBody) {
  std::printf("%-14s %-15s %7s %12s %12s %12s\n", "nodes", "scheme", "dt", "momentum", "spin", "energy");
  for (const char* nodes : {"rigid", "affine", "vertices"}) {
    BlockOptions o;
    o.grid = {4, 3, 2};
    o.size = {{1, 0.6, 0.3}};
    o.young = 1e5;
    o.affine = std::string(nodes) == "affine";
    if (o.affine) o.drilling = 0.003;
    const Model model = std::string(nodes) == "vertices" ? vertex_block(o) : block(o).model;
    const State start = spinning_state(model, {{1, -2, 3.7}}, {{0.3, 0.2, 0}});
    const Momentum first = total_momentum(model, start);
    for (const TimeScheme scheme : kSchemes) {
      for (const double dt : {0.02, 0.01}) {
        ThreadPool pool(1);
        const SolverSettings settings = tight();
        MechanicalSystem system(model, pool, settings);
        State state = start;
        const RunReport report = run_implicit(system, state, kAlways, settings,
                                              {scheme, dt, static_cast<int>(std::lround(1 / dt))}, nullptr);
        EXPECT_EQ(report.status, RunStatus::converged) << report.message;
        system.begin_step(state, 0);
        system.evaluate();
        const Momentum last = total_momentum(model, state);
        const double spin = norm(last.angular - first.angular) / norm(first.angular);
        const double linear = norm(last.linear - first.linear) / norm(first.linear);
        const double energy = (last.kinetic_energy + system.internal_energy().total()) / first.kinetic_energy - 1;
        std::printf("%-14s %-15s %7.3f %12.1e %12.1e %12.1e\n", nodes, name_of(scheme), dt, linear, spin, energy);
        EXPECT_LT(linear, 1e-9) << nodes << name_of(scheme);
        if (scheme == TimeScheme::midpoint) {
          EXPECT_LT(spin, 1e-9) << nodes;
        }
        if (scheme != TimeScheme::implicit_euler) {
          EXPECT_LT(std::abs(energy), 0.02) << nodes << name_of(scheme);
        }
      }
    }
  }
}

/// A boundary that turns so far in a step that it is cut: every scheme ends exactly on the target, near the others.
TEST(TimeScheme, CutStepsEndOnTheirTargets) {
  for (const TimeScheme scheme : kSchemes) {
    Case c = make_case("turned boundary");
    c.model.motions[0].angle = 2.2;
    const FactorFunction ramp = [](double t) { return std::vector<double>{t * t}; };
    const State coarse = run(c.model, c.start, scheme, 1, 3, ramp), fine = run(c.model, c.start, scheme, 1, 48, ramp);
    for (const FrameConstraint& constraint : c.model.constraints) {
      const Vec3d& X = c.model.rest_position[at(constraint.node)];
      EXPECT_LT(norm(coarse.u[at(constraint.node)] - c.model.motions[0].displacement(X, 1)), 1e-12);
      const Mat3d D = rotation_increment({{2.2, 0, 0}});
      EXPECT_LT(norm(coarse.D[at(constraint.node)] - D), 1e-12);
    }
    std::printf("%-15s 3 cut steps against 48: %.1e of %.1e\n", name_of(scheme), distance(coarse, fine, 0.3),
                distance(fine, c.start, 0.3));
    EXPECT_LT(distance(coarse, fine, 0.3), 0.2 * distance(fine, c.start, 0.3)) << name_of(scheme);
  }
}

}  // namespace
}  // namespace fascia::time_scheme_test
