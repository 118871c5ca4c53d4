#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct VerifyOptions {
  std::vector<std::string> names;  ///< of runs, cases, topics and features, or globs; none: all
  std::filesystem::path output = "results/verify";
  std::optional<std::filesystem::path> cases;       ///< a folder of case files; otherwise those of the program
  std::optional<std::filesystem::path> validation;  ///< docs/validation.md is written there
  std::optional<std::string> backend;
  int jobs = 0;              ///< runs at once; 0: as many as there are processors
  double time_limit = 3600;  ///< of each run [s]
  bool full = false, list = false, json = false, quiet = false, pictures = false;
};

/// Runs verification cases, and writes what came of them.
/// @return kDone; kNotConverged where a case failed or a repetition was not equal; 128 + signal where it was
/// interrupted
/// @throws InputError, SceneError, FileError, BackendError
int verify_command(const VerifyOptions& options);

}  // namespace fascia::app
