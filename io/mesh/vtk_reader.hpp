#pragma once

#include "core/geometry/mesh.hpp"
#include "core/geometry/mid_nodes.hpp"

#include <filesystem>
#include <string>

namespace fascia::io {

/// Reads a mesh with VTK. The path must be readable.
/// @param ending     ".vtk", ".vtu", ".vtp", ".stl", ".obj", ".off" or ".ply"
/// @param mid_nodes  of quadratic cells
/// @throws InputError  where the content is wrong; VTK itself prints nothing
Mesh read_vtk_mesh(const std::filesystem::path& path, const std::string& ending, MidNodes mid_nodes);

}  // namespace fascia::io
