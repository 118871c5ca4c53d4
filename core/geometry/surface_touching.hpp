#pragma once

#include "core/geometry/surface_edges.hpp"

#include <array>
#include <span>
#include <vector>

/// Surfaces that touch themselves along edges; for the files of surface_parts.hpp only.
namespace fascia::surface_parts {

/// An edge of four triangles or more, as many in one direction as in the other.
struct TouchingEdge {
  int low = 0, high = 0;
  std::vector<std::array<int, 2>> pairs;  ///< of triangles: the faces of one wedge of what the surface bounds
};

/// True where as many of the triangles at an edge run along it in one direction as in the other.
/// @param edges  all of sorted_edges() under one name
bool balanced(std::span<const Edge> edges);

/// True where every edge of the triangles is balanced: they bound solids, or there are none.
bool encloses(const std::vector<Triangle>& triangles);

/// True where an edge of more than two triangles is not balanced.
bool branches(const std::vector<Triangle>& triangles);

/// For each triangle whether it bounds something: its patch, which hangs together across edges of two triangles, does
/// alone, or together with all patches that hang on it.
std::vector<bool> bounding_triangles(const std::vector<Triangle>& triangles);

/// The surface's edges of more than two triangles that are balanced.
std::vector<TouchingEdge> touching_edges(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles);

/// A surface without its touching edges: the wedges that met there have nodes of their own.
struct PartedSurface {
  std::vector<Triangle> triangles;  ///< the former ones in their order, then halves of those that were halved
  std::vector<int> half_of;         ///< for each triangle behind the former ones: the one that it was cut from
  /// For each node behind the former ones: the two that it lies between; one of them twice where it is a copy.
  std::vector<std::array<int, 2>> added;
  std::size_t joined = 0;  ///< parts that would have come loose, and stay joined to another in one node
};

/// Gives each wedge at the touching edges its own nodes; a part that would come loose keeps one in common. Where a
/// wedge still shares both ends of the edge with another, because the surface hangs together around them, it gets a
/// node in the middle.
PartedSurface part_at(const std::vector<TouchingEdge>& touching, std::size_t point_count,
                      std::vector<Triangle> triangles);

}  // namespace fascia::surface_parts
