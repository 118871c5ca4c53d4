#pragma once

#include "core/run/drivers.hpp"

#include <algorithm>

namespace fascia::app {

/// How the steps of a run kept to the time that the scene gives them.
struct BudgetUse {
  int cut = 0;           ///< steps that ended before they converged
  int idle = 0;          ///< those of them whose iterations led to no better state
  int late = 0;          ///< steps that took longer all the same
  double most_left = 0;  ///< largest residual of those that were cut, relative

  /// @param budget  of each step [s]
  void add(const StepInfo& step, double budget) {
    late += step.seconds > budget ? 1 : 0;
    if (step.newton.status != NewtonStatus::out_of_time) return;
    ++cut;
    idle += step.newton.progress ? 0 : 1;
    most_left = std::max(most_left, step.newton.last.relative);
  }
};

}  // namespace fascia::app
