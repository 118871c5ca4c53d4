#include "app/diagnosis/condition.hpp"

#include "assembly/simulation/solver_settings.hpp"
#include "core/solver/mechanical_system.hpp"

#include <fmt/format.h>

namespace fascia::app {

namespace {

constexpr double kMostFlops = 1e9;  ///< with the solves beside it below half a second
constexpr double kFewDigits = 6;

/// Stands the system where the first solve begins.
void begin_first_step(const Simulation& s, MechanicalSystem& system) {
  const Solver& solver = s.scene.solver;
  const double dt = solver.kind == SolverKind::statics ? 0 : solver.time_step;
  StepMemory memory;
  TimeScheme scheme = TimeScheme::implicit_euler;
  system.set_factors(s.factors(0));
  if (dt > 0) scheme = scheme_of_step(dynamics_of(solver).scheme, dt, memory);
  if (scheme == TimeScheme::newmark) system.start_acceleration(s.initial, dt, memory);
  system.begin_step(s.initial, dt, scheme, memory);
  system.set_factors(s.factors(0));
  system.evaluate();
}

}  // namespace

std::string condition_line(const Simulation& s) {
  const Solver& solver = s.scene.solver;
  if (solver.kind == SolverKind::modes || solver.kind == SolverKind::central_differences) return "";
  if (s.model.free_dof_count() == 0) return "";
  const SolverSettings settings = settings_of(solver);
  ThreadPool pool(solver.threads);
  MechanicalSystem system(s.model, pool, settings);
  begin_first_step(s, system);
  const TangentCondition c = system.condition(kMostFlops);
  if (c.kind == TangentCondition::Kind::left_out)
    return fmt::format("tangent at rest: {} unknowns, too many to estimate its condition here",
                       s.model.free_dof_count());
  if (c.kind == TangentCondition::Kind::not_definite)
    return "tangent at rest: not positive definite: some motion is unstable or is not resisted, as where integration "
           "points are too few or a part hangs on a point; what a run finds there may be arbitrary";
  std::string line = fmt::format(
      "tangent at rest: condition {:.2g} (scaled by its diagonal blocks); conjugate gradients take {} {} "
      "iterations{}, a direct solve keeps about {:.0f} digits",
      c.ratio(), c.cg_converged ? "about" : "more than", c.cg_iterations, c.with_levels ? " with levels" : "",
      c.digits());
  if (c.digits() < kFewDigits)
    line +=
        "; so few come from parts that are much softer, thinner or smaller than what they hang on, or from "
        "supports that hardly hold";
  return line;
}

}  // namespace fascia::app
