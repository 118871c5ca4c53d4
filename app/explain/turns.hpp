#pragma once

#include "app/explain/explanation.hpp"

#include <functional>
#include <optional>

namespace fascia::app {

/// A change of a scene that was timed.
struct Timed {
  std::optional<RunRecord> record;  ///< of the change, with the spreads of its times; none: stopped
  Ratio solve, setup;               ///< where it converged
};

/// A run on one thread is measured by its processor time, to which other programs hardly add, where it is longer
/// than the ticks of the system's clock.
bool is_serial(const RunRecord& record);

/// Runs of a scene as it is and with changes, in turns: what the machine does meanwhile meets both, and their ratios
/// are those of neighbours: of processor times where both are of one thread. A change that takes more than five times
/// as long as the scene as it is is ended.
class Turns {
 public:
  /// @param as_it_is, changed  scene, overrides and directories of the runs
  /// @param base  runs of the scene as it is, so far  @param stop  as in run_child
  Turns(ChildRun as_it_is, ChildRun changed, const RunRecord& base, std::function<bool()> stop);

  /// One run with a change, behind one of the scene as it is that at most one other change shares. Its ratio has no
  /// spread of its own. @throws std::runtime_error  the scene as it is no longer converges
  Timed once(const std::vector<std::string>& changes);
  /// Takes as many runs of each, in turns, and twice as many where their ratios spread over more than half of the gain.
  /// A change that fails is run once. @throws std::runtime_error  as once()
  Timed several(const std::vector<std::string>& changes, int turns);

  /// Runs of the scene as it is, and their times [s]; `time`: what ratios of solves are of.
  int count() const { return static_cast<int>(solve_.size()); }
  Spread solve() const { return spread_of(solve_); }
  Spread setup() const { return spread_of(setup_); }
  Spread time() const { return spread_of(is_serial(before_) ? processor_ : solve_); }
  /// Processor time that others took during any run, at most, as a share of the machine.
  double others() const { return others_; }

 private:
  bool run_as_it_is();
  std::optional<RunRecord> run_changed(const std::vector<std::string>& changes);
  std::optional<RunRecord> run_once(const ChildRun& run);

  ChildRun as_it_is_, changed_;
  std::function<bool()> stop_;
  std::vector<double> solve_, setup_, processor_;  ///< of the scene as it is
  RunRecord before_;                               ///< the last of these
  int uses_ = 0;                                   ///< of that
  double others_ = 0;
};

}  // namespace fascia::app
