#pragma once

#include "fem/element_mesh.hpp"

/// Meshes of simple solids. Numbers of nodes and elements run from 1.
namespace fascia {

/// What a solid is cut into.
struct ElementKind {
  ElementFamily family = ElementFamily::hexahedra;
  int order = 1;  ///< 1 or 2: nodes in the middle of edges; on curved surfaces they lie on the true surface
  /// Tetrahedra a hexahedron: 6 around its main diagonal, or 5 with four at corners. Boxes and blocks are mirrored from
  /// cell to cell, so that no direction is favoured; cells around a core all have the diagonal from node 0 to node 6.
  /// Faces of neighbours match in both.
  int split = 6;
};

/// A box with cells[c] cells along each axis. Nodes run x fastest, then y, then z, and lie at min + (max − min) i/n.
/// @throws InputError  min not below max, a number of cells below 1, a wrong order or split
ElementMesh generate_box(const Vec3d& min, const Vec3d& max, const std::array<int, 3>& cells, const ElementKind& kind);

/// A block with any eight corners, in the order of a hexahedron's nodes, mapped trilinearly: a tapered or skewed box.
/// @throws InputError  as above; corners that make a cell flat or fold it
ElementMesh generate_block(const std::array<Vec3d, 8>& corners, const std::array<int, 3>& cells,
                           const ElementKind& kind);

/// A solid cylinder: a core of around/4 cells a side in layers of cells, a whole number near around/12, that fill the
/// circle.
/// @param cells  along the axis (at least 1), around (a multiple of 4)
/// @throws InputError  no length or radius, wrong numbers of cells, order or split (5 does not match here)
ElementMesh generate_cylinder(const Vec3d& from, const Vec3d& to, double radius, const std::array<int, 2>& cells,
                              const ElementKind& kind);

/// A solid ellipsoid along the axes: a core of around/4 cells a side in hulls of cells.
/// @param cells  around (a multiple of 4), layers between core and surface (at least 1)
/// @throws InputError  as for cylinders
ElementMesh generate_ellipsoid(const Vec3d& center, const Vec3d& radii, const std::array<int, 2>& cells,
                               const ElementKind& kind);

}  // namespace fascia
