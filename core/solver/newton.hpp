#pragma once

#include "core/solver/settings.hpp"
#include "core/solver/step_budget.hpp"
#include "core/solver/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace fascia {

/// A Newton direction and what the linear solver says of it.
struct DirectionReport {
  bool usable = true;
  double slope = 0;             ///< gradient · direction [J]
  double largest_rotation = 0;  ///< [rad]
  int linear_iterations = 0;
  std::string trouble;         ///< a sentence, where there was any
  bool indefinite = false;     ///< the symmetric part of an unsymmetric tangent is, which says nothing by itself
  bool unsolved = false;       ///< conjugate gradients ended at their limit of iterations
  double linear_residual = 0;  ///< |r| / |b| that conjugate gradients left; 0 of a direct solve
  double cg_seconds = 0;       ///< in conjugate gradients
};

/// stopped: as SolverSettings::stops asked for; out_of_time: the step's budget holds no further iteration; astray: left
/// as SolvedStep::leaves_at asks.
enum class NewtonStatus {
  converged,
  limit,
  stalled,
  unsolved,
  not_finite,
  linear_failure,
  stopped,
  out_of_time,
  astray
};

/// No limit of iterations beside that of the settings.
inline constexpr int kAsManyAsNeeded = std::numeric_limits<int>::max();

/// Why a solve counts as converged: its residual is below the tolerance; or it is what rounding leaves; or it is a
/// small share of the loads and falls no further, and the last correction was small. The correction of a system that
/// conjugate gradients did not solve says nothing: soft directions are found last, and leave next to no residual. Nor
/// does that of loads without a potential, of whose tangent a solver may take the symmetric part alone: such
/// corrections may grow again.
enum class Convergence { none, tolerance, rounding, stagnation };

struct NewtonReport {
  NewtonStatus status = NewtonStatus::converged;
  Convergence convergence = Convergence::none;
  int iterations = 0, linear_iterations = 0;
  Evaluation last;
  std::string trouble;  ///< of the last direction, empty where there was none
  /// A tangent on the way was not positive definite; of loads without a potential its symmetric part, and the way
  /// turned back somewhere.
  bool indefinite = false;
  double linear_residual = 0;  ///< of the last direction
  double last_tangent = 0;     ///< relative residual where the last tangent was taken; infinite where a boundary moved
  double cg_seconds = 0;       ///< of all directions
  bool progress = false;       ///< a better state was found than the first one
  bool led = false;            ///< a boundary motion was carried out
  int indefinite_tangents = 0;

  /// True where a boundary motion led astray: over so many tangents that are not positive definite, or to an end whose
  /// last one is not.
  bool strays(int many) const { return led && (indefinite_tangents >= many || !trouble.empty()); }
};

/// The load or time step that a solve belongs to.
struct SolvedStep {
  int number = 0;   ///< counted from 1
  double time = 0;  ///< its end [s]; in statics the load factor
  /// Leave it where a boundary motion leads over so many tangents that are not positive definite, or to an end whose
  /// last one is not; 0: never.
  int leaves_at = 0;
};

/// Newton's method with a watchdog (Chamberlain et al. 1982): full steps may raise energy and residual for a few
/// iterations, because a slender structure's first step always does (its bending, linear in the rotations, stretches
/// it). Where that leads nowhere, it returns to the best state and searches along the line.
///
/// System: evaluate() → Evaluation; direction(n) → DirectionReport, by n iterations of conjugate gradients at most;
/// largest_step(wanted), what of a step may be taken; apply(step); save() and restore(), one state;
/// has_prescribed_increment(): boundary motion that the next direction still carries; conservative();
/// compares_energies(): of two states on a way of Newton's method the one with less energy is nearer to the solution.
template <class System>
class Newton {
 public:
  /// @param budget  of the step, null: it takes as long as it needs
  Newton(System& system, const SolverSettings& settings, const SolvedStep& step = {}, StepBudget* budget = nullptr)
      : system_(system), settings_(settings), step_(step), budget_(budget) {}

