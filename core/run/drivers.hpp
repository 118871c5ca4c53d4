#pragma once

#include "core/run/run_status.hpp"
#include "core/solver/mechanical_system.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace fascia {

/// Figures that a driver tells after each accepted step.
struct StepInfo {
  int step = 0;         ///< counted from 1; 0: the start
  double time = 0;      ///< [s]; in statics the load factor
  double progress = 0;  ///< part of the whole [0, 1]
  NewtonReport newton;
  double seconds = 0;    ///< of this step
  double time_step = 0;  ///< explicit: its length [s]
};

/// Called with the state and the system (whose gradient belongs to it); returns false to stop (Ctrl-C).
template <class System>
using ObserverOf = std::function<bool(const StepInfo&, const typename System::Pose&, System&)>;
using StepObserver = ObserverOf<MechanicalSystem>;
/// Factors of all schedules at a time [s] (statics: at a load factor).
using FactorFunction = std::function<std::vector<double>(double)>;

/// Where a run failed: not an equilibrium, and perhaps with numbers that are not finite.
struct FailedState {
  State state;
  std::vector<double> gradient;  ///< residual there, by degrees of freedom in world axes; empty of explicit dynamics
  int step = 0;                  ///< that failed, counted from 1
};

struct RunReport {
  RunStatus status = RunStatus::converged;
  int steps = 0, newton_iterations = 0, linear_iterations = 0;
  double residual = 0, residual_floor = 0;  ///< largest of the steps, relative
  double time = 0;
  int steps_at_limit = 0;                     ///< accepted above the tolerance (proceed_on_limit)
  int steps_out_of_time = 0;                  ///< accepted above the tolerance where their budget ended
  int steps_without_progress = 0;             ///< those of them whose iterations led to no better state
  double left_by_time = 0;                    ///< largest residual of those, relative
  std::string trouble;                        ///< of a followed path: its end may be unstable
  std::string convergence;                    ///< why the last step counts as converged, in words
  Stability stability;                        ///< of the end of statics under load control
  int indefinite_solves = 0;                  ///< in which a tangent was not positive definite
  int indefinite_steps = 0;                   ///< time steps with such solves
  double first_indefinite = 0;                ///< end of the first of them [s]
  int halved_steps = 0;                       ///< time steps taken in parts, as Newton's method failed or strayed
  double first_halved = 0;                    ///< end of the first of them [s]
  std::vector<std::string> events;            ///< limit points and bifurcations that were passed, a sentence each
  std::vector<std::string> doubts;            ///< why another run may find another solution, a sentence each
  std::string message;                        ///< one sentence on what went wrong, where, and what to try
  std::shared_ptr<const FailedState> failed;  ///< of a run that ended in a failure
};

/// Keeps where a system stands after a solve that failed.
template <class System>
void keep_failure(RunReport& run, const System& system) {
  const auto gradient = system.gradient();
  run.failed =
      std::make_shared<FailedState>(FailedState{system.state(), {gradient.begin(), gradient.end()}, run.steps + 1});
}

/// Which criterion ended a step, with its figures; empty where none did.
std::string convergence_sentence(const NewtonReport& newton, const SolverSettings& settings);
/// That a load step led past a place where the path of equilibria turns or branches.
std::string passed_sentence(double from, double to);
/// That Newton's method left the states that a load step passes through; told in RunReport::doubts alone.
std::string detour_sentence(double to);
/// That a budget holds no iteration of Newton's method.
std::string too_short_sentence(const StepBudget& budget);
/// Why a step did not converge.
std::string failure_sentence(const NewtonReport& newton, const SolverSettings& settings);
/// Stability of the equilibrium at the end of statics, which the system stands at.
inline Stability end_stability(MechanicalSystem& system, const State& end, const RunReport& run, bool current) {
  return system.stability(end, run.linear_iterations, current);
}
/// Boundary rotations are spread over steps of at most this angle: their linear prediction still holds there [rad].
inline constexpr double kRotationPerStep = 0.35;

struct StaticsSettings {
  int load_steps = 0;       ///< 0: as few as converge
  double from = 0, to = 1;  ///< load factors; the state is an equilibrium of the first
};

/// Equilibrium under loads and boundary motions that grow with the load factor, from 0 to 1 where nothing else is said.
/// A load step that does not converge is cut in half, down to 1/1024, and so is one whose boundary motion leads over
/// tangents that are not positive definite; shorter steps end on the multiples of 1/load_steps too.
///
/// A system is a MechanicalSystem, or one of the same functions on another processor, with its own kind of state.
template <class System>
RunReport run_statics(System& system, typename System::Pose& state, const FactorFunction& factors,
                      const SolverSettings& settings, const StaticsSettings& statics,
                      const std::type_identity_t<ObserverOf<System>>& observe);

struct DynamicsSettings {
  TimeScheme scheme = TimeScheme::implicit_euler;
  double time_step = 0;  ///< [s]
  int steps = 0;
  double duration = 0;       ///< the last step is cut, so that it ends there [s]; 0: it is as long as the others
  bool shows_start = false;  ///< the observer sees the state at t = 0 too, as step 0

  /// A step counted from 1: its end and its length [s].
  double end_of(int step) const { return ends_at_duration(step) ? duration : step * time_step; }
  double length_of(int step) const {
    const bool cut = ends_at_duration(step) && std::abs(step * time_step - duration) > kWhole * time_step;
    return cut ? duration - (step - 1) * time_step : time_step;
  }

 private:
  static constexpr double kWhole = 1e-9;  ///< a last step that lacks less is a whole one
  bool ends_at_duration(int step) const { return duration > 0 && step == steps; }
};

/// Dynamics by an implicit scheme. A time step that does not converge is taken in halves, down to 1/256, one whose
/// boundary motion leads over tangents that are not positive definite down to 1/8; one whose budget ends is taken as
/// far as it got. A run whose budget holds no iteration ends before its first step.
///
/// The observer sees the state at the end of each step. The system's gradient belongs to the step's equations there,
/// with inertia; after a midpoint step it is what look_back() says, at the start what look_at() does.
template <class System>
RunReport run_implicit(System& system, typename System::Pose& state, const FactorFunction& factors,
                       const SolverSettings& settings, const DynamicsSettings& dynamics,
                       const std::type_identity_t<ObserverOf<System>>& observe);

extern template RunReport run_statics(MechanicalSystem&, State&, const FactorFunction&, const SolverSettings&,
                                      const StaticsSettings&, const StepObserver&);
extern template RunReport run_implicit(MechanicalSystem&, State&, const FactorFunction&, const SolverSettings&,
                                       const DynamicsSettings&, const StepObserver&);

}  // namespace fascia
