#include "coupling/surface_body.hpp"

#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"

#include <algorithm>
#include <map>

namespace fascia {

SurfaceBody::SurfaceBody(TriangleMesh surface, Model& model) : tree_(surface) {
  first_node_ = model.node_count();
  node_count_ = static_cast<int>(surface.points.size());
  surface_ = std::move(surface);
  size_ = bounds_of(surface_.points).diagonal();
  model.rest_position.insert(model.rest_position.end(), surface_.points.begin(), surface_.points.end());
  const std::size_t nodes = model.rest_position.size();
  model.rest_orientation.resize(nodes, Mat3d::identity());
  model.frame_kind.resize(nodes, FrameKind::vertex);
  model.inertia.resize(nodes);
  if (!model.mass_damping.empty()) model.mass_damping.resize(nodes);
  cells_.type = CellType::triangle;
  cells_.nodes_per_cell = 3;
  for (const auto& t : surface_.triangles) cells_.nodes.insert(cells_.nodes.end(), t.begin(), t.end());
}

/// Linear in the triangle, constant across it; of a triangle without area its nearest corner.
Attachment SurfaceBody::attachment(std::size_t triangle, const Vec3d& foot) const {
  std::array<int, 3> nodes = surface_.triangles[triangle];
  std::sort(nodes.begin(), nodes.end());
  std::array<Vec3d, 3> X;
  for (std::size_t k = 0; k < 3; ++k) X[k] = surface_.points[at(nodes[k])];
  const Vec3d normal = cross(X[1] - X[0], X[2] - X[0]);
  const double squares = squared_norm(normal);
  Attachment a;
  a.cell = static_cast<int>(triangle);
  a.nodes = {first_node_ + nodes[0], first_node_ + nodes[1], first_node_ + nodes[2]};
  a.influences.resize(3);
  if (!(squares > 0)) {
    const auto nearest = std::min_element(X.begin(), X.end(), [&](const Vec3d& p, const Vec3d& q) {
      return squared_norm(p - foot) < squared_norm(q - foot);
    });
    a.influences[static_cast<std::size_t>(nearest - X.begin())].w = 1;
    return a;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &p = X[(k + 1) % 3], &q = X[(k + 2) % 3];
    a.influences[k].g = cross(normal, q - p) * (1 / squares);
    a.influences[k].w = dot(a.influences[k].g, foot - p);
  }
  return a;
}

Attachment SurfaceBody::attach(const Vec3d& X) const {
  Vec3d foot;
  int triangle = 0;
  tree_.distance(X, &foot, &triangle);
  return attachment(at(triangle), foot);
}

Attachment SurfaceBody::attach_surface(std::size_t point) const {
  Attachment a;
  a.nodes = {first_node_ + static_cast<int>(point)};
  a.influences.resize(1);
  a.influences[0].w = 1;
  return a;
}

std::vector<char> SurfaceBody::nodes_on_boundary() const {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : surface_.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  std::vector<char> rim(surface_.points.size(), 0);
  for (const auto& [edge, count] : edges)
    if (count == 1) rim[at(edge.first)] = rim[at(edge.second)] = 1;
  return rim;
}

double SurfaceBody::distance(const Vec3d& X) const { return tree_.distance(X); }

}  // namespace fascia
