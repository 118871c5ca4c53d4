#pragma once

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "fem/generate.hpp"

#include <string>

/// Steps that generators share; for generate*.cpp only.
namespace fascia::generate_parts {

/// Hexahedra whose diagonal from node 0 to node 6 runs from the least to the greatest of three directions in which all
/// neighbours agree; those of a grid with parity may be mirrored from cell to cell.
struct HexahedronGrid {
  std::vector<Vec3d> nodes;
  std::vector<std::array<int, 8>> cells;
  std::vector<std::array<bool, 3>> parity;  ///< of each cell, along x, y, z: odd ones are mirrored; or empty
};

/// @throws InputError  an order other than 1 and 2, a split other than 5 and 6
void check_kind(const ElementKind& kind);

/// @throws InputError  `count` below 1, or `total` above what memory should hold
void check_cells(const std::string& what, int count);
void check_total(double total);

/// The grid's hexahedra, or the tetrahedra that they are split into; of order 1.
/// @throws InputError  tetrahedra by five where the grid has no parity
ElementMesh elements_of(const HexahedronGrid& grid, const ElementKind& kind);

/// Makes the mesh quadratic where the kind is, and moves the middle nodes of edges whose ends both lie on a curved
/// surface: place(middle of the chord). `on_surface` holds a flag a node.
template <class Place>
ElementMesh with_order(const ElementMesh& linear, const ElementKind& kind, const std::vector<char>& on_surface,
                       Place&& place) {
  if (kind.order == 1) return linear;
  ElementMesh mesh = quadratic(linear);
  const auto edges = edges_of(kind.family);
  std::vector<char> moved(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const auto nodes = mesh.element(e);
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const std::size_t middle = at(nodes[at(corner_count(kind.family)) + k]);
      if (moved[middle] || !on_surface[at(nodes[at(edges[k][0])])] || !on_surface[at(nodes[at(edges[k][1])])]) continue;
      mesh.nodes[middle] = place(mesh.nodes[middle]);
      moved[middle] = 1;
    }
  }
  return mesh;
}

}  // namespace fascia::generate_parts