  NewtonReport solve() {
    report_ = {};
    current_ = system_.evaluate();
    if (!current_.finite()) return finish(NewtonStatus::not_finite);
    first_residual_ = current_.residual;
    mark();
    while (system_.has_prescribed_increment() || !settled()) {
      if (report_.iterations >= settings_.max_iterations) return give_up(NewtonStatus::limit);
      if (settings_.stops && settings_.stops()) return finish(NewtonStatus::stopped);
      const bool moving = system_.has_prescribed_increment();  // arrives, whatever time that takes
      report_.led = report_.led || moving;
      if (report_.iterations > 0 && !moving && !holds_iteration()) return give_up(NewtonStatus::out_of_time);
      const DirectionReport d = direction();
      if (step_.leaves_at > 0 && report_.led && report_.indefinite_tangents >= step_.leaves_at)
        return finish(NewtonStatus::astray);
      if (!d.usable) return give_up(NewtonStatus::linear_failure);
      const double before = current_.residual;
      const bool within = current_.within_rounding;
      const double step = system_.largest_step(capped(d));
      system_.apply(step);
      current_ = evaluate();
      if (moving) first_residual_ = std::max(first_residual_, current_.residual);
      if (!moving) count_standing(before);
      if (!moving && !current_.converged() && stagnates(d)) return finish_at_best(Convergence::stagnation);
      if (!moving && within && step == 1 && !current_.converged() && rounding_alone(d)) {
        report_.convergence = Convergence::rounding;
        return finish(NewtonStatus::converged);
      }
      if (!moving && d.unsolved && !settled() && standing_ >= kUnsolvedStands) return give_up(NewtonStatus::unsolved);
      if (current_.finite() && (moving || better_than_mark())) {
        mark();
      } else if (!current_.finite() || (++detour_ > kDetour && current_.residual > kFalls * before) || is_late()) {
        const bool from_mark = since_mark_ == 1;
        const NewtonStatus status = from_mark && !holds_iteration() ? shorten(step, d.slope) : search_from_mark();
        if (status != NewtonStatus::converged) return give_up(status);
      }
    }
    report_.convergence = current_.by_rounding ? Convergence::rounding : Convergence::tolerance;
    return finish(NewtonStatus::converged);
  }

 private:
  static constexpr double kRotationCap = 0.8;    ///< largest rotation of a frame or a cell in one iteration [rad]
  static constexpr double kIndefiniteCap = 0.4;  ///< the same along a direction that no minimum gave
  static constexpr double kShorterLeap = 0.25;   ///< such a step, after one that led to no better state
  static constexpr double kShorter = 0.25;       ///< a step in the place of one that led to no better state
  static constexpr int kDetour = 4, kHalvings = 14;
  static constexpr double kSmallDecrement = 1e-8;  ///< energy that a step would gain, of the energies at play
  static constexpr double kNoDecrement = 1e-12;    ///< the same of a correction of 1e-6 of the motion
  static constexpr double kNoGain = 1e-14;         ///< of the strain energy: an error of 1e-7 in its norm
  static constexpr double kFalls = 0.5;            ///< a residual that falls by less in an iteration stands
  static constexpr int kStands = 2;                ///< iterations in which it does
  static constexpr int kCorrections = 4;           ///< small ones, each to a residual that rounding excuses
  static constexpr int kCircles = 4;               ///< iterations after the least residual that rounding left
  static constexpr int kUnsolvedStands = 5;        ///< the same, where conjugate gradients do not get to their end
  static constexpr double kReduced = kLargestShare;

  double capped(const DirectionReport& d) {
    const bool leaps = !d.trouble.empty();
    const double cap = leaps ? leap_cap_ : kRotationCap;
    const double step = std::min(1.0, cap / std::max(d.largest_rotation, 1e-300));
    if (detour_ == 0) leap_ = leaps ? step * d.largest_rotation : 0;
    return step;
  }

  /// Rounding excuses a residual only where Newton's method has reduced it by a correction that was small itself, or
  /// has tried to and cannot; and only with directions that were solved for. What a linear solver leaves of a large
  /// correction may be as small as rounding and still bend what is soft: the next correction takes it away.
  bool in_equilibrium() const {
    if (!current_.converged()) return false;
    if (!current_.by_rounding) return true;
    const bool reduced = current_.residual <= kReduced * first_residual_ && small_correction_;
    return !unsolved_ && (reduced || standing_ >= kStands || circling_ >= kCircles);
  }

  /// A residual that rounding excuses after conjugate gradients must not have fallen by a half in the last correction,
  /// of a few: smooth ones, as they leave them, sum up in reactions to more than rounding of the same norm does.
  bool settled() const {
    const bool untried = iterates_ && standing_ == 0 && corrections_ < kCorrections;
    return in_equilibrium() && !(current_.by_rounding && untried);
  }

