#pragma once

#include "core/base/clock.hpp"

#include <algorithm>
#include <limits>

namespace fascia {

/// Time that a step of a real-time run may take, and what its parts took so far, by the clock on the wall.
///
/// Newton's method begins another iteration while one is expected to fit, and conjugate gradients get as many
/// iterations as the rest of the step leaves time for. What is expected is the longest of the last times, of which old
/// ones are forgotten slowly: a program that disturbs the run makes it careful for a while.
class StepBudget {
 public:
  /// @param seconds  of a step, above 0
  explicit StepBudget(double seconds) : seconds_(seconds) {}

  /// A step begins now.
  /// @param limited  false: it takes as long as it needs, to learn what its parts take
  void begin(bool limited) {
    start_ = Clock::now();
    limited_ = limited;
  }
  /// Forgets the times of parts.
  void forget() { *this = StepBudget(seconds_); }

  double seconds() const { return seconds_; }
  double elapsed() const { return seconds_since(start_); }

  /// Another iteration of Newton's method ends in time: a direction, the forces after it, and the end of the step.
  bool holds_iteration() const {
    return !limited_ || elapsed() + direction_.expected + kFewIterations * cg_.expected + rest() <= kPart * seconds_;
  }
  /// The forces of another state do.
  bool holds_evaluation() const { return !limited_ || elapsed() + rest() <= kPart * seconds_; }
  /// Iterations of conjugate gradients that a direction which begins now may take, at least one.
  int cg_iterations() const {
    if (!limited_) return std::numeric_limits<int>::max();
    const double one = cg_.expected > 0 ? cg_.expected : std::max(direction_.expected / kOfDirection, 1e-9);
    const double left = kPart * seconds_ - elapsed() - direction_.expected - rest();
    return static_cast<int>(std::clamp(left / one, 1.0, 1e9));
  }
  /// Half of the time of a limited step is over.
  bool half_is_over() const { return limited_ && elapsed() > 0.5 * kPart * seconds_; }

  void took_evaluation(double seconds) { evaluation_.take(seconds); }
  /// @param seconds  of a direction, of which conjugate gradients took a part
  void took_direction(double seconds, double in_iterations, int iterations) {
    direction_.take(std::max(seconds - in_iterations, 0.0));
    if (iterations > 0 && in_iterations > 0) cg_.take(in_iterations / iterations);
  }
  /// Times of a step before its first direction, and behind Newton's method.
  void took_start(double seconds) { opening_.take(seconds); }
  void took_end(double seconds) { ending_.take(seconds); }
  /// A look at the state that was reached, of schemes that need one.
  void took_look(double seconds) { look_.take(seconds); }

  /// The shortest step that was possible so far: one iteration of Newton's method, with one of conjugate gradients [s];
  /// infinite where it is not known.
  double least() const {
    return opening_.least + direction_.least + (cg_.expected > 0 ? cg_.least : 0) + evaluation_.least + ending_.least;
  }

 private:
  /// A part of the time is not planned: a step is to end in it although something takes a little longer.
  static constexpr double kPart = 0.95;
  static constexpr int kFewIterations = 4;  ///< a direction of fewer is hardly worth its linearisation
  static constexpr int kOfDirection = 40;   ///< iterations that a linearisation is worth, where nothing is known

  struct Part {
    double expected = 0, least = std::numeric_limits<double>::infinity();  ///< [s]
    void take(double seconds) {
      constexpr double kForgotten = 0.1;
      expected = std::max(seconds, expected + kForgotten * (seconds - expected));
      least = std::min(least, seconds);
    }
  };
  double rest() const { return evaluation_.expected + ending_.expected + look_.expected; }

  double seconds_;
  Clock::time_point start_ = Clock::now();
  bool limited_ = false;
  Part opening_, evaluation_, direction_, cg_, ending_, look_;
};

}  // namespace fascia
