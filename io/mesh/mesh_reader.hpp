#pragma once

#include "core/geometry/mesh.hpp"
#include "core/geometry/mid_nodes.hpp"

#include <filesystem>

namespace fascia::io {

/// Reads Gmsh 1 (ASCII), 2 to 2.2 and 4.1 (ASCII and binary), VTK legacy, VTU, VTP, STL, OBJ, OFF or PLY, chosen by
/// the file's ending. Mesh::messages says what was mended.
///
/// Groups are Gmsh's physical groups. VTK's files have none; there the first of these cell arrays that the file has, of
/// integers and one component, numbers them: "group", "gmsh:physical", "PhysicalGroup", "medit:ref", "cell_tags",
/// "CellEntityIds". Cells of one number and one dimension are a group, named by its number; 0 is no group.
///
/// @param mid_nodes  of quadratic cells: dropped, or kept where the format says which edge each belongs to
///                   (VTK's Lagrange hexahedra lose them: the order differs between versions of the format)
/// @throws FileError   where the file cannot be opened
/// @throws InputError  where its content is wrong: FILE:LINE: what is wrong; what would be right
Mesh read_mesh(const std::filesystem::path& path, MidNodes mid_nodes = MidNodes::drop);

}  // namespace fascia::io
