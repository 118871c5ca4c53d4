#include "app/estimate/resolution.hpp"

#include <fmt/format.h>

#include <algorithm>

/// Twins that are computed in other steps, or more exactly.
namespace fascia::app {

SceneTwin with_time_step(const Scene& scene, double factor, std::optional<double> step) {
  const Solver& solver = scene.solver;
  SceneTwin twin;
  const auto keep = [&](const char* why) {
    twin.kept.push_back(fmt::format("the time step stays: {}", why));
    return twin;
  };
  if (!is_dynamic(solver.kind)) return keep("there is none without dynamics");
  if (solver.time_step_automatic && !step) return keep("the run finds it");
  if (solver.kind == SolverKind::central_differences && factor > 1) return keep("a longer one may be unstable");
  const double before = step.value_or(solver.time_step), after = before * factor;
  twin.overrides.push_back(fmt::format("solver.time_step={}", after));
  if (!solver.duration) {
    twin.overrides.emplace_back("solver.steps=");
    twin.overrides.push_back(fmt::format("solver.duration={}", solver.steps * solver.time_step));
  }
  if (scene.output.every_steps > 0) {
    twin.overrides.emplace_back("output.every_steps=");
    twin.overrides.push_back(fmt::format("output.every={}", scene.output.every_steps * before));
  }
  twin.changes.push_back(fmt::format("the time step is {:.4g} s in the place of {:.4g} s", after, before));
  return twin;
}

SceneTwin solved_exactly(const Scene& scene) {
  constexpr double exact = 1e-10;
  const Solver& solver = scene.solver;
  SceneTwin twin;
  if (solver.kind == SolverKind::central_differences || solver.kind == SolverKind::modes) {
    twin.kept.emplace_back("the tolerance stays: this kind of solver has none");
    return twin;
  }
  twin.overrides = {
      fmt::format("solver.newton.tolerance={}", std::min(exact, solver.newton_tolerance)),
      fmt::format("solver.newton.max_iterations={}", std::max(200, solver.newton_max_iterations)),
      fmt::format("solver.linear.tolerance={}", std::min(exact, solver.linear_tolerance)),
      fmt::format("solver.linear.max_iterations={}", std::max(20000, solver.linear_max_iterations)),
  };
  twin.changes.push_back(
      fmt::format("Newton's tolerance is {:g} in the place of {:g}, that of conjugate gradients {:g} "
                  "in the place of {:g}",
                  std::min(exact, solver.newton_tolerance), solver.newton_tolerance,
                  std::min(exact, solver.linear_tolerance), solver.linear_tolerance));
  if (solver.on_limit == OnLimit::proceed) twin.overrides.emplace_back("solver.newton.on_limit=\"stop\"");
  if (solver.budget) twin.overrides.emplace_back("solver.budget=\"none\"");
  if (solver.on_limit == OnLimit::proceed || solver.budget)
    twin.changes.emplace_back("every step is solved to the end");
  return twin;
}

SceneTwin in_double(const Scene& scene) {
  SceneTwin twin;
  if (scene.solver.precision == "double") {
    twin.kept.emplace_back("the precision stays: it is double");
    return twin;
  }
  twin.overrides.emplace_back("solver.precision=\"double\"");
  twin.changes.push_back(fmt::format("the precision is double in the place of {}", scene.solver.precision));
  return twin;
}

}  // namespace fascia::app
