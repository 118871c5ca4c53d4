#pragma once

#include "app/results/results.hpp"
#include "core/base/clock.hpp"
#include "io/result_directory.hpp"

#include <nlohmann/json.hpp>

#include <atomic>
#include <filesystem>
#include <mutex>
#include <string>

namespace fascia::app {

/// The result of a run, in its directory as it arises: states and rows when they are saved, summary.json with the
/// status "running" once a second. A run that dies leaves what it had saved.
class RunResult {
 public:
  /// @throws FileError  of ResultDirectory, or of a file that the scene names
  explicit RunResult(const Simulation& simulation);

  /// Where the result comes from, see provenance_of().
  const nlohmann::ordered_json& provenance() const { return running_.at("provenance"); }

  /// These do what those of ResultFiles do.
  void add_probes(double time, const ProbeValues& values, double time_step);
  void add_state(double time, const State& state);
  std::vector<std::string> add_failed(const Failure& failure);
  const std::vector<double>& last_values(std::size_t probe) const { return files_.last_values(probe); }
  double seconds() const { return files_.seconds(); }
  const std::vector<double>& times() const { return files_.times(); }

  /// Says how far the run is, once a second.
  void note(const StepInfo& step);
  /// The summary of a run that came to its end, with whatever status. @throws FileError
  void finish(const nlohmann::ordered_json& summary);
  /// The summary of one that an error ended: what was saved stays, rows too where no older result comes back. Nothing
  /// else can be done about further errors. After finish() it does nothing.
  void end(RunStatus status, const std::string& why) noexcept;
  /// Ends one that is abandoned, from another thread: the directory is left to itself.
  /// @return whether something that was saved is in it
  bool abandon() noexcept;

  const std::filesystem::path& path() const { return directory_.path(); }
  bool shown() const { return directory_.shown(); }

 private:
  void write(const nlohmann::ordered_json& summary) const;
  void tell_progress();
  void end_unlocked(RunStatus status, const std::string& why) noexcept;

  nlohmann::ordered_json running_;  ///< summary.json as it stands
  io::ResultDirectory directory_;
  ResultFiles files_;
  Clock::time_point started_, written_;
  bool has_rows_ = false, finished_ = false;
  std::atomic<int> steps_{0};  ///< so far
  std::atomic<double> time_{0}, progress_{0};
  std::timed_mutex writing_;  ///< held while files change
};

}  // namespace fascia::app
