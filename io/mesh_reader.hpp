#pragma once

#include "core/geometry/mesh.hpp"

#include <filesystem>

namespace fascia::io {

/// Reads Gmsh 2.2 and 4.1 (ASCII and binary), VTK legacy, VTU, VTP, STL, OBJ or PLY, chosen by the file's ending.
/// @throws FileError   where the file cannot be opened
/// @throws InputError  where its content is wrong: FILE:LINE: what is wrong; what would be right
Mesh read_mesh(const std::filesystem::path& path);

}  // namespace fascia::io
