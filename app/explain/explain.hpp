#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct ExplainOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;           ///< "key.path=value"
  std::optional<std::filesystem::path> output;  ///< of explain.json and the runs; none: they are not kept
  double change = 1e-2;                         ///< of probes, relative, that a suggestion may make
  int repeat = 3;                               ///< turns in which what is suggested is timed
  double time_limit = 600;                      ///< after which no change is begun [s]; 0: none
  bool quick = false;                           ///< one run of the scene and estimates, no run of variants
  bool json = false, quiet = false;
};

/// Says what each part of a scene costs and buys, by runs of the scene with each part and without it, and suggests
/// what makes it faster and leaves its probes as they are.
/// @return kDone; kNotConverged where the scene itself did not converge; 128 + the signal that ended it
/// @throws SceneError, InputError, FileError  as run_scene
int explain_scene(const ExplainOptions& options);

}  // namespace fascia::app
