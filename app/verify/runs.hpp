#pragma once

#include "app/verify/case_value.hpp"
#include "app/verify/directory.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A run that was made again.
struct Repetition {
  int threads = 1;
  bool equal = false;      ///< bit for bit
  std::string difference;  ///< where it is not: the largest, in words
};

/// How one run ended.
struct RunOutcome {
  bool done = false;    ///< false: it was never begun, or an interruption ended it
  std::string status;   ///< "converged", ..., "skipped", "refused", "interrupted"
  std::string message;  ///< why it did not converge
  std::string command;  ///< that repeats it
  double seconds = 0, processor_seconds = 0;
  std::vector<CaseOutcome> cases;  ///< as many as the run has
  std::vector<Repetition> repetitions;
};

struct RunSettings {
  int jobs = 1;                        ///< at once
  std::optional<std::string> backend;  ///< none: as the scene says
  double time_limit = 0;               ///< of each [s]; 0: none
  bool pictures = false;               ///< of the scenes that have one
};

/// Runs each in a process of its own on one thread, judges its cases, and makes again, on one thread and on all, what
/// is to be equal. The tables and summaries stay in the directory, the fields do not.
/// @param done  is told of each run that ended, one at a time
/// @param stop  once it says true, what runs is ended, and nothing is begun
std::vector<RunOutcome> run_cases(const Registry& runs, const RunSettings& settings, const VerifyDirectory& directory,
                                  const std::function<void(std::size_t, const RunOutcome&)>& done,
                                  const std::function<bool()>& stop);

}  // namespace fascia::app
