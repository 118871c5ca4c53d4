#pragma once

#include "core/body/model_body.hpp"
#include "core/geometry/mesh.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fascia {

/// A triangulated mid-surface as shells use it: each connected part consistently oriented, outward where it is closed.
struct ShellMesh {
  std::vector<Vec3d> nodes;                   ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from the side that the normal points to
  std::vector<std::int64_t> file_number;      ///< of the triangles, for messages; empty where generated
  std::vector<BodyGroup> groups;              ///< nodes and cells (triangles) of each named group
  /// Edges of the line cells of each group, as pairs of nodes, ascending; empty where generated.
  std::vector<std::vector<std::array<int, 2>>> lines;
  std::vector<std::string> messages;  ///< what was repaired or looks bad
  std::string file;                   ///< empty where generated
};

/// The triangles of a file, or the boundary of its volume cells where it has no triangles.
///
/// Quadrilaterals are split, coincident nodes welded (within 1e-9 of the bounding box's diagonal), nodes that no cell
/// uses dropped; triangles that disagree with their neighbours turn over, by as few turns as possible in each connected
/// part, and closed parts face outward; copies of triangles are left out. Where the surface touches itself along an
/// edge it is split: each side has nodes of its own. Groups of surfaces have triangles and nodes, those of lines and
/// points nodes.
/// @throws InputError  no triangles, NaN, flat triangles, an edge where a third triangle branches off, a surface with
/// one
///                     side only; with the file and its own cell or node numbers
ShellMesh shell_mesh(const Mesh& mesh);

}  // namespace fascia
