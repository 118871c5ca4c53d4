#pragma once

#include "core/run/driver_parts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <type_traits>
#include <utility>

namespace fascia {

/// Implicit dynamics, one time step after the other, with what the scheme and the reports keep of the steps before.
///
/// @tparam System  a MechanicalSystem, or one of the same functions on another processor
template <class System>
class ImplicitStepper {
 public:
  using Pose = typename System::Pose;
  using Memory = typename System::Memory;

  /// @param system, settings  stay with the caller
  ImplicitStepper(System& system, const SolverSettings& settings, TimeScheme scheme)
      : system_(system), settings_(settings), scheme_(scheme) {
    if (settings.budget > 0) budget_.emplace(settings.budget);
  }

  /// Advances the state by a time step, in halves where Newton's method fails or a boundary turns too far at once, down
  /// to 1/256, and where a boundary motion leads over tangents that are not positive definite, down to 1/8. Where that
  /// fails too, the state stays as it was, and the run's status, message and failed state say why.
  /// @param end, dt  end and length of the step [s]
  /// @param run      counts the step, and is not touched otherwise
  NewtonReport step(Pose& state, const FactorFunction& factors, double end, double dt, RunReport& run) {
    using namespace drivers;
    if (budget_) budget_->begin(ready_);
    std::swap(earlier_, before_);
    before_ = state;
    failures_ = 0;
    in_parts_ = false;
    watches_ = !budget_;
    strayed_ = false;
    if (watches_ && !system_.model().motions.empty()) {  // else no step is left
      start_.factors = system_.reached_factors();
      start_.pressures = system_.reached_pressures();
    }
    kept_.reset();
    const int solves = run.indefinite_solves;
    NewtonReport report = advanced(state, factors, end, dt, run);
    if (strayed_ && !acceptable(report, settings_) && report.status != NewtonStatus::stopped)
      report = taken_whole(state, factors, end, dt, run);
    if (report.status != NewtonStatus::stopped) note_indefinite(run, solves, end);
    if (!acceptable(report, settings_)) {
      if (!ends_within(run, report)) fail(report, end, run);
      go_back(state);
      return report;
    }
    accept(run, report, settings_, end);
    if (in_parts_ && run.halved_steps++ == 0) run.first_halved = end;
    as_long_as_before_ = last_step_ > 0 && StepConstants::equal(dt, last_step_);
    last_step_ = dt;
    return report;
  }

  /// Takes a step twice and forgets it, where steps have a budget: the first has the memory that it needs and the
  /// solvers that suit it, the second shows what its parts take. Where none of them needs an iteration, or they fail,
  /// one is taken all the same.
  /// @param end, dt  of the first step to come
  /// @return         converged, where a step fits into the budget or nothing is known of it, and where there is none;
  ///                 else how it ended, and why
  RunReport warm_up(const Pose& state, const FactorFunction& factors, double end, double dt) {
    RunReport run;
    if (!budget_) return run;
    const StepMemory memory = on_host(memory_);
    const std::vector<double> pressures = system_.reached_pressures(), reached = system_.reached_factors();
    const auto forget = [&] {
      system_.forget_steps(reached, pressures);
      begin_afresh(Memory(memory));
    };
    ready_ = false;
    for (int twice = 0; twice < 2 && run.status == RunStatus::converged; ++twice) {
      budget_->forget();
      Pose tried = state;
      run = {};
      step(tried, factors, end, dt, run);
      forget();
    }
    if (run.status == RunStatus::interrupted) return run;
    run = {};
    measure(state, factors, end, dt);
    forget();
    ready_ = true;
    if (!(budget_->least() > budget_->seconds()) || !std::isfinite(budget_->least())) return run;
    run.status = RunStatus::not_converged;
    run.message = too_short_sentence(*budget_);
    return run;
  }

