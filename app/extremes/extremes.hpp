#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct ExtremesOptions {
  std::optional<std::filesystem::path> scene;  ///< swept; none: the program's own map
  std::vector<std::string> overrides;          ///< of the scene
  std::filesystem::path output = "results/extremes";
  std::optional<std::filesystem::path> compare;  ///< a stored extremes.csv
  std::optional<std::filesystem::path> beside;  ///< what another program said of the cells, as bench/calculix.py writes
  std::vector<std::string> only;                ///< cells whose names hold all of these; none: all
  std::optional<std::string> backend;
  int jobs = 0;               ///< runs at once; 0: as many as there are processors
  double time_limit = 60;     ///< of each run [s]
  double memory_limit = 4e9;  ///< of each run [bytes]
  int pairs = 300;            ///< cells in which two numbers are extreme
  double quicker_than = 0;    ///< leaves out cells that took longer in `compare` [s]; 0: none
  bool reduced = false, list = false, quiet = false;
  bool resume = false;  ///< goes on with what `output` holds of the same map
};

/// Runs the map of extremes, or a scene over decades of its numbers, and writes extremes.csv, extremes.html,
/// extremes.json.
/// @return kDone; kNotConverged where a cell leads astray or, with `compare`, got worse; 128 + signal where it was
/// interrupted
/// @throws InputError, SceneError, FileError
int run_extremes(const ExtremesOptions& options);

}  // namespace fascia::app
