#pragma once

#include "core/math/vec3.hpp"

#include <array>
#include <span>

namespace fascia {

/// Kinds of elements, named by their number of nodes. Quadratic ones have a node in the middle of each edge.
enum class ElementShape { tet4, tet10, hex8, hex20 };

enum class ElementFamily { tetrahedra, hexahedra };

inline constexpr int kMostElementNodes = 20;

constexpr int node_count(ElementShape shape) {
  constexpr std::array<int, 4> counts{4, 10, 8, 20};
  return counts[static_cast<std::size_t>(shape)];
}

constexpr ElementFamily family_of(ElementShape shape) {
  return shape == ElementShape::tet4 || shape == ElementShape::tet10 ? ElementFamily::tetrahedra
                                                                     : ElementFamily::hexahedra;
}

/// 1: linear, 2: quadratic.
constexpr int order_of(ElementShape shape) {
  return shape == ElementShape::tet10 || shape == ElementShape::hex20 ? 2 : 1;
}

/// @param order  1 or 2
constexpr ElementShape element_shape(ElementFamily family, int order) {
  if (family == ElementFamily::tetrahedra) return order == 2 ? ElementShape::tet10 : ElementShape::tet4;
  return order == 2 ? ElementShape::hex20 : ElementShape::hex8;
}

constexpr int corner_count(ElementFamily family) { return family == ElementFamily::tetrahedra ? 4 : 8; }
constexpr int corner_count(ElementShape shape) { return corner_count(family_of(shape)); }

/// Corners of each edge. The middle node of edge k is node corner_count + k:
/// tetrahedron 01 12 20 03 13 23; hexahedron 01 12 23 30 45 56 67 74 04 15 26 37.
std::span<const std::array<int, 2>> edges_of(ElementFamily family);

/// Corners of each face in the order that faces outward; the fourth of a triangle is −1.
std::span<const std::array<int, 4>> faces_of(ElementFamily family);

/// The three corners that edges join to each corner, in an order of positive volume.
std::span<const std::array<int, 3>> corner_neighbours(ElementFamily family);

/// Reference coordinates of the corners. Tetrahedron: ξ ≥ 0, Σ ξ ≤ 1; hexahedron: [−1, 1]³.
std::span<const Vec3d> reference_corners(ElementFamily family);

/// The middle of the reference element.
Vec3d reference_center(ElementFamily family);

/// One value a node; those past node_count(shape) are zero.
using ShapeValues = std::array<double, kMostElementNodes>;
using ShapeGradients = std::array<Vec3d, kMostElementNodes>;

/// Shape functions N(ξ) [-]: Lagrange polynomials of tetrahedra, trilinear and serendipity functions of hexahedra.
ShapeValues shape_values(ElementShape shape, const Vec3d& xi);

/// dN/dξ [-].
ShapeGradients shape_gradients(ElementShape shape, const Vec3d& xi);

}  // namespace fascia
