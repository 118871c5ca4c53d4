#pragma once

#include "fem/element_mesh.hpp"

namespace fascia {

/// A figure of the worst element, the file's number of that element and its middle [m].
struct WorstElement {
  double value = 0;
  std::int64_t number = 0;
  Vec3d middle{};
};

/// How well shaped the elements of a mesh are, judged by their corners.
struct MeshQuality {
  WorstElement least_dihedral;     ///< smallest angle between two faces of an element [degrees]
  WorstElement greatest_dihedral;  ///< [degrees]
  WorstElement least_volume;       ///< volume of the smallest element / mean volume [-]
  /// Smallest det(a, b, c)/(|a| |b| |c|) of the three edges at a corner [-]: 1 for bricks, 0.71 for regular tetrahedra,
  /// below 0 where an element is folded at a corner.
  WorstElement least_jacobian;
  /// Smallest mean ratio 3 det(A)^⅔/|A|² [-], A the edges at a corner as seen from a regular tetrahedron or a cube: 1
  /// for these, 0 where an element is flat or folded, the same at any size.
  WorstElement least_ratio;
  WorstElement shortest_height;       ///< smallest distance of a corner from a plane of two edges next to it [m]
  double volume = 0;                  ///< of the whole mesh, by its quadrature [m³]
  std::size_t slivers = 0;            ///< elements with a dihedral angle below 5° or above 175°
  std::string sentence;               ///< all of this in words
  std::vector<std::string> messages;  ///< slivers, corners that fold
};

/// @param mesh  of at least one element
MeshQuality mesh_quality(const ElementMesh& mesh);

}  // namespace fascia
