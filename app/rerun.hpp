#pragma once

#include <filesystem>
#include <optional>

namespace fascia::app {

struct RerunOptions {
  std::filesystem::path directory;
  std::optional<std::filesystem::path> output;  ///< default: DIR.rerun
  double tolerance = 1e-6;                      ///< see compare_results()
  bool quiet = false;
};

/// Runs again what a result says that it came from, into another directory, and compares the two. Says where the
/// program, the machine or a file differs from then.
/// @return of the run where it did not converge as it did then; kDiffers where the results differ; else kDone
/// @throws FileError, InputError  where the directory is no result, or one that does not say where it came from
int rerun_result(const RerunOptions& options);

}  // namespace fascia::app
