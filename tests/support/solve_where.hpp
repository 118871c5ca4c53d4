#pragma once

#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/run/drivers.hpp"
#include "gpu/run/run.hpp"
#include "tests/support/cases.hpp"

#include <algorithm>

/// Scenes solved on the processor, or by what runs on a GPU, in the space of the host or on the device.
namespace fascia::test {

enum class Where { processor, host, device };

struct Solved {
  State state;
  RunReport report;
};

/// Statics, or five steps of implicit dynamics at most, twenty in full size.
inline Solved solve(const Simulation& s, Where where, const SolverSettings& settings) {
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  const auto& solver = s.scene.solver;
  Solved out{s.initial, {}};
  const bool host = where == Where::host, statics = solver.kind == SolverKind::statics;
  const StaticsSettings loading{solver.load_steps};
  DynamicsSettings dynamics{TimeScheme::implicit_euler, solver.time_step, std::min(solver.steps, full_size() ? 20 : 5)};
  if (!statics) dynamics.scheme = scheme_of(solver.kind);
  if (where == Where::processor) {
    ThreadPool pool(1);
    MechanicalSystem system(s.model, pool, settings);
    out.report = statics ? run_statics(system, out.state, factors, settings, loading, {})
                         : run_implicit(system, out.state, factors, settings, dynamics, {});
  } else if (statics) {
    const auto run = host ? gpu::run_statics_on_host : gpu::run_statics;
    out.report = run(s.model, out.state, factors, settings, loading, {});
  } else {
    const auto run = host ? gpu::run_implicit_on_host : gpu::run_implicit;
    out.report = run(s.model, out.state, factors, settings, dynamics, {});
  }
  return out;
}

/// Largest difference of displacements over the largest displacement.
inline double displacement_difference(const State& a, const State& b) {
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    largest = std::max(largest, norm(b.u[i]));
    error = std::max(error, norm(a.u[i] - b.u[i]));
  }
  return error / std::max(largest, 1e-300);
}

}  // namespace fascia::test