  /// Has the system look at the state that the last step reached, where that step's equations hold elsewhere.
  void look_back(const Pose& state) {
    if (!system_.solves_for_middle()) return;
    const Clock::time_point start = Clock::now();
    system_.look_back(state, before_, as_long_as_before_ ? earlier_ : Pose{}, last_step_);
    if (budget_) budget_->took_look(seconds_since(start));
  }

  /// Numbers of the steps before that the scheme keeps.
  const Memory& memory() const { return memory_; }
  /// Goes on from another state than the one that it reached.
  void begin_afresh(Memory memory = {}) {
    memory_ = std::move(memory);
    last_step_ = 0;
  }

 private:
  /// So long a step may have several solutions, and halves fewer. Not for ever: where each step asks for halves, what
  /// is led turns, or nothing holds it, and comes to its place all the same.
  static constexpr int kWatchedHalvings = 3, kMostReturns = 100;

  /// Where a step that was left for halves fails in one of them, it may succeed in one go, wherever that leads.
  NewtonReport taken_whole(Pose& state, const FactorFunction& factors, double end, double dt, RunReport& run) {
    state = before_;
    if (kept_) memory_ = Memory(StepMemory(*kept_));
    system_.forget_steps(start_.factors, start_.pressures);
    failures_ = 0;
    in_parts_ = watches_ = false;
    return advanced(state, factors, end, dt, run);
  }

  /// Leaves the state as it was where a step throws, too; the scheme starts anew then, for it may have been amid what
  /// it keeps.
  NewtonReport advanced(Pose& state, const FactorFunction& factors, double end, double dt, RunReport& run) {
    try {
      return advance(state, factors, end, dt, drivers::kMostHalvings, run);
    } catch (...) {
      go_back(state);
      begin_afresh();
      throw;
    }
  }

  static StepMemory on_host(const Memory& memory) {
    if constexpr (std::is_same_v<Memory, StepMemory>)
      return memory;
    else
      return memory.downloaded();
  }

  /// Forgets the step: what follows is as though it had not been tried.
  void go_back(Pose& state) {
    state = before_;
    if (kept_) memory_ = Memory(std::move(*kept_));
    std::swap(earlier_, before_);
  }

  /// Begins a step. @return  when its equations hold
  double begin(const Pose& state, const FactorFunction& factors, double end, double dt) {
    const TimeScheme taken = scheme_of_step(scheme_, dt, memory_);
    const double solved_at = taken == TimeScheme::midpoint ? end - 0.5 * dt : end;
    if (taken == TimeScheme::newmark && memory_.acceleration.empty()) {
      system_.set_factors(factors(end - dt));
      system_.start_acceleration(state, dt, memory_);
    }
    system_.begin_step(state, dt, taken, memory_);
    system_.set_factors(taken == TimeScheme::midpoint ? middle_factors(factors, end, dt) : factors(solved_at));
    return solved_at;
  }

  /// True where a boundary moves in the step without a turn.
  bool leads() const {
    const std::vector<PrescribedMotion>& motions = system_.model().motions;
    return std::any_of(motions.begin(), motions.end(), [&](const PrescribedMotion& m) {
      return m.angle == 0 && !m.driven &&
             system_.factors()[at(m.schedule)] != system_.reached_factors()[at(m.schedule)];
    });
  }

  /// Factors in the middle of a midpoint step: of loads those of its time, of motions half way from where they are to
  /// where the step takes them. The rule has the middle of everything there: a boundary at the place of its time would
  /// stand off from what it leads by a dt²/8.
  std::vector<double> middle_factors(const FactorFunction& factors, double end, double dt) const {
    std::vector<double> middle = factors(end - 0.5 * dt);
    const std::vector<double> ends = factors(end);
    for (const PrescribedMotion& m : system_.model().motions) {
      const std::size_t k = at(m.schedule);
      middle[k] = 0.5 * (system_.reached_factors()[k] + ends[k]);
    }
    return middle;
  }