  /// Counts full steps in a row that did not reduce the residual, and those between states of rounding alone that did
  /// not reduce the least residual of these: they may go round in a circle, up and down.
  void count_standing(double before) {
    standing_ = current_.finite() && current_.residual >= kFalls * before ? standing_ + 1 : 0;
    const bool rounding = current_.converged() && current_.by_rounding;
    if (!rounding) least_ = std::numeric_limits<double>::infinity();
    circling_ = rounding && current_.residual >= kFalls * least_ ? circling_ + 1 : 0;
    if (circling_ == 0 && rounding) least_ = current_.residual;
    if (rounding && small_correction_) ++corrections_;
  }

  Evaluation evaluate() {
    if (!budget_) return system_.evaluate();
    const Clock::time_point start = Clock::now();
    const Evaluation e = system_.evaluate();
    budget_->took_evaluation(seconds_since(start));
    return e;
  }
  bool holds_iteration() const { return !budget_ || budget_->holds_iteration(); }
  /// A detour would take what is left of the step's time.
  bool is_late() const { return budget_ && budget_->half_is_over() && !settled(); }

  /// True where the residual is a small share of the loads, the last corrections were small, and it falls no further.
  bool stagnates(const DirectionReport& d) const {
    return !d.unsolved && system_.conservative() && standing_ >= kStands && is_small(d, kSmallDecrement) &&
           marked_.left_of_load <= kLargestShare;
  }

  /// True where rounding leaves much of the loads after a correction, as before it, and nothing of the answer: slender
  /// bodies of solid cells have forces across that are larger than their loads by length over thickness and more, and
  /// stiff enough that what rounding leaves of them moves nothing. Only factors of definite tangents can tell, and a
  /// way over others may lead elsewhere. The measure is the strain energy: work of loads has that of rigid motion too,
  /// which excuses no strain.
  bool rounding_alone(const DirectionReport& d) const {
    return current_.within_rounding && std::abs(d.slope) <= kNoGain * current_.strain_energy &&
           d.linear_residual == 0 && report_.indefinite_tangents == 0 && system_.conservative();
  }

  /// @param part  of the energies at play that the correction would gain
  bool is_small(const DirectionReport& d, double part) const {
    return std::abs(d.slope) <= part * current_.energy_scale;
  }

  DirectionReport direction() {
    if (settings_.iterating)
      settings_.iterating({step_.number, step_.time, report_.iterations + 1, current_.relative, settings_.tolerance});
    report_.last_tangent =
        system_.has_prescribed_increment() ? std::numeric_limits<double>::infinity() : current_.relative;
    if (budget_ && report_.iterations == 0) budget_->took_start(budget_->elapsed());
    const Clock::time_point start = Clock::now();
    ++since_mark_;
    DirectionReport d = system_.direction(budget_ ? budget_->cg_iterations() : kAsManyAsNeeded);
    if (budget_) budget_->took_direction(seconds_since(start), d.cg_seconds, d.linear_iterations);
    ++report_.iterations;
    report_.linear_iterations += d.linear_iterations;
    report_.trouble = d.trouble;
    unsolved_ = d.unsolved;
    iterates_ = d.linear_residual > 0;
    small_correction_ = is_small(d, kNoDecrement);
    report_.indefinite_tangents += !d.trouble.empty();
    report_.indefinite = report_.indefinite || !d.trouble.empty();
    in_doubt_ = in_doubt_ || d.indefinite;
    report_.linear_residual = d.linear_residual;
    report_.cg_seconds += d.cg_seconds;
    return d;
  }

  void mark() {
    if (leap_ > 0) leap_cap_ = std::min(kIndefiniteCap, 2 * leap_cap_);
    leap_ = 0;
    system_.save();
    marked_ = current_;
    detour_ = 0;
    if (since_mark_ > 0) report_.progress = true;
    since_mark_ = 0;
  }

  /// Less energy than at the mark while the residual stays within reach, or a residual that is clearly smaller.
  bool better_than_mark() const {
    if (current_.residual <= 0.5 * marked_.residual) return true;
    return system_.compares_energies() && current_.energy < marked_.energy &&
           current_.residual <= 1e3 * marked_.residual;
  }

