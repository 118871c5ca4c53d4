#pragma once

#include "core/solver/settings.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace fascia {

/// A system at a state, in numbers. Residuals are norms with torques divided by a length [N]. Each connected part of
/// the model is judged by itself, so that a stiff or heavy neighbour does not hide what is left in a soft one.
struct Evaluation {
  double energy = 0;          ///< potential that an equilibrium minimises [J]
  double residual = 0;        ///< of all free degrees of freedom
  double excess = 0;          ///< largest of the parts: residual over what is allowed; at most 1 where converged
  double relative = 0;        ///< that part's residual over the largest of its loads, inertia, reactions and rounding
  double relative_floor = 0;  ///< what rounding leaves of it, likewise

  bool finite() const { return std::isfinite(energy) && std::isfinite(residual); }
  bool converged() const { return excess <= 1; }
};

/// A Newton direction and what the linear solver says of it.
struct DirectionReport {
  bool usable = true;
  double slope = 0;             ///< gradient · direction [J]
  double largest_rotation = 0;  ///< [rad]
  int linear_iterations = 0;
  std::string trouble;         ///< a sentence, where there was any
  double linear_residual = 0;  ///< |r| / |b| that conjugate gradients left; 0 of a direct solve
  double cg_seconds = 0;       ///< in conjugate gradients
};

enum class NewtonStatus { converged, limit, stalled, not_finite, linear_failure };

struct NewtonReport {
  NewtonStatus status = NewtonStatus::converged;
  int iterations = 0, linear_iterations = 0;
  Evaluation last;
  std::string trouble;         ///< of the last direction, empty where there was none
  double linear_residual = 0;  ///< of the last direction
  double cg_seconds = 0;       ///< of all directions
};

/// Newton's method with a watchdog (Chamberlain et al. 1982): full steps may raise energy and residual for a few
/// iterations, because a slender structure's first step always does (its bending, linear in the rotations, stretches
/// it). Where that leads nowhere, it returns to the best state and searches along the line.
///
/// System: evaluate() → Evaluation; direction() → DirectionReport; apply(step); save() and restore(), one state;
/// has_prescribed_increment(): boundary motion that the next direction still carries; conservative().
template <class System>
class Newton {
 public:
  Newton(System& system, const SolverSettings& settings) : system_(system), settings_(settings) {}

  NewtonReport solve() {
    report_ = {};
    current_ = system_.evaluate();
    if (!current_.finite()) return finish(NewtonStatus::not_finite);
    mark();
    while (system_.has_prescribed_increment() || !current_.converged()) {
      if (report_.iterations >= settings_.max_iterations) return finish(NewtonStatus::limit);
      const bool moving = system_.has_prescribed_increment();
      const DirectionReport d = direction();
      if (!d.usable) return finish(NewtonStatus::linear_failure);
      system_.apply(std::min(1.0, kRotationCap / std::max(d.largest_rotation, 1e-300)));
      current_ = system_.evaluate();
      if (current_.finite() && (moving || better_than_mark())) {
        mark();
      } else if (!current_.finite() || ++detour_ > kDetour) {
        if (const NewtonStatus status = search_from_mark(); status != NewtonStatus::converged) return finish(status);
      }
    }
    return finish(NewtonStatus::converged);
  }

 private:
  static constexpr double kRotationCap = 0.8;  ///< largest rotation of a frame in one iteration [rad]
  static constexpr int kDetour = 4, kHalvings = 14;

  DirectionReport direction() {
    DirectionReport d = system_.direction();
    ++report_.iterations;
    report_.linear_iterations += d.linear_iterations;
    report_.trouble = d.trouble;
    report_.linear_residual = d.linear_residual;
    report_.cg_seconds += d.cg_seconds;
    return d;
  }

  void mark() {
    system_.save();
    marked_ = current_;
    detour_ = 0;
  }

  /// Less energy than at the mark while the residual stays within reach, or a residual that is clearly smaller.
  bool better_than_mark() const {
    if (current_.residual <= 0.5 * marked_.residual) return true;
    return system_.conservative() && current_.energy < marked_.energy && current_.residual <= 1e3 * marked_.residual;
  }

  NewtonStatus search_from_mark() {
    system_.restore();
    current_ = system_.evaluate();
    if (report_.iterations >= settings_.max_iterations) return NewtonStatus::limit;
    const DirectionReport d = direction();
    if (!d.usable) return NewtonStatus::linear_failure;
    double step = std::min(1.0, 0.25 * kRotationCap / std::max(d.largest_rotation, 1e-300));
    for (int halving = 0; halving < kHalvings; ++halving, step *= 0.5) {
      system_.apply(step);
      current_ = system_.evaluate();
      if (current_.finite() &&
          (current_.residual <= (1 - 0.1 * step) * marked_.residual ||
           (system_.conservative() && current_.energy <= marked_.energy + 1e-4 * step * d.slope))) {
        mark();
        return NewtonStatus::converged;
      }
      system_.restore();
    }
    current_ = system_.evaluate();
    return NewtonStatus::stalled;
  }

  NewtonReport finish(NewtonStatus status) {
    report_.status = status;
    report_.last = current_;
    return report_;
  }

  System& system_;
  const SolverSettings& settings_;
  NewtonReport report_;
  Evaluation current_, marked_;
  int detour_ = 0;
};

}  // namespace fascia
