#pragma once

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace fascia::app {

struct RunOptions {
  std::filesystem::path scene;
  std::optional<std::string> text;  ///< run in the place of what the file holds now
  std::vector<std::string> overrides;
  std::optional<std::filesystem::path> output;
  std::optional<std::string> backend;
  std::optional<int> threads, gpus;
  bool quiet = false, json = false, verbose = false;
  std::function<void(nlohmann::ordered_json&)> complete;  ///< adds to the summary of a run before it is written
  bool estimate = false;     ///< errors are estimated, whether the scene asks for it or not
  bool no_estimate = false;  ///< nor where the scene asks for it
  bool new_trials = false;   ///< of a scene with a need: trials that were kept are not taken
};

/// The program returns these; of a run that a signal ended it returns 128 + the signal.
enum ExitStatus { kDone = 0, kDiffers = 1, kWrongInput = 2, kNotConverged = 3, kFileProblem = 4, kNoBackend = 5 };

/// Simulates a scene and writes its results. Errors of input and files are exceptions (main.cpp).
int run_scene(const RunOptions& options);

/// Reads and checks a scene, and says what would be simulated; writes nothing.
int check_scene(const RunOptions& options);

}  // namespace fascia::app