  NewtonStatus search_from_mark() {
    if (leap_ > 0) leap_cap_ = kShorterLeap * leap_;
    leap_ = 0;
    turned_back_ = true;
    system_.restore();
    standing_ = 0;
    current_ = evaluate();
    since_mark_ = 0;
    if (report_.iterations >= settings_.max_iterations) return NewtonStatus::limit;
    if (!system_.has_prescribed_increment() && !holds_iteration()) return NewtonStatus::out_of_time;
    const DirectionReport d = direction();
    if (!d.usable) return NewtonStatus::linear_failure;
    const double step = system_.largest_step(std::min(1.0, 0.25 * kRotationCap / std::max(d.largest_rotation, 1e-300)));
    return search(step, d.slope);
  }

  /// Takes a shorter step in the place of the last one, which led from the mark to no better state.
  NewtonStatus shorten(double step, double slope) {
    leap_ = 0;
    turned_back_ = true;
    system_.restore();
    standing_ = 0;
    return search(kShorter * step, slope);
  }

  /// Takes the longest step along the direction at the mark, of those half as long as one another, that leads to a
  /// better state.
  NewtonStatus search(double step, double slope) {
    const bool moving = system_.has_prescribed_increment();  // then the mark's residual is no measure
    bool in_time = true;
    for (int halving = 0; halving < kHalvings && in_time; ++halving, step *= 0.5) {
      system_.apply(step);
      current_ = evaluate();
      if (current_.finite() &&
          (moving || current_.residual <= (1 - 0.1 * step) * marked_.residual ||
           (system_.compares_energies() && current_.energy <= marked_.energy + 1e-4 * step * std::min(slope, 0.0)))) {
        mark();
        return NewtonStatus::converged;
      }
      system_.restore();
      in_time = moving || !budget_ || budget_->holds_evaluation();
    }
    current_ = evaluate();
    last_decrement_ = std::abs(slope);
    return in_time ? NewtonStatus::stalled : NewtonStatus::out_of_time;
  }

  /// Goes back to the best state met, where that is better than the present one.
  void return_to_best() {
    if (current_.finite() && current_.residual <= marked_.residual) return;
    system_.restore();
    current_ = evaluate();
  }

  NewtonReport finish_at_best(Convergence convergence) {
    return_to_best();
    report_.convergence = convergence;
    return finish(NewtonStatus::converged);
  }

  /// Ends a solve that failed, at the best state that it met. Where a boundary has not arrived, no state is an
  /// equilibrium, however well its forces balance.
  NewtonReport give_up(NewtonStatus status) {
    if (system_.has_prescribed_increment()) return finish(status);
    if (in_equilibrium()) return finish_at_best(current_.by_rounding ? Convergence::rounding : Convergence::tolerance);
    if (unsolved_ && (status == NewtonStatus::stalled || status == NewtonStatus::limit))
      status = NewtonStatus::unsolved;
    if (status == NewtonStatus::stalled && marked_.converged()) return finish_at_best(Convergence::rounding);
    const bool small = last_decrement_ <= kSmallDecrement * marked_.energy_scale;
    if (status == NewtonStatus::stalled && small && system_.conservative() && marked_.left_of_load <= kLargestShare)
      return finish_at_best(Convergence::stagnation);
    return_to_best();
    return finish(status);
  }

  NewtonReport finish(NewtonStatus status) {
    const bool strays = step_.leaves_at > 0 && report_.strays(step_.leaves_at);
    report_.status = status == NewtonStatus::converged && strays ? NewtonStatus::astray : status;
    report_.indefinite = report_.indefinite || (in_doubt_ && turned_back_);
    report_.last = current_;
    return report_;
  }

  System& system_;
  const SolverSettings& settings_;
  SolvedStep step_;
  StepBudget* budget_;
  NewtonReport report_;
  Evaluation current_, marked_;
  int detour_ = 0, standing_ = 0;
  int since_mark_ = 0;                ///< directions
  bool unsolved_ = false;             ///< the last direction is what conjugate gradients had at their limit
  bool iterates_ = false;             ///< conjugate gradients found the last direction
  bool in_doubt_ = false;             ///< DirectionReport::indefinite of any direction
  bool turned_back_ = false;          ///< to the best state, to search from there
  bool small_correction_ = false;     ///< the last direction gained next to no energy
  double leap_ = 0;                   ///< rotation of the indefinite step that left the mark; 0 of a definite one
  double leap_cap_ = kIndefiniteCap;  ///< what such a step may be now
  double first_residual_ = 0;
  double least_ = std::numeric_limits<double>::infinity();  ///< residual of states of rounding, in a row
  int circling_ = 0;
  int corrections_ = 0;        ///< small ones that led to a residual that rounding excuses
  double last_decrement_ = 0;  ///< of a search that found nothing better [J]
};

}  // namespace fascia
