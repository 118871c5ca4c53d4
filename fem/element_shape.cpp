#include "fem/element_shape.hpp"

#include "core/base/index.hpp"

namespace fascia {
namespace {

using Edge = std::array<int, 2>;
using Face = std::array<int, 4>;

constexpr std::array<Edge, 6> tetrahedron_edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<Edge, 12> hexahedron_edges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
constexpr std::array<Face, 4> tetrahedron_faces{{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}};
constexpr std::array<Face, 6> hexahedron_faces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
constexpr std::array<std::array<int, 3>, 4> tetrahedron_neighbours{{{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}}};
constexpr std::array<std::array<int, 3>, 8> hexahedron_neighbours{
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};
constexpr std::array<Vec3d, 4> tetrahedron_corners{{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
constexpr std::array<Vec3d, 8> hexahedron_corners{{{{-1, -1, -1}},
                                                   {{1, -1, -1}},
                                                   {{1, 1, -1}},
                                                   {{-1, 1, -1}},
                                                   {{-1, -1, 1}},
                                                   {{1, -1, 1}},
                                                   {{1, 1, 1}},
                                                   {{-1, 1, 1}}}};

constexpr std::array<Vec3d, 4> barycentric_gradients{{{{-1, -1, -1}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};

std::array<double, 4> barycentric(const Vec3d& xi) { return {1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]}; }

/// One node of a hexahedron: N and dN/dξ. A corner has |a| = (1, 1, 1), the middle of an edge a zero along it.
struct NodeShape {
  double value = 0;
  Vec3d gradient{};
};

/// Π_c f_c with f_c = 1 + a_c ξ_c, or 1 − ξ_c² where a_c = 0, and its gradient.
NodeShape product(const Vec3d& a, const Vec3d& xi) {
  Vec3d f, df;
  for (int c = 0; c < 3; ++c) {
    f[c] = a[c] != 0 ? 1 + a[c] * xi[c] : 1 - xi[c] * xi[c];
    df[c] = a[c] != 0 ? a[c] : -2 * xi[c];
  }
  return {f[0] * f[1] * f[2], {{df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2]}}};
}

NodeShape hexahedron_node(ElementShape shape, int node, const Vec3d& xi) {
  if (node >= 8) {
    const Edge& edge = hexahedron_edges[at(node - 8)];
    const Vec3d a = 0.5 * (hexahedron_corners[at(edge[0])] + hexahedron_corners[at(edge[1])]);
    const NodeShape p = product(a, xi);
    return {p.value / 4, p.gradient * 0.25};
  }
  const Vec3d& a = hexahedron_corners[at(node)];
  const NodeShape p = product(a, xi);
  if (shape == ElementShape::hex8) return {p.value / 8, p.gradient * 0.125};
  const double s = dot(a, xi) - 2;
  return {p.value * s / 8, (p.gradient * s + a * p.value) * 0.125};
}

}  // namespace

std::span<const Edge> edges_of(ElementFamily family) {
  if (family == ElementFamily::tetrahedra) return tetrahedron_edges;
  return hexahedron_edges;
}

std::span<const Face> faces_of(ElementFamily family) {
  if (family == ElementFamily::tetrahedra) return tetrahedron_faces;
  return hexahedron_faces;
}

std::span<const std::array<int, 3>> corner_neighbours(ElementFamily family) {
  if (family == ElementFamily::tetrahedra) return tetrahedron_neighbours;
  return hexahedron_neighbours;
}

std::span<const Vec3d> reference_corners(ElementFamily family) {
  if (family == ElementFamily::tetrahedra) return tetrahedron_corners;
  return hexahedron_corners;
}

Vec3d reference_center(ElementFamily family) {
  return family == ElementFamily::tetrahedra ? Vec3d{{0.25, 0.25, 0.25}} : Vec3d{};
}

ShapeValues shape_values(ElementShape shape, const Vec3d& xi) {
  ShapeValues N{};
  if (family_of(shape) == ElementFamily::hexahedra) {
    for (int n = 0; n < node_count(shape); ++n) N[at(n)] = hexahedron_node(shape, n, xi).value;
    return N;
  }
  const auto L = barycentric(xi);
  const bool linear = shape == ElementShape::tet4;
  for (std::size_t n = 0; n < 4; ++n) N[n] = linear ? L[n] : L[n] * (2 * L[n] - 1);
  for (std::size_t e = 0; e < 6 && !linear; ++e)
    N[4 + e] = 4 * L[at(tetrahedron_edges[e][0])] * L[at(tetrahedron_edges[e][1])];
  return N;
}

ShapeGradients shape_gradients(ElementShape shape, const Vec3d& xi) {
  ShapeGradients dN{};
  if (family_of(shape) == ElementFamily::hexahedra) {
    for (int n = 0; n < node_count(shape); ++n) dN[at(n)] = hexahedron_node(shape, n, xi).gradient;
    return dN;
  }
  const auto L = barycentric(xi);
  const auto& dL = barycentric_gradients;
  const bool linear = shape == ElementShape::tet4;
  for (std::size_t n = 0; n < 4; ++n) dN[n] = linear ? dL[n] : dL[n] * (4 * L[n] - 1);
  for (std::size_t e = 0; e < 6 && !linear; ++e) {
    const std::size_t a = at(tetrahedron_edges[e][0]), b = at(tetrahedron_edges[e][1]);
    dN[4 + e] = 4 * (dL[a] * L[b] + dL[b] * L[a]);
  }
  return dN;
}

}  // namespace fascia
