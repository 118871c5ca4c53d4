#include "fem/element_mesh_parts.hpp"

namespace fascia {
namespace {

using namespace element_parts;

using Triangles = std::vector<std::array<int, 3>>;

/// Cuts a quadrilateral at its lowest node.
void append_quadrilateral(const std::array<int, 4>& n, Triangles& triangles) {
  const auto s = static_cast<std::size_t>(std::ranges::min_element(n) - n.begin());
  triangles.push_back({n[s], n[(s + 1) % 4], n[(s + 2) % 4]});
  triangles.push_back({n[s], n[(s + 2) % 4], n[(s + 3) % 4]});
}

void append_face(const ElementMesh& mesh, const std::vector<int>& n, Triangles& triangles) {
  const std::size_t corners = family_of(mesh.shape) == ElementFamily::tetrahedra ? 3 : 4;
  for (std::size_t c = 0; c < corners && n.size() > corners; ++c)
    triangles.push_back({n[c], n[corners + c], n[corners + (c + corners - 1) % corners]});
  const std::size_t first = n.size() - corners;  // of the face itself, or of the middles of its edges
  if (corners == 3)
    triangles.push_back({n[first], n[first + 1], n[first + 2]});
  else
    append_quadrilateral({n[first], n[first + 1], n[first + 2], n[first + 3]}, triangles);
}

}  // namespace

std::vector<int> element_parts::face_corners(const ElementMesh& mesh, const ElementFace& face) {
  const auto nodes = mesh.element(at(face.element));
  std::vector<int> corners;
  for (const int n : faces_of(family_of(mesh.shape))[at(face.face)])
    if (n >= 0) corners.push_back(nodes[at(n)]);
  return corners;
}

std::vector<int> element_parts::face_nodes(const ElementMesh& mesh, const ElementFace& face) {
  std::vector<int> nodes = face_corners(mesh, face);
  if (order_of(mesh.shape) == 1) return nodes;
  const auto element = mesh.element(at(face.element));
  const auto edges = edges_of(family_of(mesh.shape));
  const std::size_t corners = nodes.size();
  for (std::size_t c = 0; c < corners; ++c) {
    const int i = nodes[c], j = nodes[(c + 1) % corners];
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const int a = element[at(edges[e][0])], b = element[at(edges[e][1])];
      if ((a == i && b == j) || (a == j && b == i)) nodes.push_back(element[at(corner_count(mesh.shape)) + e]);
    }
  }
  return nodes;
}

std::vector<ElementFace> element_parts::sorted_faces(const ElementMesh& mesh) {
  const auto faces = faces_of(family_of(mesh.shape));
  const auto lowest = [](const std::array<int, 4>& key) { return at(key[0] >= 0 ? key[0] : key[1]); };
  const auto face_of = [&](std::size_t e, std::size_t f) {
    const auto nodes = mesh.element(e);
    ElementFace face{{}, static_cast<int>(e), static_cast<int>(f)};
    for (std::size_t n = 0; n < 4; ++n) face.key[n] = faces[f][n] < 0 ? -1 : nodes[at(faces[f][n])];
    std::ranges::sort(face.key);
    return face;
  };
  // By lowest node first: few faces share one, and sorting those costs little.
  std::vector<std::size_t> begin(mesh.nodes.size() + 1, 0);
  std::vector<ElementFace> unsorted;
  unsorted.reserve(faces.size() * mesh.size());
  for (std::size_t e = 0; e < mesh.size(); ++e)
    for (std::size_t f = 0; f < faces.size(); ++f) {
      unsorted.push_back(face_of(e, f));
      ++begin[lowest(unsorted.back().key) + 1];
    }
  for (std::size_t n = 1; n < begin.size(); ++n) begin[n] += begin[n - 1];
  std::vector<std::size_t> next = begin;
  std::vector<ElementFace> result(unsorted.size());
  for (const ElementFace& face : unsorted) result[next[lowest(face.key)]++] = face;
  for (std::size_t n = 0; n + 1 < begin.size(); ++n)
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(begin[n]),
              result.begin() + static_cast<std::ptrdiff_t>(begin[n + 1]),
              [](const ElementFace& a, const ElementFace& b) {
                return a.key != b.key ? a.key < b.key : a.element < b.element;
              });
  return result;
}

BoundaryFaces boundary_faces(const ElementMesh& mesh) {
  std::vector<ElementFace> outer;
  const std::vector<ElementFace> faces = sorted_faces(mesh);
  for_each_face(faces, [&](std::span<const ElementFace> same) {
    if (same.size() == 1) outer.push_back(same.front());
  });
  std::ranges::sort(outer, [](const ElementFace& a, const ElementFace& b) {
    return a.element != b.element ? a.element < b.element : a.face < b.face;
  });

  BoundaryFaces result;
  std::vector<int> point(mesh.nodes.size(), -1);
  for (const ElementFace& face : outer) {
    const std::vector<int> nodes = face_nodes(mesh, face);
    append_face(mesh, nodes, result.surface.triangles);
    result.element.resize(result.surface.triangles.size(), face.element);
    for (const int n : nodes) point[at(n)] = 0;
  }
  for (std::size_t n = 0; n < point.size(); ++n) {
    if (point[n] < 0) continue;
    point[n] = static_cast<int>(result.node.size());
    result.node.push_back(static_cast<int>(n));
    result.surface.points.push_back(mesh.nodes[n]);
  }
  for (auto& triangle : result.surface.triangles)
    for (int& n : triangle) n = point[at(n)];
  return result;
}

}  // namespace fascia
