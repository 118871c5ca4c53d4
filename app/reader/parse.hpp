#pragma once

#include "app/scene/diagnostics.hpp"
#include "assembly/specification/scene.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::app {

/// Reads a scene file, applies the overrides ("key.path=value") and checks every key against the schema.
/// @throws SceneError  with everything that is wrong (also: not valid TOML)
/// @throws FileError   (core/base/errors.hpp) where the file cannot be read
Scene parse_scene_file(const std::filesystem::path& path, const std::vector<std::string>& overrides);

/// The same for a text; `path` gives the name for messages and the folder for relative paths.
Scene parse_scene_text(std::string_view text, const std::filesystem::path& path,
                       const std::vector<std::string>& overrides);

/// Reads a TOML text of this project, whatever it describes.
/// @throws SceneError  where it is no TOML, or larger than any such text
Value parse_document(std::string_view text, Diagnostics& diagnostics);

}  // namespace fascia::app
