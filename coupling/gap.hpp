#pragma once

#include "core/geometry/mesh.hpp"

#include <array>
#include <string>
#include <vector>

/// The space between parts of two surfaces, as matter that a tissue fills. Surfaces are in world coordinates; the parts
/// face each other.
namespace fascia {

/// A part of the surface of a body.
struct GapSide {
  std::string body;     ///< its name, for messages
  TriangleMesh faces;   ///< the selected triangles; points that none uses are allowed
  TriangleMesh whole;   ///< the body's surface
  bool closed = false;  ///< it encloses the body
};

struct GapVolume {
  TriangleMesh surface;              ///< closed, outward
  double volume = 0;                 ///< [m³]
  double smallest = 0, largest = 0;  ///< distance between the sides over the faces [m]
  double touching = 0;               ///< part of the first side's area where the gap closes, left out [-]
};

/// From each selected triangle of the first side (cut finer where the second side is curved) to the nearest points of
/// the second. Where the gap closes the volume thins out to nothing.
/// @throws InputError  sides without faces, bodies that overlap, sides that do not face each other
GapVolume gap_volume(const GapSide& first, const GapSide& second);

/// A sheet that runs from a line along the first side to one along the second: the lines follow the middle of each
/// selected strip along its length.
/// @param spacing  of the rows and columns of its triangles [m]; 0: chosen from the triangles of the sides
/// @throws InputError  as above, or a side without a length
TriangleMesh gap_sheet(const GapSide& first, const GapSide& second, double spacing);

/// Straight strands from points of the first side to the nearest of the second.
struct GapStrands {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 2>> segments;
};
/// @param spacing  least distance of strands on the first side [m]; 0: one from each vertex
GapStrands gap_strands(const GapSide& first, const GapSide& second, double spacing);

}  // namespace fascia
