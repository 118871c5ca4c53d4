#include "assembly/actions/actions.hpp"
#include "assembly/simulation/places.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/step_limit.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/solver/mechanical_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

constexpr double kMostSteps = 1e9;

/// "; element 12 at (..) of body "liver" limits it"; nothing where no cell or point does.
std::string limit_of(const Simulation& s, MechanicalSystem& system) {
  const StepLimit limit = step_limit(s, system);
  if (limit.body < 0) return "";
  const SimulatedBody& b = s.bodies[static_cast<std::size_t>(limit.body)];
  return fmt::format("; {} of body \"{}\" limits it", point_name(b, limit.point), b.name);
}

/// With four digits, never more than it is.
std::string rounded_down(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3);
  return fmt::format("{:.4g}", std::floor(value / unit * (1 + 1e-12)) * unit);
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
        {{solver.time_step_place, fmt::format("{:.4g} s is above the stable step, {} s{}; use that or \"auto\", "
                                              "a coarser mesh, or an implicit kind",
                                              solver.time_step, rounded_down(s.stable_step), limit_of(s, system))}});
  }
  const double duration = *solver.duration, every = saving_time(s.scene.output);
  const double part = every > 0 && every < duration ? every : duration;
  const double steps = std::ceil(duration / part - 1e-9) * std::max(1.0, std::ceil(part / s.stable_step));
  if (!(steps <= kMostSteps))
    throw SceneError(
        {{solver.time_step_place, fmt::format("the stable time step is {:.4g} s{}: {:.3g} steps, at most {:.0g}; use "
                                              "an implicit kind",
                                              s.stable_step, limit_of(s, system), steps, kMostSteps)}});
  solver.steps = static_cast<int>(steps);
  solver.time_step = std::min(s.stable_step, part);
}

double saving_time(const Output& output) {
  if (output.every_steps > 0) return 0;
  return output.every > 0 ? output.every : kDefaultEvery;
}

}  // namespace fascia
