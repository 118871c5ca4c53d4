#include "app/scene/errors.hpp"
#include "app/simulation.hpp"
#include "core/model/errors.hpp"
#include "core/solver/explicit_dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {

namespace {

constexpr double kMostSteps = 1e9;

/// " (element 12 of body "liver" limits it)" of a single body; nothing otherwise.
std::string limit_of(const Simulation& s) {
  if (s.bodies.size() != 1 || s.bodies[0].body->fastest_cell() == 0) return "";
  return fmt::format("; its element {} limits it", s.bodies[0].body->fastest_cell());
}

}  // namespace

void settle_time_step(Simulation& s, MechanicalSystem& system) {
  Solver& solver = s.scene.solver;
  if (solver.kind != SolverKind::central_differences) return;
  try {
    s.stable_step = stable_time_step(system, s.initial);
  } catch (const InputError& e) {
    throw SceneError({{solver.place, e.what()}});
  }
  if (!solver.time_step_automatic) {
    if (solver.time_step <= s.stable_step * (1 + 1e-9)) return;
    throw SceneError(
        {{solver.time_step_place, fmt::format("{:.4g} s is above the stable step, {:.4g} s{}; use that or \"auto\", "
                                              "a coarser mesh, or an implicit kind",
                                              solver.time_step, s.stable_step, limit_of(s))}});
  }
  const double steps = std::max(1.0, std::ceil(*solver.duration / s.stable_step));
  if (!(steps <= kMostSteps))
    throw SceneError(
        {{solver.time_step_place, fmt::format("the stable time step is {:.4g} s{}: {:.3g} steps, at most {:.0g}; use "
                                              "an implicit kind",
                                              s.stable_step, limit_of(s), steps, kMostSteps)}});
  solver.steps = static_cast<int>(steps);
  solver.time_step = *solver.duration / steps;
}

}  // namespace fascia::app
