#pragma once

#include "app/run/run_scene.hpp"
#include "assembly/specification/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// A scene with what was chosen for it, as TOML: it runs without a search and gives the same results. The output
/// directory is left out, so that they go beside; paths of files are made relative to `folder`.
/// @param overrides  that make the choice, behind the scene's own
/// @param comments   lines for its head
std::string chosen_scene(const Scene& scene, const std::vector<std::string>& overrides,
                         const std::vector<std::string>& comments, const std::filesystem::path& folder);

/// Writes that scene beside its results.
void write_chosen_scene(const Scene& scene, const std::vector<std::string>& overrides,
                        const std::vector<std::string>& comments);

/// Options run or check a scene as it was chosen, without an estimate: who made the choice tells its errors.
RunOptions options_of_choice(const RunOptions& options, const Scene& scene, const std::vector<std::string>& overrides);

}  // namespace fascia::app
