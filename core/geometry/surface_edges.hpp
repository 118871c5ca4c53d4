#pragma once

#include "core/geometry/surface_parts.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

/// Edges, neighbours and connected parts of triangulated surfaces; for the files of surface_parts.hpp only.
namespace fascia::surface_parts {

/// An edge of a triangle, under the name that all its triangles give it.
struct Edge {
  int low = 0, high = 0;
  int triangle = 0;
  bool forward = true;  ///< the triangle runs from low to high
  bool same_as(const Edge& b) const { return low == b.low && high == b.high; }
};

/// All edges of all triangles; those that are the same lie side by side, by triangle.
std::vector<Edge> sorted_edges(const std::vector<Triangle>& triangles);

/// Calls act(std::span<const Edge>) for each edge, with those that are the same. @param edges  sorted
template <class Act>
void for_each_edge(const std::vector<Edge>& edges, const Act& act) {
  for (std::size_t e = 0, end = 0; e < edges.size(); e = end) {
    for (end = e; end < edges.size() && edges[end].same_as(edges[e]);) ++end;
    act(std::span(edges).subspan(e, end - e));
  }
}

/// For each triangle its neighbours across edges that exactly two triangles have, and whether both run along the edge
/// in the same direction.
struct Neighbours {
  struct Link {
    int triangle = -1;  ///< −1 for none: the edge is free, or the surface branches there
    bool same_direction = false;
  };
  std::vector<std::array<Link, 3>> of;

  Neighbours(std::size_t triangle_count, const std::vector<Edge>& edges);

  /// Links two triangles that run in opposite directions along an edge of more.
  void link(int a, int b);
};

/// Components of a surface that hang together across edges of two triangles, and which triangles must turn to agree
/// with the first of their component.
struct Components {
  std::vector<int> of;     ///< component of each triangle
  std::vector<bool> turn;  ///< of each triangle
  int count = 0;
  bool orientable = true;
  int twisted = -1;  ///< a triangle that must turn and must not, where not orientable

  explicit Components(const Neighbours& neighbours);

 private:
  void walk(const Neighbours& neighbours, int start, int component);
};

}  // namespace fascia::surface_parts
