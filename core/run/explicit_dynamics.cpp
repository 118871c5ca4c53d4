#include "core/run/explicit_dynamics.hpp"

#include "core/run/explicit_run.hpp"
#include "core/run/explicit_step.hpp"

#include <sstream>

namespace fascia {

std::string explicit_divergence(MechanicalSystem& system, const State& good, int step, double time,
                                const ExplicitPlan& plan) {
  std::ostringstream out;
  out.precision(4);
  out << "step " << step << " (t = " << time << " s): ";
  if (plan.collapsed()) {
    out << "the stable step fell to " << plan.limit()
        << " s, as where elements or points are crushed or turn inside out; use smaller loads or motions, a stiffer "
           "material or an implicit kind";
    return out.str();
  }
  out << "the motion grows beyond what the loads can do; ";
  const double dt = plan.limit();
  const double at_rest = stable_time_step(system), stable = stable_time_step(system, good);
  if (at_rest < dt && !plan.automatic())
    out << "time_step = " << dt << " is above the stable step at rest, " << at_rest << " s; use that or \"auto\"";
  else if (stable < dt && plan.automatic())
    out << "the material stiffened within a few steps: its stable step shrank to about " << stable << " s, below the "
        << dt << " s of \"auto\"; use a time_step clearly below that";
  else if (stable < dt)
    out << "the material stiffened: its stable step shrank to about " << stable << " s, below time_step = " << dt
        << "; use \"auto\", which follows it, or a time_step clearly below that";
  else
    out << "try a smaller time_step" << (plan.automatic() ? "" : " or \"auto\"") << ", damping or smaller loads";
  return out.str();
}

RunReport run_explicit(MechanicalSystem& system, State& state, const FactorFunction& factors,
                       const ExplicitSettings& settings, const StepObserver& observe) {
  ExplicitStepper steps(system, state, ExplicitPlan(settings, state.time), factors);
  return run_explicit_steps(
      steps, state, settings, observe != nullptr,
      [&](const StepInfo& info) {
        const State& seen = steps.pose();
        system.set_factors(factors(seen.time));
        system.look_at(seen, info.time_step);
        system.add_held_inertia(steps.held_accelerations());
        return observe(info, seen, system);
      },
      [&](const State& good, int step, double time, const ExplicitPlan& plan) {
        return explicit_divergence(system, good, step, time, plan);
      });
}

}  // namespace fascia
