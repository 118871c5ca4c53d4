#include "core/solver/explicit_dynamics.hpp"

#include "core/solver/clock.hpp"
#include "core/solver/explicit_step.hpp"

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

std::string explicit_divergence(MechanicalSystem& system, const State& good, int step, double dt) {
  std::ostringstream out;
  out.precision(4);
  out << "step " << step << " (t = " << step * dt << " s): the motion grows beyond what the loads can do; ";
  const double at_rest = stable_time_step(system), stable = stable_time_step(system, good);
  if (at_rest < dt)
    out << "time_step = " << dt << " is above the stable step at rest, " << at_rest << " s; use that or \"auto\"";
  else if (stable < dt)
    out << "the material stiffened: its stable step shrank to about " << stable << " s, below time_step = " << dt
        << "; use a time_step clearly below that";
  else
    out << "try a smaller time_step, damping or smaller loads";
  return out.str();
}

RunReport run_explicit(MechanicalSystem& system, State& state, const FactorFunction& factors,
                       const ExplicitSettings& settings, const StepObserver& observe) {
  const double dt = settings.time_step;
  RunReport run;
  ExplicitStepper stepper(system, state, dt, factors(state.time));
  const double begin = state.time;
  State good = state;
  int good_step = 0;
  Clock::time_point start = Clock::now();
  std::vector<double> next = factors(begin + dt);
  for (int step = 1; step <= settings.steps; ++step) {
    const double time = begin + step * dt;
    stepper.advance(next);
    state.time = time;
    const std::vector<double> present = std::move(next);
    next = factors(time + dt);
    const StepInfo info{step, time, static_cast<double>(step) / settings.steps, {}, seconds_since(start)};
    start = Clock::now();
    bool sound = stepper.is_sound();
    const bool last = step == settings.steps;
    const bool seen = sound && (last || (observe && (!settings.observed || settings.observed(info))));
    if (seen || (sound && step % kExplicitKeepEvery == 0)) {
      stepper.report_velocities(next);
      sound = is_finite(state);
    }
    if (!sound) {
      run.status = RunStatus::diverged;
      run.message = explicit_divergence(system, good, step, dt);
      state = good;
      run.time = state.time;
      run.steps = good_step;
      return run;
    }
    run.steps = step;
    run.time = time;
    if (seen || step % kExplicitKeepEvery == 0) {
      good = state;
      good_step = step;
    }
    if (!seen || !observe) continue;
    system.set_factors(present);
    system.look_at(state, dt);
    system.add_support_inertia([&](int node) { return stepper.held_acceleration(node); });
    if (!observe(info, state, system)) {
      if (!last) run.status = RunStatus::interrupted;
      return run;
    }
    start = Clock::now();  // what the observer took is not the step's
  }
  return run;
}

}  // namespace fascia
