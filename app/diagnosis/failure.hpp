#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/run/drivers.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// Where a body stands in a failure.
struct FailureMarks {
  std::vector<double>
      share;  ///< of each node (SimulatedBody::nodes): its part of what is left or moves; 1 in the model
  std::vector<double> volume;  ///< of each integration point: det F, volume now over volume at rest; 0: no number
  std::vector<char> suspect;   ///< of each integration point: 1 where the failure is
};

/// All that is known of a run that failed.
struct Failure {                    // NOLINT(bugprone-exception-escape): moving JSON throws nothing
  State state;                      ///< where it failed; places that were not finite stand as in the last good state
  std::vector<FailureMarks> marks;  ///< of each body
  std::string text;                 ///< "worst at element 12 at (..) of body "b": det F = -0.3 ..", and what to change
  nlohmann::ordered_json summary;   ///< "failure" of summary.json
};

class RunResult;

/// Writes the state in which a run failed, adds the place to its message, and returns "failure" of
/// summary.json. Null where nothing is known (a run on the GPU, one that was interrupted).
/// @param end      the last state of the run
/// @param unshown  it has values that no file can hold
nlohmann::ordered_json keep_failed(const Simulation& simulation, const State& end, bool unshown, RunReport& run,
                                   RunResult& files);

/// Looks for the place of a failure: where matter is turned inside out or has no finite value, else where it is all but
/// crushed, else where most of the residual is left or, of explicit dynamics, most of the kinetic energy.
/// @param good  the last state that is sound
Failure find_failure(const Simulation& simulation, const FailedState& failed, const State& good);

}  // namespace fascia::app
