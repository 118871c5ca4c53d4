#pragma once

#include "core/base/clock.hpp"
#include "core/run/driver_parts.hpp"
#include "core/run/implicit_stepper.hpp"
#include "core/run/path_following.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

/// The bodies of the drivers, for the files that instantiate them.
namespace fascia {

template <class System>
RunReport run_statics(System& system, typename System::Pose& state, const FactorFunction& factors,
                      const SolverSettings& settings, const StaticsSettings& statics,
                      const std::type_identity_t<ObserverOf<System>>& observe) {
  using namespace drivers;
  const double whole = statics.to - statics.from, smallest = whole / 1024;
  RunReport run;
  const double longest = statics.load_steps > 0 ? whole / statics.load_steps : whole;
  double reached = statics.from, increment = longest;
  int failures = 0;  // since the last step that was as long as asked
  int unsolved = 0;  // in a row, by conjugate gradients: shorter steps do not help them
  LedSteps led(smallest, statics.from);
  bool definite = false;  // all tangents of the last step
  state.time = statics.from;
  while (reached < statics.to) {
    const Clock::time_point start = Clock::now();
    // Steps that were cut return to it.
    const double asked = statics.from + (std::floor((reached - statics.from) / longest + 1e-9) + 1) * longest;
    double target = std::min(reached + increment, asked);
    if (target > statics.to - 1e-9 * whole) target = statics.to;
    system.begin_step(state, 0);
    system.set_factors(factors(target));
    if (const double turn = system.prescribed_rotation(); turn > kRotationPerStep && target - reached > smallest) {
      increment = (target - reached) / std::ceil(turn / kRotationPerStep);
      target = reached + increment;
      system.set_factors(factors(target));
    }
    const bool watched = led.watches(reached, target, system.prescribed_rotation());
    Newton newton(system, settings, {run.steps + 1, target, watched ? LedSteps::kMany : 0});
    const NewtonReport report = newton.solve();
    count(run, report);
    if (ends_within(run, report)) return run;
    if (report.status == NewtonStatus::astray) {
      led.left(target);
      increment = 0.5 * (target - reached);
      continue;
    }
    if (!acceptable(report, settings) && led.gives_up(target)) {
      increment = led.furthest() - reached;
      continue;
    }
    if (!acceptable(report, settings)) {
      increment = 0.5 * (target - reached);
      unsolved = report.status == NewtonStatus::unsolved ? unsolved + 1 : 0;
      if (increment >= smallest && ++failures < kMostFailures && unsolved < kMostUnsolved) continue;
      keep_failure(run, system);
      std::ostringstream message;
      message << "load step " << run.steps + 1 << " (load factor " << target
              << "): " << failure_sentence(report, settings);
      const std::vector<SurfaceLoad>& surfaces = system.model().surfaces;
      const bool enclosed =
          std::any_of(surfaces.begin(), surfaces.end(), [](const SurfaceLoad& s) { return s.bulk_modulus > 0; });
      if (near_limit_point(system, state, factors, reached))
        message << "; the structure reaches a limit point or a bifurcation just there (its tangent stiffness becomes "
                   "singular): use "
                << (enclosed ? "implicit-euler with damping, or a fluid of given pressure with control = \"arc-length\""
                             : "control = \"arc-length\" to follow it");
      else
        message << "; try more load_steps, a stiffer material or smaller loads, or implicit-euler with damping";
      run.message = message.str();
      run.status = failure_status(report);
      run.residual = report.last.finite() ? report.last.relative : 0.0;
      return run;
    }
    if (target == asked) failures = 0;
    unsolved = 0;
    system.finish_step(target, state);
    accept(run, report, settings, target);
    const bool met = report.led ? report.strays(LedSteps::kMany) : report.indefinite;
    if (definite && met)
      run.events.push_back(passed_sentence(reached, target));
    else if (met)
      run.doubts.push_back(detour_sentence(target));
    definite = !met;
    reached = target;
    increment = std::min(longest, 2 * increment);
    if (led.accepted(report)) increment = std::min(longest, std::max(increment, led.furthest() - reached));
    if (reached >= statics.to)
      run.stability = end_stability(system, state, run, has_tangent_of_end(report, system.model()));
    const double progress = (reached - statics.from) / whole;
    if (observe && !observe({run.steps, reached, progress, report, seconds_since(start)}, state, system)) {
      if (reached < statics.to) run.status = RunStatus::interrupted;
      return run;
    }
  }
  return run;
}

template <class System>
RunReport run_implicit(System& system, typename System::Pose& state, const FactorFunction& factors,
                       const SolverSettings& settings, const DynamicsSettings& dynamics,
                       const std::type_identity_t<ObserverOf<System>>& observe) {
  RunReport run;
  if (observe && dynamics.shows_start) {
    system.set_factors(factors(0));
    system.look_at(state, dynamics.time_step);
    if (!observe({}, state, system)) {
      run.status = RunStatus::interrupted;
      return run;
    }
  }
  ImplicitStepper<System> stepper(system, settings, dynamics.scheme);
  if (dynamics.steps > 0) run = stepper.warm_up(state, factors, dynamics.end_of(1), dynamics.length_of(1));
  if (run.status != RunStatus::converged) return run;
  for (int step = 1; step <= dynamics.steps; ++step) {
    const Clock::time_point start = Clock::now();
    const double end = dynamics.end_of(step);
    const NewtonReport report = stepper.step(state, factors, end, dynamics.length_of(step), run);
    if (run.status != RunStatus::converged) return run;
    if (observe) stepper.look_back(state);
    const double progress = static_cast<double>(step) / dynamics.steps;
    if (observe && !observe({step, end, progress, report, seconds_since(start)}, state, system)) {
      if (step < dynamics.steps) run.status = RunStatus::interrupted;
      return run;
    }
  }
  return run;
}

}  // namespace fascia
