#pragma once

#include "core/math/vec3.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fascia {

enum class CellType { vertex, line, triangle, quadrilateral, tetrahedron, hexahedron, wedge, pyramid };

/// Number of nodes of a cell (linear cells; corner nodes of quadratic ones are kept, mid-side nodes dropped by
/// readers).
constexpr int node_count(CellType type) {
  constexpr std::array<int, 8> counts{1, 2, 3, 4, 4, 8, 6, 5};
  return counts[static_cast<std::size_t>(type)];
}

/// Cells of one type.
struct CellBlock {
  CellType type = CellType::triangle;
  std::vector<int> nodes;                 ///< node_count(type) point indices a cell (zero-based)
  std::vector<int> group;                 ///< index into Mesh::groups, −1 for none (one a cell)
  std::vector<std::int64_t> file_number;  ///< the file's own cell number, for messages (one a cell)

  std::size_t size() const { return nodes.size() / static_cast<std::size_t>(node_count(type)); }
};

/// A named set of cells: a physical group of Gmsh.
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
};

/// A triangulated surface. Closed and outward-oriented where it bounds a solid.
struct TriangleMesh {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace fascia
