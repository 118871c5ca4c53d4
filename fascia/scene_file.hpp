#pragma once

#include "fascia/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

/// Scene files: in the library fascia::scene_files.
namespace fascia {

/// Reads a scene file; its meshes are read when it is run, or a Stepper is built.
/// @param overrides  "key.path=value", as of the program's --set
/// @throws SceneError  everything that is wrong, with file, line and key; also a scene that states a need in the place
///                     of its resolution
/// @throws FileError   the file cannot be read
Scene read_scene_file(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

}  // namespace fascia
