#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct StudyOptions {
  std::filesystem::path study;        ///< a study file, or a scene where `vary` is given
  std::vector<std::string> vary;      ///< "key=[value, value]"
  std::vector<std::string> measures;  ///< "probe" or "probe.x"
  std::optional<std::filesystem::path> output;
  std::optional<int> repeat, jobs;                ///< jobs: runs at once of what is not timed
  std::optional<std::filesystem::path> svg, png;  ///< directories for the plots
  bool untimed = false, json = false, quiet = false;
};

/// Runs a study and writes study.csv, study.json and study.html. Runs that an earlier call has finished are taken from
/// it where nothing that they depend on has changed.
/// @return kDone; kNotConverged where no run converged; 128 + the signal that ended it
int run_study(const StudyOptions& options);

}  // namespace fascia::app
