// Solves that start far from rest: at random, mirrored, flat, all in one place. They end where a solve from rest ends,
// at another equilibrium, or with a reason; never with a number that is none.
#include "app/extremes/cells.hpp"
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/errors.hpp"
#include "fascia/run/result_warnings.hpp"
#include "tests/support/models.hpp"
#include "tests/support/solve_where.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace fascia::starts_test {
namespace {

using namespace test;

enum class Start { near, far, mirrored, flat, one_place };
constexpr std::array kStarts{"near", "far", "mirrored", "flat", "one place"};

/// What is held, at x = 0, stays where it is.
State start_of(const Simulation& s, Start start, double length) {
  const Model& model = s.model;
  State state = start == Start::near  ? random_state(model, 0.005 * length, 0.1)
                : start == Start::far ? random_state(model, length, 3)
                                      : State::at_rest(model);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const Vec3d& X = model.rest_position[i];
    if (start == Start::mirrored) state.u[i] = {{-2 * X[0], 0, 0}};
    if (start == Start::flat) state.u[i] = {{-X[0], 0, 0}};
    if (start == Start::one_place) state.u[i] = X * -1.0;
  }
  for (const FrameConstraint& c : model.constraints) {
    state.u[at(c.node)] = {};
    state.D[at(c.node)] = {};
  }
  place_dependents(model.points, state);
  return state;
}

bool is_finite(const State& state) {
  return std::all_of(state.u.begin(), state.u.end(), [](const Vec3d& u) { return std::isfinite(norm(u)); });
}

/// As the program ends a run, with fewer iterations before a step is cut.
Solved ended(Simulation& s, const State& from, Where where, double tolerance) {
  s.initial = from;
  SolverSettings settings = settings_of(s.scene.solver);
  settings.tolerance *= tolerance;
  settings.max_iterations = 15;
  Solved run = solve(s, where, settings);
  Warnings warnings;
  add_result_warnings(s, run.state, run.report, warnings);
  return run;
}

/// Elastic, kinetic and of the loads [J].
double energy(const Simulation& s, const State& state) {
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
  system.set_factors(s.factors(0));
  system.look_at(state, s.scene.solver.time_step);
  const InternalEnergy internal = system.internal_energy();
  return internal.elastic + internal.stabilization + system.load_energy() +
         total_momentum(s.model, state).kinetic_energy;
}

class Starts : public testing::TestWithParam<std::size_t> {
 protected:
  /// One run from a start, as a word.
  std::string end_of(Simulation& s, const State& from, Where where, bool dynamic, const State& expected) {
    const Solved run = ended(s, from, where, 1);
    EXPECT_TRUE(is_finite(run.state));
    if (run.report.status != RunStatus::converged) {
      EXPECT_FALSE(run.report.message.empty());
      return "stopped";
    }
    if (dynamic) {
      // Implicit Euler takes energy away, and constant loads have a potential.
      const double before = energy(s, from), after = energy(s, run.state);
      EXPECT_LE(after, before + 1e-9 * std::abs(before));
      return "converged";
    }
    if (displacement_difference(run.state, expected) < 1e-6) return "right";
    // What is no equilibrium does not stay where it is.
    const Solved tighter = ended(s, run.state, Where::processor, 0.01);
    EXPECT_EQ(tighter.report.status, RunStatus::converged) << tighter.report.message;
    EXPECT_LT(displacement_difference(tighter.state, run.state), 1e-5);
    return "another equilibrium";
  }

  void expect_known_ends(const app::Specimen& specimen) {
    Simulation s = build_simulation(app::parse_scene_text(specimen.text(), "beam.toml", {}));
    const State rest = s.initial;
    const Solved from_rest = ended(s, rest, Where::processor, 1);
    ASSERT_EQ(from_rest.report.status, RunStatus::converged) << from_rest.report.message;
    const State& expected = from_rest.state;
    for (std::size_t k = 0; k < kStarts.size(); ++k)
      for (const Where where : {Where::processor, Where::host}) {
        if (where == Where::host && !specimen.cg) continue;
        const std::string name =
            app::row_of(specimen) + ", " + kStarts[k] + (where == Where::host ? ", the GPU's steps" : "");
        SCOPED_TRACE(name);
        const State from = start_of(s, static_cast<Start>(k), specimen.length);
        std::string end;
        try {
          end = end_of(s, from, where, specimen.dynamic, expected);
        } catch (const StateError& e) {
          end = std::string("refused: ") + e.what();
        }
        std::printf("%s: %s\n", name.c_str(), end.c_str());
        if (k == 0) {
          EXPECT_TRUE(end == "right" || end == "converged") << "a start near rest";
        }
      }
  }
};

TEST_P(Starts, EndRightOrWithAReason) {
  app::Specimen specimen;
  specimen.model = static_cast<app::BeamModel>(GetParam());
  for (std::size_t row = 0; row < 4; ++row) {
    if (!full_size() && row != GetParam() % 4) continue;
    specimen.dynamic = row >= 2;
    specimen.cg = row % 2 == 1;
    expect_known_ends(specimen);
  }
}

INSTANTIATE_TEST_SUITE_P(, Starts, testing::Range<std::size_t>(0, app::kModelNames.size()));

}  // namespace
}  // namespace fascia::starts_test