  /// Takes the parts of a step with one iteration, which leads nowhere.
  void measure(const Pose& state, const FactorFunction& factors, double end, double dt) {
    budget_->begin(false);
    begin(state, factors, end, dt);
    system_.evaluate();
    budget_->took_start(budget_->elapsed());
    const auto timed = [](const auto& act) {
      const Clock::time_point start = Clock::now();
      act();
      return seconds_since(start);
    };
    DirectionReport d;
    const double in_direction = timed([&] { d = system_.direction(kAsManyAsNeeded); });
    budget_->took_direction(in_direction, d.cg_seconds, d.linear_iterations);
    budget_->took_evaluation(timed([&] { system_.evaluate(); }));
    Pose reached = state;
    budget_->took_end(timed([&] { system_.finish_step(end, memory_, reached); }));
  }

  NewtonReport advance(Pose& state, const FactorFunction& factors, double end, double dt, int depth, RunReport& run) {
    using namespace drivers;
    const double solved_at = begin(state, factors, end, dt);
    NewtonReport report;
    if (depth == 0 || system_.prescribed_rotation() <= kRotationPerStep) {
      // The velocities lead what is free towards a boundary that has not moved yet, and press it flat. The first
      // direction carries both, but for what turns, which it carries along a tangent.
      if (!leads()) system_.start_from_prediction();
      const bool watched = watches_ && depth > kMostHalvings - kWatchedHalvings && returns_ < kMostReturns;
      Newton newton(system_, settings_, {run.steps + 1, end, watched ? 1 : 0}, budget_ ? &*budget_ : nullptr);
      report = newton.solve();
      count(run, report);
      const Clock::time_point solved = Clock::now();
      if (acceptable(report, settings_)) {
        if (solved_at < end) system_.set_factors(factors(end));
        if (depth < kMostHalvings && !kept_) kept_ = on_host(memory_);  // the whole step may fail yet
        system_.finish_step(end, memory_, state);
        if (budget_) budget_->took_end(seconds_since(solved));
        return report;
      }
      if (report.status == NewtonStatus::astray) {
        // A motion that is applied at once is all in the first half.
        watches_ = factors(end - 0.5 * dt) != factors(end);
        if (!watches_) return advance(state, factors, end, dt, depth, run);
        strayed_ = true;
        ++returns_;
      } else if (depth == 0 || report.status == NewtonStatus::stopped || ++failures_ > kMostHalvings)
        return report;
      in_parts_ = true;
    }
    report = advance(state, factors, end - 0.5 * dt, 0.5 * dt, depth - 1, run);
    if (!acceptable(report, settings_)) return report;
    return worse(report, advance(state, factors, end, 0.5 * dt, depth - 1, run));
  }

  void fail(const NewtonReport& report, double end, RunReport& run) {
    keep_failure(run, system_);
    std::ostringstream message;
    message << "step " << run.steps + 1 << " (t = " << end << " s): " << failure_sentence(report, settings_)
            << "; try a smaller time_step, damping, or newton.on_limit = \"continue\"";
    run.message = message.str();
    run.status = drivers::failure_status(report);
    run.residual = report.last.finite() ? report.last.relative : 0.0;
  }

  System& system_;
  const SolverSettings& settings_;
  TimeScheme scheme_;
  std::optional<StepBudget> budget_;
  bool ready_ = false;  ///< the budget knows what the parts of a step take
  Memory memory_;
  std::optional<StepMemory> kept_;  ///< as it was before a step of which a part was taken
  Pose before_, earlier_;           ///< at the starts of the last two steps
  double last_step_ = 0;            ///< [s]; 0: none
  bool as_long_as_before_ = false;  ///< both were of one length
  int failures_ = 0;                ///< of the present time step
  bool in_parts_ = false;           ///< it is taken so because Newton's method asked for that
  bool watches_ = true;             ///< whether it is left for halves where its motion leads astray
  int returns_ = 0;                 ///< to halves, from motions that led astray
  struct Reached {
    std::vector<double> factors, pressures;
  };
  Reached start_;         ///< what the system had reached before the step
  bool strayed_ = false;  ///< the step was left for halves
};

}  // namespace fascia
