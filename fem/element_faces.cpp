#include "fem/element_body.hpp"
#include "fem/element_mesh_parts.hpp"

#include <cmath>

/// Faces of finite elements, for loads on the surface.
namespace fascia {

namespace {

/// A place of a reference face, as weights of its corners, with the derivatives of these along two directions of it.
struct RulePoint {
  std::array<double, 4> N{}, ds{}, dt{};
  double weight = 0;  ///< they add up to the area of the reference face in s and t
};

/// Six points, exact for degree 4 (Dunavant 1985).
std::vector<RulePoint> triangle_rule() {
  constexpr double a = 0.445948490915965, b = 0.091576213509771, wa = 0.223381589678011, wb = 0.109951743655322;
  std::vector<RulePoint> rule;
  for (const auto& [c, w] : {std::pair{a, wa}, std::pair{b, wb}})
    for (const auto& [s, t] : {std::pair{c, c}, std::pair{1 - 2 * c, c}, std::pair{c, 1 - 2 * c}})
      rule.push_back({{1 - s - t, s, t, 0}, {-1, 1, 0, 0}, {-1, 0, 1, 0}, 0.5 * w});
  return rule;
}

/// 3 × 3 Gauss points.
std::vector<RulePoint> quadrilateral_rule() {
  const double g = std::sqrt(0.6);
  std::vector<RulePoint> rule;
  for (const auto& [s, ws] : {std::pair{-g, 5.0 / 9}, std::pair{0.0, 8.0 / 9}, std::pair{g, 5.0 / 9}})
    for (const auto& [t, wt] : {std::pair{-g, 5.0 / 9}, std::pair{0.0, 8.0 / 9}, std::pair{g, 5.0 / 9}})
      rule.push_back({{(1 - s) * (1 - t) / 4, (1 + s) * (1 - t) / 4, (1 + s) * (1 + t) / 4, (1 - s) * (1 + t) / 4},
                      {-(1 - t) / 4, (1 - t) / 4, (1 + t) / 4, -(1 + t) / 4},
                      {-(1 - s) / 4, -(1 + s) / 4, (1 + s) / 4, (1 - s) / 4},
                      ws * wt});
  return rule;
}

/// The nodes of a face, corners first: those whose shape functions do not vanish on it.
std::vector<int> nodes_of_face(const ElementMesh& mesh, std::size_t e, const std::array<int, 4>& corners) {
  const ElementFamily family = family_of(mesh.shape);
  std::vector<int> nodes;
  const auto has = [&](int corner) { return std::find(corners.begin(), corners.end(), corner) != corners.end(); };
  for (const int corner : corners)
    if (corner >= 0) nodes.push_back(mesh.element(e)[at(corner)]);
  if (order_of(mesh.shape) == 1) return nodes;
  const auto edges = edges_of(family);
  for (std::size_t k = 0; k < edges.size(); ++k)
    if (has(edges[k][0]) && has(edges[k][1])) nodes.push_back(mesh.element(e)[at(corner_count(family)) + k]);
  return nodes;
}

}  // namespace

std::vector<std::vector<int>> ElementBody::faces() const {
  std::vector<std::vector<int>> outer;
  const std::vector<element_parts::ElementFace> faces = element_parts::sorted_faces(mesh());
  element_parts::for_each_face(faces, [&](std::span<const element_parts::ElementFace> same) {
    if (same.size() == 1) outer.push_back(element_parts::face_nodes(mesh(), same[0]));
  });
  return outer;
}

std::vector<FacePoint> ElementBody::face_points() const {
  const ElementFamily family = family_of(mesh().shape);
  const std::vector<RulePoint> rule = family == ElementFamily::tetrahedra ? triangle_rule() : quadrilateral_rule();
  const auto reference = reference_corners(family);
  std::vector<FacePoint> points;
  const std::vector<element_parts::ElementFace> faces = element_parts::sorted_faces(mesh());
  element_parts::for_each_face(faces, [&](std::span<const element_parts::ElementFace> same) {
    if (same.size() != 1) return;
    const auto e = at(same[0].element);
    const std::array<int, 4>& corners = faces_of(family)[at(same[0].face)];
    const std::vector<int> nodes = nodes_of_face(mesh(), e, corners);
    for (const RulePoint& place : rule) {
      Vec3d xi, along_s, along_t, ds, dt;
      for (std::size_t k = 0; k < 4; ++k) {
        if (corners[k] < 0) continue;
        xi += reference[at(corners[k])] * place.N[k];
        along_s += reference[at(corners[k])] * place.ds[k];
        along_t += reference[at(corners[k])] * place.dt[k];
      }
      const ShapeGradients slope = shape_gradients(mesh().shape, xi);
      const auto element = mesh().element(e);
      for (std::size_t a = 0; a < element.size(); ++a) {
        ds += mesh().nodes[at(element[a])] * dot(slope[a], along_s);
        dt += mesh().nodes[at(element[a])] * dot(slope[a], along_t);
      }
      const ElementPoint p = shape_at(mesh(), e, xi);
      points.push_back({p.X, norm(cross(ds, dt)) * place.weight, attachment(e, p), nodes});
    }
  });
  return points;
}

}  // namespace fascia
