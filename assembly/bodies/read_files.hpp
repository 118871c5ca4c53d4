#pragma once

#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/geometry/mesh.hpp"
#include "core/geometry/point_table.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace fascia {

/// Checks a mesh, which a program may have made, and numbers its points and cells where it did not.
/// @throws InputError  lists of wrong lengths, points or groups that are not there, places that are not finite
Mesh checked(Mesh mesh, const std::filesystem::path& path);
/// Checks a table of points. @throws InputError  as above
PointTable checked(PointTable table, const std::filesystem::path& path);

/// Calls the reader that a specification names for a file, and checks what it gives.
/// @throws SceneError  there is no reader
/// @throws FileError   read()'s own, behind the key: "SCENE:LINE:COLUMN: key: FILE: why it cannot be read"
template <class Read, class... Args>
auto read_for(const Place& key, const std::filesystem::path& path, const Read& read, Args... args) {
  if (!read) throw SceneError({{key, fmt::format("nothing reads {}; give the specification a reader", path.string())}});
  try {
    return checked(read(args...), path);
  } catch (const FileError& e) {
    throw FileError(Diagnostic{key, e.what()}.text());
  }
}

}  // namespace fascia
