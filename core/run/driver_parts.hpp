#pragma once

#include "core/run/drivers.hpp"

#include <algorithm>

/// Parts that the drivers share: what a run counts, and when a step is accepted.
namespace fascia::drivers {

/// Solves of one load step that may fail before the step does, and of a time step as often as it may be halved: where
/// short steps fail and succeed in turn, more of them only take time.
constexpr int kMostFailures = 16, kMostHalvings = 8;
/// Load steps in a row that conjugate gradients do not solve, however short.
constexpr int kMostUnsolved = 8;

/// Load steps whose boundary motion leads astray (NewtonReport::strays()). One tangent that is not positive definite is
/// met on the way from a first guess far off, and the end is that of short steps all the same; from kMany on it may be
/// another. What is shortened at once may end straight, unstable or inside out; such steps are left for shorter ones,
/// which lead it into the buckle. Where the shortest ones stray too, or fail, the path itself has no way on there, and
/// the step is taken in one go.
class LedSteps {
 public:
  static constexpr int kMany = 2;  ///< tangents that are not positive definite

  /// @param smallest, from  the shortest step there is and the start, in load factors
  LedSteps(double smallest, double from) : smallest_(smallest), furthest_(from) {}

  /// True where a step is left once it strays. It is not where a boundary turns: what goes with it as a whole is
  /// guessed along the tangent of its circle, and comes to the path by itself. @param turn  of the boundary in this
  /// step [rad]
  bool watches(double from, double to, double turn) const {
    return !ended_ && returns_ < kMostReturns && 0.5 * (to - from) >= smallest_ && turn == 0;
  }
  void left(double target) {
    furthest_ = std::max(furthest_, target);
    ++returns_;
  }
  /// True where a step that failed has a longer one in its place, which was left: the next one.
  bool gives_up(double failed) {
    if (ended_ || furthest_ <= failed) return false;
    return ended_ = true;
  }
  /// Counts an accepted step. @return  whether to take what is left of the longer one in one go
  bool accepted(const NewtonReport& newton) {
    if (ended_ || returns_ == 0 || !newton.strays(kMany) || ++detours_ < kMostDetours) return false;
    return ended_ = true;
  }
  /// Target of the longest step that was left.
  double furthest() const { return furthest_; }

 private:
  static constexpr int kMostReturns = 32;  ///< the shortest steps are come to three times
  static constexpr int kMostDetours = 4;   ///< steps that stray, as short as they may be

  double smallest_, furthest_;
  int returns_ = 0, detours_ = 0;
  bool ended_ = false;
};

inline void count(RunReport& run, const NewtonReport& newton) {
  run.newton_iterations += newton.iterations;
  run.linear_iterations += newton.linear_iterations;
  run.indefinite_solves += newton.indefinite && newton.status != NewtonStatus::astray ? 1 : 0;
}

/// A time step during which some tangent was not positive definite: at its length it may have several solutions.
inline void note_indefinite(RunReport& run, int solves_before, double end) {
  if (run.indefinite_solves == solves_before) return;
  if (run.indefinite_steps++ == 0) run.first_indefinite = end;
}

inline bool acceptable(const NewtonReport& newton, const SolverSettings& settings) {
  if (newton.status == NewtonStatus::converged) return true;
  if (newton.status == NewtonStatus::out_of_time) return newton.last.finite();
  const bool usable = newton.status == NewtonStatus::limit || newton.status == NewtonStatus::stalled ||
                      newton.status == NewtonStatus::unsolved;
  return settings.proceed_on_limit && usable && newton.last.finite();
}

inline void accept(RunReport& run, const NewtonReport& newton, const SolverSettings& settings, double time) {
  ++run.steps;
  run.time = time;
  run.residual = std::max(run.residual, newton.last.relative);
  const bool cut = newton.status == NewtonStatus::out_of_time;
  run.steps_out_of_time += cut;
  if (cut) run.left_by_time = std::max(run.left_by_time, newton.last.relative);
  run.steps_without_progress += cut && !newton.progress;
  run.steps_at_limit += newton.status != NewtonStatus::converged && !cut;
  run.convergence = convergence_sentence(newton, settings);
  run.residual_floor = std::max(run.residual_floor, newton.last.relative_floor);
}

/// Report of a step taken in halves: the worse verdict of both, with the larger residual.
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

/// Ends a run within a step, where it was asked to. @return  whether it was
inline bool ends_within(RunReport& run, const NewtonReport& newton) {
  if (newton.status != NewtonStatus::stopped) return false;
  run.status = RunStatus::interrupted;
  run.message = "stopped before its end, as it was asked to";
  return true;
}

inline RunStatus failure_status(const NewtonReport& newton) {
  return newton.status == NewtonStatus::not_finite ? RunStatus::diverged : RunStatus::not_converged;
}

}  // namespace fascia::drivers
