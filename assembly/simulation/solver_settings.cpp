#include "assembly/simulation/solver_settings.hpp"

#include "assembly/simulation/simulation.hpp"

namespace fascia {

SolverSettings settings_of(const Solver& solver) {
  SolverSettings s;
  s.max_iterations = solver.newton_max_iterations;
  s.tolerance = solver.newton_tolerance;
  s.proceed_on_limit = solver.on_limit == OnLimit::proceed;
  s.budget = solver.budget.value_or(0);
  s.linear = solver.linear;
  s.preconditioner = solver.preconditioner;
  s.cg.max_iterations = solver.linear_max_iterations;
  s.cg.tolerance = solver.linear_tolerance;
  s.threads = solver.threads;
  if (solver.precision == "mixed") s.precision = Precision::mixed;
  if (solver.precision == "single") s.precision = Precision::single;
  s.tangent = solver.full_tangent ? Tangent::full : Tangent::material;
  return s;
}

DynamicsSettings dynamics_of(const Solver& solver) {
  return {scheme_of(solver.kind), solver.time_step, solver.steps, solver.duration.value_or(0), true};
}

ExplicitSettings explicit_of(const Scene& scene, const std::function<bool(const StepInfo&)>& observed) {
  const Solver& solver = scene.solver;
  const double every = saving_time(scene.output);
  return {solver.time_step, solver.steps, observed, solver.duration.value_or(0), solver.time_step_automatic, every};
}

TimeScheme scheme_of(SolverKind kind) {
  switch (kind) {
    case SolverKind::bdf2:
      return TimeScheme::bdf2;
    case SolverKind::newmark:
      return TimeScheme::newmark;
    case SolverKind::midpoint:
      return TimeScheme::midpoint;
    default:
      return TimeScheme::implicit_euler;
  }
}

}  // namespace fascia
