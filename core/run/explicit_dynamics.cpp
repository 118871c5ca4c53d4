#include "core/run/explicit_dynamics.hpp"

#include "core/base/clock.hpp"
#include "core/run/explicit_step.hpp"

#include <cmath>
#include <sstream>

namespace fascia {

namespace {

bool is_finite(const State& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.u.size(); ++i)
    sum += squared_norm(state.v[i]) + contract(state.Q_dot[i], state.Q_dot[i]);
  return std::isfinite(sum);
}

}  // namespace

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
  ExplicitPlan plan(settings, state.time), kept_plan = plan;
  RunReport run;
  ExplicitStepper stepper(system, state, plan.step(), factors(state.time));
  if (plan.automatic()) stepper.save();
  State good = state;
  int good_step = 0, retries = 0;
  Clock::time_point start = Clock::now();
  std::vector<double> next = factors(plan.end());
  while (!plan.done()) {
    const double dt = plan.step();
    stepper.advance(next);
    plan.take();
    const int step = plan.taken();
    state.time = plan.time();
    const bool last = plan.done();
    const StepInfo info{step, state.time, plan.progress(), {}, seconds_since(start), dt};
    start = Clock::now();
    bool sound = stepper.is_sound() && !plan.collapsed();
    const bool seen = sound && (last || (observe && (!settings.observed || settings.observed(info))));
    const bool looks = plan.asks() || (seen && plan.automatic());
    const double stable = sound && looks ? stepper.stable_step(plan.limit()) : plan.limit();
    const bool overrun = !sound || (looks && plan.overruns(stable));
    if (overrun && plan.automatic() && !plan.collapsed() && retries < kExplicitRetries) {
      stepper.restore();
      plan = kept_plan;
      plan.shorten(sound && stable > 0 ? kStableMargin * stable : 0.5 * plan.limit());
      stepper.set_step(plan.step());
      next = factors(plan.end());
      ++retries;
      continue;
    }
    if (looks) plan.adopt(stable);
    stepper.set_step(plan.step());
    const std::vector<double> present = std::move(next);
    next = factors(plan.end());
    const bool kept = seen || (sound && (plan.automatic() ? looks : step % kExplicitKeepEvery == 0));
    if (kept) {
      stepper.report_velocities(next);
      sound = is_finite(state);
    }
    if (!sound) {
      run.status = RunStatus::diverged;
      run.message = explicit_divergence(system, good, step, state.time, plan);
      run.failed = std::make_shared<FailedState>(FailedState{state, {}, step});
      state = good;
      run.time = state.time;
      run.steps = good_step;
      return run;
    }
    run.steps = step;
    run.time = state.time;
    if (kept) {
      good = state;
      good_step = step;
    }
    if (kept && plan.automatic()) {
      stepper.save();
      kept_plan = plan;
      retries = 0;
    }
    if (!seen || !observe) continue;
    system.set_factors(present);
    system.look_at(state, dt);
    system.add_held_inertia(stepper.held_accelerations());
    if (!observe(info, state, system)) {
      if (!last) run.status = RunStatus::interrupted;
      return run;
    }
    start = Clock::now();  // what the observer took is not the step's
  }
  return run;
}

}  // namespace fascia
