#pragma once

#include "core/geometry/mesh.hpp"
#include "core/geometry/mid_nodes.hpp"

#include <string>
#include <string_view>

namespace fascia::io {

/// Reads a Gmsh mesh: 1 ($NOD, ASCII), 2 to 2.2 and 4.1 (ASCII or binary).
///
/// Linear cells of every kind; cells of higher order keep their corners, quadratic ones their mid-side nodes too where
/// these are asked for; nodes of faces and centres are left out. A cell that belongs to several physical groups appears
/// once for each, as Gmsh 2.2 itself writes it.
///
/// @param text       the whole file
/// @param name       the file's name, for messages
/// @param mid_nodes  of quadratic cells
/// @throws InputError  "NAME:LINE: what is wrong; remedy" (binary: "NAME: byte OFFSET: ...")
Mesh parse_gmsh(std::string_view text, const std::string& name, MidNodes mid_nodes = MidNodes::drop);

}  // namespace fascia::io
