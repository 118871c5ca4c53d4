#pragma once

#include "core/geometry/mesh.hpp"
#include "fem/element_shape.hpp"
#include "fem/quadrature.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fascia {

/// A named part of a mesh of elements: the nodes of all its cells, whether of the volume, of surfaces, lines or points.
struct ElementGroup {
  std::string name;
  int number = 0;
  int dimension = 0;
  std::vector<int> nodes;                   ///< ascending
  std::vector<int> elements;                ///< of volume cells; ascending
  std::vector<std::array<int, 2>> edges;    ///< edges of its surface and line cells as pairs of corners, ascending
  std::vector<std::array<int, 4>> faces{};  ///< corners of its surface cells, around; a triangle's last is −1
};

/// Finite elements of one shape on shared nodes.
struct ElementMesh {
  ElementShape shape = ElementShape::tet4;
  std::string file;                          ///< empty where the mesh was generated
  std::vector<Vec3d> nodes;                  ///< [m]
  std::vector<int> element_nodes;            ///< node_count(shape) node indices an element, corners first
  std::vector<std::int64_t> node_number;     ///< the file's own, or from 1, for messages
  std::vector<std::int64_t> element_number;  ///< the same of elements
  std::vector<ElementGroup> groups;
  std::vector<std::string> messages;  ///< what was repaired or looks odd

  std::size_t size() const { return element_nodes.size() / static_cast<std::size_t>(node_count(shape)); }
  std::span<const int> element(std::size_t e) const {
    const auto n = static_cast<std::size_t>(node_count(shape));
    return std::span(element_nodes).subspan(e * n, n);
  }
};

/// The mesh with a node in the middle of each straight edge, shared by all elements at the edge; a quadratic mesh stays
/// as it is. A group receives the middle nodes of its own cells' edges.
ElementMesh quadratic(const ElementMesh& mesh);

/// Shape functions of an element at a place of it.
struct ElementPoint {
  Vec3d X{};               ///< Σ X_i N_i [m]
  ShapeValues N{};         ///< [-]
  ShapeGradients dN_dX{};  ///< [1/m]; zero where det J = 0
  double det_J = 0;        ///< det dX/dξ [m³]
};

ElementPoint shape_at(const ElementMesh& mesh, std::size_t element, const Vec3d& xi);
/// At a point of the quadrature of the mesh's own shape.
ElementPoint shape_at_point(const ElementMesh& mesh, std::size_t element, const QuadraturePoint& place);

/// An element's place at the centre of its reference element [m].
Vec3d element_middle(const ElementMesh& mesh, std::size_t element);

/// Volume of an element by the quadrature of its shape [m³]; negative where it is turned the wrong way round.
double element_volume(const ElementMesh& mesh, std::size_t element);

/// The outer faces of a mesh: those that one element has. Closed and outward.
///
/// Triangles join nodes only: a quadrilateral is cut in 2 at its lowest node, a quadratic triangle in 4, a quadratic
/// quadrilateral in 6.
struct BoundaryFaces {
  TriangleMesh surface;      ///< on the nodes of the boundary only
  std::vector<int> node;     ///< of the mesh, for each point of the surface; ascending
  std::vector<int> element;  ///< of each triangle
};

BoundaryFaces boundary_faces(const ElementMesh& mesh);

}  // namespace fascia
