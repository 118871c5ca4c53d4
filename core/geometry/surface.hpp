#pragma once

#include "core/geometry/mesh.hpp"

#include <string>
#include <vector>

namespace fascia {

/// The closed outward-oriented surface of a solid, from a volume mesh (faces that one cell has) or a surface mesh.
struct ClosedSurface {
  TriangleMesh mesh;
  double volume = 0;                  ///< [m³] > 0
  std::vector<std::string> messages;  ///< what was repaired: turned over, welded
};

/// Coincident vertices are welded (within 1e-9 of the bounding box's diagonal), unused ones dropped, quadrilaterals
/// split.
/// Cells and triangles that repeat others are left out. The surface may touch itself along edges and in points: then
/// more than two triangles share an edge, as many in one direction as in the other.
/// @throws InputError  open or branching edges, flat or inverted cells, mixed orientation, NaN; with the file and its
///                     own cell or node number
ClosedSurface closed_surface(const Mesh& mesh);

/// Closed parts that overlap by more than a fiftieth of the volume: refused where the volume counts, else
/// told.
enum class OfOverlap { is_refused, is_told };

/// Makes a closed surface bound matter whose parts all face outward: those that lie inside of an odd number of others
/// are turned inward, since they bound cavities.
/// @param file  begins messages and errors
/// @return  what was found
/// @throws InputError  parts that overlap, where that is refused
std::vector<std::string> turn_cavities(const std::string& file, OfOverlap overlap, TriangleMesh& closed);

}  // namespace fascia
