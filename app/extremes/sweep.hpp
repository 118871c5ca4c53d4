#pragma once

#include "app/extremes/cells.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// Cells around a scene: its stiffness, Poisson's ratio, size, time step and loads over decades, one at a time.
/// @throws SceneError, FileError  the scene itself is wrong
std::vector<ExtremeCell> sweep_cells(const std::filesystem::path& scene, const std::vector<std::string>& overrides);

}  // namespace fascia::app
