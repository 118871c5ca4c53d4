#include "assembly/specification/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

constexpr double kMostSteps = 1e9;

/// Collects what is wrong with a solver, and sets what follows from what it says.
class RunCheck {
 public:
  explicit RunCheck(Solver& solver) : s_(solver) {}

  void look() {
    if (s_.kind != SolverKind::statics && s_.control != StaticControl::load)
      wrong("a path past limit points is one of statics; must be control = load");
    if (is_dynamic(s_.kind)) look_at_time();
    if (s_.kind == SolverKind::modes && s_.modes < 1)
      wrong(fmt::format("asks for {} modes; must be at least 1", s_.modes));
    if (s_.kind == SolverKind::statics && s_.control != StaticControl::load) look_at_path();
    if (s_.budget && !is_implicit_dynamics(s_.kind))
      wrong("a budget is for steps of implicit dynamics; leave it out");
    else if (s_.budget && (!(*s_.budget > 0) || !std::isfinite(*s_.budget)))
      wrong(fmt::format("budget = {} s is out of range; must be above 0", *s_.budget));
    const bool newton = s_.kind != SolverKind::modes && s_.kind != SolverKind::central_differences;
    if (!newton && (s_.precision != "double" || s_.gpus > 1))
      wrong("explicit dynamics and modes take one GPU at most, in double precision");
  }
  std::vector<Diagnostic> found;

 private:
  void wrong(const std::string& message) { found.push_back({s_.place, message}); }

  void look_at_time() {
    const double duration = s_.duration.value_or(1);
    if (!(duration > 0) || !std::isfinite(duration))
      return wrong(fmt::format("duration = {} s is out of range; must be above 0", duration));
    if (s_.time_step_automatic) {
      if (s_.kind != SolverKind::central_differences) wrong("time_step_automatic is for explicit dynamics alone");
      if (!s_.duration) wrong("time_step_automatic needs a duration");
      return;
    }
    if (!(s_.time_step > 0) || !std::isfinite(s_.time_step))
      return wrong(fmt::format("time_step = {} s is out of range; must be above 0", s_.time_step));
    if (!s_.duration && s_.steps < 1) return wrong("needs a duration, or a number of steps from 1 on");
    if (!s_.duration) return;
    const double steps = step_count(duration, s_.time_step);
    if (steps > kMostSteps)
      return wrong(
          fmt::format("takes {:.3g} steps of {} s; must take at most {:.0g}", steps, s_.time_step, kMostSteps));
    s_.steps = static_cast<int>(steps);
  }

  void look_at_path() {
    if (s_.max_steps < 1) wrong(fmt::format("max_steps = {} is out of range; must be at least 1", s_.max_steps));
    if (s_.linear == LinearMethod::cg) wrong("a path factorises the stiffness; must be linear = automatic or cholesky");
    if (s_.on_limit == OnLimit::proceed) wrong("steps of a path must converge; must be on_limit = stop");
    if (!s_.full_tangent) wrong("a path needs the geometric stiffness; must be full_tangent = true");
    if (s_.control != StaticControl::displacement) return;
    if (!s_.controlled) return wrong("control = displacement needs a displacement to control: `controlled`");
    const ControlledDisplacement& c = *s_.controlled;
    if (!(squared_norm(c.direction) > 0) || !std::isfinite(squared_norm(c.direction)))
      wrong("the controlled displacement has no direction");
    if (c.to && (*c.to == 0 || !std::isfinite(*c.to))) wrong("the controlled displacement ends at 0 or nowhere");
  }

  Solver& s_;
};

}  // namespace

double step_count(double duration, double time_step) { return std::max(1.0, std::ceil(duration / time_step - 1e-6)); }

void check_run(Scene& scene) {
  RunCheck check(scene.solver);
  check.look();
  if (const std::optional<ControlledDisplacement>& c = scene.solver.controlled;
      c && std::none_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& b) { return b.name == c->body; }))
    check.found.push_back({c->at_place, fmt::format("is on the body \"{}\", which is not there", c->body)});
  if (scene.states_need())
    check.found.push_back({scene.solver.place, "states a need, and leaves its resolution to `fascia run`; choose it"});
  if (scene.output.estimate)
    check.found.push_back({scene.solver.place, "asks for an estimate of errors, which `fascia run` makes alone"});
  if (!check.found.empty()) throw SceneError(check.found);
}

}  // namespace fascia
