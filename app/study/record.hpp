#pragma once

#include "app/study/child_run.hpp"

#include <map>
#include <optional>

namespace fascia::app {

/// Times of equal runs [s].
struct Spread {
  double median = 0, low = 0, high = 0;
};
Spread spread_of(std::vector<double> values);

/// Outcome of a run of a study, as it is kept.
struct RunRecord {                  // NOLINT(bugprone-exception-escape): moving JSON throws nothing
  std::string key, status, reason;  ///< reason: why it is not "converged"
  int exit_status = 0;
  Spread setup, solve, step;      ///< step: medians of the runs
  Spread processor;               ///< processor time of the solve, of all threads
  double step_max = 0, wall = 0;  ///< [s]; wall: of one process from start to end
  double processor_seconds = 0;   ///< of one process from start to end, of all threads
  double memory = 0;              ///< peak [bytes]
  int dofs = 0, steps = 0, newton = 0, linear = 0, threads = 0, repeats = 0;
  double others = 0;  ///< processor time that others took meanwhile, as a share of the machine
  std::string backend;
  nlohmann::ordered_json probes;  ///< of summary.json
  std::vector<std::string> warnings;

  bool converged() const { return status == "converged"; }
};

/// Runs a scene: once where it is not timed, else `warm_up` times and then `repeat` times; a run that takes longer than
/// 20 s needs no warm-up and is repeated once at most, as are runs that fail. @param stop  as in run_child
/// @return none where it was stopped
std::optional<RunRecord> record_run(const ChildRun& run, const std::string& key, bool timed, int warm_up, int repeat,
                                    const std::function<bool()>& stop);

/// The record that a directory holds; none where it holds none of that key.
std::optional<RunRecord> read_record(const std::filesystem::path& directory, const std::string& key);
/// @throws FileError
void write_record(const std::filesystem::path& directory, const RunRecord& record);

nlohmann::ordered_json json_of(const RunRecord& record);

}  // namespace fascia::app
