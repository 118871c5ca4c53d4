#pragma once

#include "core/solver/clock.hpp"
#include "core/solver/drivers.hpp"

#include <string>

namespace fascia::app {

/// Progress on standard error: a bar on a terminal, else a line every few seconds.
class Progress {
 public:
  Progress(bool quiet, bool verbose);
  void update(const StepInfo& step);
  void finish();

 private:
  bool quiet_, verbose_, terminal_, drawn_ = false;
  Clock::time_point start_, last_;
  int last_step_ = 0;
};

}  // namespace fascia::app
