#include "fem/element_mesh.hpp"

#include "core/math/mat3.hpp"
#include "fem/element_mesh_parts.hpp"
#include "fem/quadrature.hpp"

#include <limits>

namespace fascia {

using namespace element_parts;

void element_parts::add_edge_nodes(const ElementMesh& mesh, const EdgeNumbers& edges, std::span<const int> edge_node,
                                   std::vector<ElementGroup>& groups) {
  for (ElementGroup& group : groups) {
    for (const int e : group.elements) {
      const auto nodes = mesh.element(at(e));
      for (const auto& [a, b] : edges_of(family_of(mesh.shape)))
        group.nodes.push_back(edge_node[at(edges.find(nodes[at(a)], nodes[at(b)]))]);
    }
    for (const auto& [a, b] : group.edges)
      if (const int edge = edges.find(a, b); edge >= 0) group.nodes.push_back(edge_node[at(edge)]);
    make_unique(group.nodes);
  }
}

ElementMesh quadratic(const ElementMesh& mesh) {
  if (order_of(mesh.shape) == 2) return mesh;
  const ElementFamily family = family_of(mesh.shape);
  ElementMesh result = mesh;
  result.shape = element_shape(family, 2);
  result.element_nodes.clear();

  EdgeNumbers edges(mesh.nodes.size());
  std::vector<int> edge_node;
  std::int64_t number = mesh.node_number.empty() ? 0 : *std::ranges::max_element(mesh.node_number);
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const auto corners = mesh.element(e);
    result.element_nodes.insert(result.element_nodes.end(), corners.begin(), corners.end());
    for (const auto& [a, b] : edges_of(family)) {
      const int i = corners[at(a)], j = corners[at(b)], edge = edges.add(i, j);
      if (at(edge) == edge_node.size()) {
        edge_node.push_back(static_cast<int>(result.nodes.size()));
        result.nodes.push_back(0.5 * (mesh.nodes[at(i)] + mesh.nodes[at(j)]));
        result.node_number.push_back(++number);
      }
      result.element_nodes.push_back(edge_node[at(edge)]);
    }
  }
  add_edge_nodes(mesh, edges, edge_node, result.groups);
  return result;
}

namespace {

ElementPoint placed(const ElementMesh& mesh, std::size_t element, const ShapeValues& N, const ShapeGradients& dN) {
  ElementPoint point;
  point.N = N;
  const auto nodes = mesh.element(element);
  const Vec3d& origin = mesh.nodes[at(nodes[0])];  // far from the scene's origin, sums of places would lose digits
  Mat3d J;                                         // dX/dξ
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const Vec3d d = mesh.nodes[at(nodes[n])] - origin;
    point.X += point.N[n] * d;
    J += outer(d, dN[n]);
  }
  point.X += origin;
  point.det_J = determinant(J);
  if (point.det_J == 0) return point;
  const Mat3d to_X = transpose(inverse(J));
  for (std::size_t n = 0; n < nodes.size(); ++n) point.dN_dX[n] = to_X * dN[n];
  return point;
}

}  // namespace

ElementPoint shape_at(const ElementMesh& mesh, std::size_t element, const Vec3d& xi) {
  return placed(mesh, element, shape_values(mesh.shape, xi), shape_gradients(mesh.shape, xi));
}

ElementPoint shape_at_point(const ElementMesh& mesh, std::size_t element, const QuadraturePoint& place) {
  return placed(mesh, element, place.N, place.dN);
}

Vec3d element_middle(const ElementMesh& mesh, std::size_t element) {
  return shape_at(mesh, element, reference_center(family_of(mesh.shape))).X;
}

namespace {

double jacobian(const ElementMesh& mesh, std::size_t element, const ShapeGradients& dN) {
  const auto nodes = mesh.element(element);
  const Vec3d& origin = mesh.nodes[at(nodes[0])];
  Mat3d J;
  for (std::size_t n = 1; n < nodes.size(); ++n) J += outer(mesh.nodes[at(nodes[n])] - origin, dN[n]);
  return determinant(J);
}

}  // namespace

double element_volume(const ElementMesh& mesh, std::size_t element) {
  double volume = 0;
  for (const QuadraturePoint& q : quadrature(mesh.shape)) volume += q.weight * jacobian(mesh, element, q.dN);
  return volume;
}

double element_parts::least_determinant(const ElementMesh& mesh, std::size_t element) {
  double least = std::numeric_limits<double>::infinity();
  for (const QuadraturePoint& q : quadrature(mesh.shape)) least = std::min(least, jacobian(mesh, element, q.dN));
  return least;
}

}  // namespace fascia
