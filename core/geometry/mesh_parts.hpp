#pragma once

#include "core/geometry/surface.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fascia {

/// Parts of a mesh: solids, sheets and lines (a volume that thins out into a sheet, a membrane with strands). Parts
/// that touch share their coordinates exactly.
struct MeshParts {
  std::optional<ClosedSurface> solid;  ///< of the volume cells; none without them
  /// The triangles that are no face of a volume cell; open, closed or branched. Each part that hangs together across
  /// edges of two triangles is consistently oriented, outward where it is closed.
  TriangleMesh sheet;
  std::vector<Vec3d> line_points;
  std::vector<std::array<int, 2>> segments;  ///< line cells, each once and longer than zero
  std::vector<std::string> messages;         ///< what was repaired, in all parts: welded, turned over, left out
};

/// Coincident points are welded (within 1e-9 of the bounding box's diagonal), unused ones dropped, quadrilaterals
/// split. A triangle or volume cell that a file repeats for another group counts once.
/// @throws InputError  no cells of any of these kinds, NaN, flat triangles, a sheet with one side only, and
///                     what closed_surface() throws for volume cells; with the file and its own cell or node number
MeshParts mesh_parts(const Mesh& mesh);

}  // namespace fascia
