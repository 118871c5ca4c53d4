#pragma once

#include "app/explain/explanation.hpp"

#include <functional>

namespace fascia::app {

/// A change of a scene that was timed.
struct Turns {
  std::optional<RunRecord> record;  ///< of the change, with the spreads of its times; none: stopped
  Ratio solve, setup;               ///< where it converged
};

/// Runs a scene as it is and with a change, in turns: what the machine does meanwhile meets both, and their ratios
/// are those of neighbours. A change that fails is run once.
/// @param turns  of each  @param stop  as in run_child
/// @throws std::runtime_error  the scene as it is no longer converges
Turns run_in_turns(const ChildRun& as_it_is, const ChildRun& changed, int turns, const std::function<bool()>& stop);

}  // namespace fascia::app
