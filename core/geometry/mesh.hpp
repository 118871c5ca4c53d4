#pragma once

#include "core/math/vec3.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fascia {

enum class CellType { vertex, line, triangle, quadrilateral, tetrahedron, hexahedron, wedge, pyramid };

/// Number of corner nodes of a cell.
constexpr int node_count(CellType type) {
  constexpr std::array<int, 8> counts{1, 2, 3, 4, 4, 8, 6, 5};
  return counts[static_cast<std::size_t>(type)];
}

/// Topological dimension of a cell, 0 to 3.
constexpr int dimension_of(CellType type) {
  constexpr std::array<int, 8> dimensions{0, 1, 2, 2, 3, 3, 3, 3};
  return dimensions[static_cast<std::size_t>(type)];
}

/// Number of mid-side nodes of a quadratic cell: one an edge; none for wedges and pyramids, which are kept as linear
/// cells.
constexpr int mid_node_count(CellType type) {
  constexpr std::array<int, 8> counts{0, 1, 3, 4, 6, 12, 0, 0};
  return counts[static_cast<std::size_t>(type)];
}

/// Cells of one type and one order. Linear and quadratic cells of a type lie in separate blocks.
///
/// A mid-side node belongs to an edge between two corners; the edges of a cell come in this order:
/// line 01; triangle 01 12 20; quadrilateral 01 12 23 30; tetrahedron 01 12 20 03 13 23;
/// hexahedron 01 12 23 30 45 56 67 74 04 15 26 37.
struct CellBlock {
  CellType type = CellType::triangle;
  std::vector<int> nodes;                 ///< node_count(type) point indices a cell (zero-based)
  std::vector<int> group;                 ///< index into Mesh::groups, −1 for none (one a cell)
  std::vector<std::int64_t> file_number;  ///< the file's own cell number, for messages (one a cell)
  int mid_nodes_per_cell = 0;             ///< 0 for linear cells, mid_node_count(type) for quadratic ones
  std::vector<int> mid_nodes = {};        ///< mid_nodes_per_cell point indices a cell, in the order of edges above

  std::size_t size() const { return nodes.size() / static_cast<std::size_t>(node_count(type)); }
};

/// A named set of cells: a physical group of Gmsh, or the cells of one number in a VTK file.
struct MeshGroup {
  std::string name;
  int number = 0;
  int dimension = 0;
};

/// A mesh as a file holds it.
struct Mesh {
  std::string file;
  std::vector<Vec3d> points;  ///< [m, before any transform of the scene]
  std::vector<std::int64_t> point_file_number;
  std::vector<CellBlock> blocks;
  std::vector<MeshGroup> groups;
  std::vector<std::string> messages = {};  ///< what its reader mended
};

/// A triangulated surface. Closed and outward-oriented where it bounds a solid.
struct TriangleMesh {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace fascia
