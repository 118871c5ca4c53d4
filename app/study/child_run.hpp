#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A run of a scene in a process of its own: its time and memory are its own, and so is what it breaks.
struct ChildRun {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< "key.path=value"
  std::filesystem::path output;        ///< directory of its results
  std::optional<int> threads;          ///< 0: all; none: as the scene says
  std::optional<std::string> backend;  ///< none: as the scene says
  double time_limit = 0;               ///< [s], after which it is ended; 0: none
  double processor_limit = 0;          ///< the same of processor time; whole seconds
  double memory_limit = 0;             ///< of what it writes to [bytes]; 0: none
};

/// How it ended.
struct ChildResult {               // NOLINT(bugprone-exception-escape): moving JSON throws nothing
  int exit_status = -1;            ///< of the program; 128 + the number of a signal that ended it
  std::string message;             ///< why it failed, on one line; empty where it did not
  nlohmann::ordered_json summary;  ///< summary.json; null where it wrote none
  double seconds = 0;              ///< from its start to its end
  double processor_seconds = 0;    ///< of all its threads
  bool timed_out = false;

  /// The status of the summary: "converged", ...; "refused" where there is none, "time limit" past that.
  std::string status() const;
};

/// Runs this program on a scene and waits for it.
/// @param stop  asked now and then; once it says true the run is ended
/// @throws std::system_error  no process can be started
ChildResult run_child(const ChildRun& run, const std::function<bool()>& stop = {});

/// Does work(0), work(1), ... count - 1, `parallel` at once, in threads of their own but for one. What one throws is
/// thrown when all have ended; then, and once `stop` says true, nothing more is begun.
void at_once(std::size_t count, int parallel, const std::function<void(std::size_t)>& work,
             const std::function<bool()>& stop);

/// Runs several, `parallel` at once, in their order. @param done  is told each one that ended, one at a time
/// @param stop  once it says true, what runs is ended, and nothing is begun
void run_children(const std::vector<ChildRun>& runs, int parallel,
                  const std::function<void(std::size_t, ChildResult)>& done, const std::function<bool()>& stop = {});

}  // namespace fascia::app
