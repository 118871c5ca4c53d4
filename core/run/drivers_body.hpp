#pragma once

#include "core/base/clock.hpp"
#include "core/run/drivers.hpp"
#include "core/run/path_following.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

/// The bodies of the drivers, for the files that instantiate them.
namespace fascia {

namespace drivers {

/// Solves of one load step that may fail before the step does, and of a time step as often as it may be halved: where
/// short steps fail and succeed in turn, more of them only take time.
constexpr int kMostFailures = 16, kMostHalvings = 8;
/// Load steps in a row that conjugate gradients do not solve, however short.
constexpr int kMostUnsolved = 8;

inline void count(RunReport& run, const NewtonReport& newton) {
  run.newton_iterations += newton.iterations;
  run.linear_iterations += newton.linear_iterations;
  run.indefinite_solves += newton.indefinite ? 1 : 0;
}

/// A time step during which some tangent was not positive definite: at its length it may have several solutions.
inline void note_indefinite(RunReport& run, int solves_before, double end) {
  if (run.indefinite_solves == solves_before) return;
  if (run.indefinite_steps++ == 0) run.first_indefinite = end;
}

inline bool acceptable(const NewtonReport& newton, const SolverSettings& settings) {
  if (newton.status == NewtonStatus::converged) return true;
  const bool usable = newton.status == NewtonStatus::limit || newton.status == NewtonStatus::stalled ||
                      newton.status == NewtonStatus::unsolved;
  return settings.proceed_on_limit && usable && newton.last.finite();
}

inline void accept(RunReport& run, const NewtonReport& newton, const SolverSettings& settings, double time) {
  ++run.steps;
  run.time = time;
  run.residual = std::max(run.residual, newton.last.relative);
  run.steps_at_limit += newton.status != NewtonStatus::converged;
  run.convergence = convergence_sentence(newton, settings);
  run.residual_floor = std::max(run.residual_floor, newton.last.relative_floor);
}

/// Of a step taken in halves: the worse verdict of both, with the larger residual.
inline NewtonReport worse(const NewtonReport& first, NewtonReport second) {
  if (first.last.excess > second.last.excess) second.last = first.last;
  if (second.status == NewtonStatus::converged) second.status = first.status;
  if (second.convergence < first.convergence) second.convergence = first.convergence;
  return second;
}

/// The last tangent is that of the end too, but for the last correction: not after a step that reached it from afar.
inline bool has_tangent_of_end(const NewtonReport& newton, const Model& model) {
  constexpr double near = 1e-3;
  return newton.iterations > 0 && (newton.last_tangent <= near || model.is_linear());
}

inline RunStatus failure_status(const NewtonReport& newton) {
  return newton.status == NewtonStatus::not_finite ? RunStatus::diverged : RunStatus::not_converged;
}

}  // namespace drivers

template <class System>
RunReport run_statics(System& system, typename System::Pose& state, const FactorFunction& factors,
                      const SolverSettings& settings, const StaticsSettings& statics,
                      const std::type_identity_t<ObserverOf<System>>& observe) {
  using namespace drivers;
  constexpr double kSmallest = 1.0 / 1024;
  RunReport run;
  const double longest = statics.load_steps > 0 ? 1.0 / statics.load_steps : 1.0;
  double reached = 0, increment = longest;
  int failures = 0;       // since the last step that was as long as asked
  int unsolved = 0;       // in a row, by conjugate gradients: shorter steps do not help them
  bool definite = false;  // all tangents of the last step
  state.time = 0;
  while (reached < 1) {
    const Clock::time_point start = Clock::now();
    const double asked = (std::floor(reached / longest + 1e-9) + 1) * longest;  // steps that were cut return to it
    double target = std::min(reached + increment, asked);
    if (target > 1 - 1e-9) target = 1;
    system.begin_step(state, 0);
    system.set_factors(factors(target));
    if (const double turn = system.prescribed_rotation(); turn > kRotationPerStep && target - reached > kSmallest) {
      increment = (target - reached) / std::ceil(turn / kRotationPerStep);
      target = reached + increment;
      system.set_factors(factors(target));
    }
    Newton newton(system, settings, {run.steps + 1, target});
    const NewtonReport report = newton.solve();
    count(run, report);
    if (!acceptable(report, settings)) {
      increment = 0.5 * (target - reached);
      unsolved = report.status == NewtonStatus::unsolved ? unsolved + 1 : 0;
      if (increment >= kSmallest && ++failures < kMostFailures && unsolved < kMostUnsolved) continue;
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
    state = system.finish_step(target);
    accept(run, report, settings, target);
    if (definite && report.indefinite)
      run.events.push_back(passed_sentence(reached, target));
    else if (report.indefinite)
      run.doubts.push_back(detour_sentence(target));
    definite = !report.indefinite;
    reached = target;
    increment = std::min(longest, 2 * increment);
    if (reached >= 1) run.stability = end_stability(system, state, run, has_tangent_of_end(report, system.model()));
    if (observe && !observe({run.steps, reached, reached, report, seconds_since(start)}, state, system)) {
      if (reached < 1) run.status = RunStatus::interrupted;
      return run;
    }
  }
  return run;
}

namespace drivers {

/// A dynamic run, and what its scheme keeps.
template <class System>
struct Stepper {
  System& system;
  const FactorFunction& factors;
  const SolverSettings& settings;
  TimeScheme scheme;
  RunReport& run;
  typename System::Memory memory;
  int failures = 0;  ///< of the present time step

  /// Advances by dt, in halves where Newton fails or a boundary turns too far at once.
  NewtonReport advance(typename System::Pose& state, double end, double dt, int depth) {
    const TimeScheme taken = scheme_of_step(scheme, dt, memory);
    const double solved_at = taken == TimeScheme::midpoint ? end - 0.5 * dt : end;
    if (taken == TimeScheme::newmark && memory.acceleration.empty()) {
      system.set_factors(factors(end - dt));
      system.start_acceleration(state, dt, memory);
    }
    system.begin_step(state, dt, taken, memory);
    system.set_factors(factors(solved_at));
    NewtonReport report;
    if (depth == 0 || system.prescribed_rotation() <= kRotationPerStep) {
      system.start_from_prediction();
      Newton newton(system, settings, {run.steps + 1, end});
      report = newton.solve();
      count(run, report);
      if (acceptable(report, settings)) {
        if (solved_at < end) system.set_factors(factors(end));
        state = system.finish_step(end, memory);
        return report;
      }
      if (depth == 0 || ++failures > kMostHalvings) return report;
    }
    report = advance(state, end - 0.5 * dt, 0.5 * dt, depth - 1);
    if (!acceptable(report, settings)) return report;
    return worse(report, advance(state, end, 0.5 * dt, depth - 1));
  }
};

}  // namespace drivers

template <class System>
RunReport run_implicit(System& system, typename System::Pose& state, const FactorFunction& factors,
                       const SolverSettings& settings, const DynamicsSettings& dynamics,
                       const std::type_identity_t<ObserverOf<System>>& observe) {
  using namespace drivers;
  RunReport run;
  Stepper<System> stepper{system, factors, settings, dynamics.scheme, run, {}, 0};
  typename System::Pose earlier;  // a step before `before`; empty in the first one
  if (observe && dynamics.shows_start) {
    system.set_factors(factors(0));
    system.look_at(state, dynamics.time_step);
    if (!observe({}, state, system)) {
      run.status = RunStatus::interrupted;
      return run;
    }
  }
  for (int step = 1; step <= dynamics.steps; ++step) {
    const Clock::time_point start = Clock::now();
    const double end = dynamics.end_of(step), dt = dynamics.length_of(step);
    typename System::Pose before = state;
    stepper.failures = 0;
    const int solves = run.indefinite_solves;
    const NewtonReport report = stepper.advance(state, end, dt, kMostHalvings);
    note_indefinite(run, solves, end);
    if (!acceptable(report, settings)) {
      keep_failure(run, system);
      state = before;
      std::ostringstream message;
      message << "step " << step << " (t = " << end << " s): " << failure_sentence(report, settings)
              << "; try a smaller time_step, damping, or newton.on_limit = \"continue\"";
      run.message = message.str();
      run.status = failure_status(report);
      run.residual = report.last.finite() ? report.last.relative : 0.0;
      return run;
    }
    accept(run, report, settings, end);
    if (stepper.failures > 0 && run.halved_steps++ == 0) run.first_halved = end;
    const bool equal = step > 1 && std::abs(dt - dynamics.length_of(step - 1)) <= 1e-9 * dt;
    if (observe && system.solves_for_middle())
      system.look_back(state, before, equal ? earlier : typename System::Pose{}, dt);
    earlier = std::move(before);
    const double progress = static_cast<double>(step) / dynamics.steps;
    if (observe && !observe({step, end, progress, report, seconds_since(start)}, state, system)) {
      if (step < dynamics.steps) run.status = RunStatus::interrupted;
      return run;
    }
  }
  return run;
}

}  // namespace fascia
