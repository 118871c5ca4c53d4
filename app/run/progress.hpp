#pragma once

#include "core/base/clock.hpp"
#include "core/run/drivers.hpp"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace fascia::app {

/// Progress on standard error: a bar on a terminal, else a line every few seconds.
class Progress {
 public:
  /// @param statics  times are load factors
  /// @param every  between two lines; none: 5 s, on a terminal 0.1 s [s]
  Progress(bool quiet, bool verbose, bool statics, std::optional<double> every = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// After a step.
  void update(const StepInfo& step);
  /// Within a step, before each Newton iteration: shown where the step, or this iteration, takes long.
  void update(const IterationInfo& iteration);
  /// Nothing is shown from here on.
  void finish();

 private:
  void watch();
  void show_iteration();
  std::string name_of(int step, double time) const;
  void show(const std::string& text);
  void clear();

  bool quiet_, verbose_, statics_, terminal_, drawn_ = false;
  double every_;                                              ///< [s]
  Clock::time_point start_, last_, step_start_, step_shown_;  ///< last_: of a line within a step
  int last_step_ = 0;
  double done_ = 0;                         ///< part of the whole [0, 1]
  std::optional<IterationInfo> iteration_;  ///< that goes on
  bool ended_ = false;
  std::mutex showing_;  ///< held while the above changes, from the first iteration on
  std::condition_variable wake_;
  std::thread watcher_;  ///< shows that a long iteration goes on; there from the first iteration on
};

}  // namespace fascia::app
