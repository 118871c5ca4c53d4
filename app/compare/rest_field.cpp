#include "app/compare/rest_field.hpp"

#include "app/compare/cloud_field.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "fem/locator.hpp"
#include "fem/quadrature.hpp"

#include <algorithm>

namespace fascia::app {
namespace {

/// The triangles of a surface mesh and of its lines, those as triangles without area.
TriangleMesh triangles_of(const io::VisualMesh& mesh, std::vector<Vec3d> rest) {
  TriangleMesh surface{std::move(rest), mesh.triangles};
  for (const auto& line : mesh.lines) surface.triangles.push_back({line[0], line[1], line[1]});
  return surface;
}

const io::FieldArray* find_field(const io::VisualMesh& mesh, const char* name) {
  const auto found = std::find_if(mesh.point_fields.begin(), mesh.point_fields.end(),
                                  [&](const io::FieldArray& f) { return f.name == name && f.components == 3; });
  return found == mesh.point_fields.end() ? nullptr : &*found;
}

ElementShape shape_of(const io::VisualCells& cells) {
  const bool tetrahedra = cells.type == CellType::tetrahedron;
  return element_shape(tetrahedra ? ElementFamily::tetrahedra : ElementFamily::hexahedra, cells.quadratic ? 2 : 1);
}

class ElementField final : public RestField {
 public:
  ElementField(const io::VisualMesh& mesh, const std::vector<Vec3d>& rest)
      : RestField(rest), locator_(elements_of(mesh, rest)) {}

  int dimension() const override { return 3; }
  std::size_t resolution() const override { return mesh().size(); }

  Stencil stencil_at(const Vec3d& X) const override {
    const Located place = locator_.locate(X);
    return stencil(static_cast<std::size_t>(place.element), shape_values(mesh().shape, place.xi), place.distance);
  }

  /// A linear field's square is integrated exactly.
  std::vector<Sample> samples() const override {
    const ElementShape shape = mesh().shape == ElementShape::tet4 ? ElementShape::tet10 : mesh().shape;
    std::vector<Sample> all;
    for (std::size_t e = 0; e < mesh().size(); ++e)
      for (const QuadraturePoint& q : quadrature(shape)) {
        const ElementPoint p = shape_at(mesh(), e, q.xi);
        all.push_back({p.X, q.weight * p.det_J, stencil(e, p.N, 0)});
      }
    std::vector<int> nodes = mesh().element_nodes;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const int node : nodes) all.push_back({rest_[at(node)], 0, {{node}, {1}}});
    return all;
  }

 private:
  const ElementMesh& mesh() const { return locator_.mesh(); }

  static ElementMesh elements_of(const io::VisualMesh& mesh, const std::vector<Vec3d>& rest) {
    ElementMesh elements;
    elements.shape = shape_of(mesh.volumes.front());
    elements.nodes = rest;
    elements.element_nodes = mesh.volumes.front().nodes;
    return elements;
  }

  Stencil stencil(std::size_t element, const ShapeValues& N, double distance) const {
    Stencil s;
    const auto nodes = mesh().element(element);
    for (std::size_t k = 0; k < nodes.size(); ++k) s.add(nodes[k], N[k]);
    s.distance = distance;
    return s;
  }

  ElementLocator locator_;
};

class SurfaceField final : public RestField {
 public:
  SurfaceField(const io::VisualMesh& mesh, const std::vector<Vec3d>& rest)
      : RestField(rest), surface_(triangles_of(mesh, rest)), tree_(surface_), flat_(mesh.triangles.size()) {}

  int dimension() const override { return flat_ > 0 ? 2 : 1; }
  std::size_t resolution() const override { return surface_.triangles.size(); }

  Stencil stencil_at(const Vec3d& X) const override {
    Vec3d nearest;
    int triangle = 0;
    const double distance = tree_.distance(X, &nearest, &triangle);
    const auto& [i, j, k] = surface_.triangles[at(triangle)];
    const Vec3d a = rest_[at(i)], ab = rest_[at(j)] - a, ac = rest_[at(k)] - a, d = nearest - a;
    Stencil s;
    if (at(triangle) >= flat_) {
      const double along = dot(d, ab) / squared_norm(ab);
      s.add(i, 1 - along);
      s.add(j, along);
    } else {
      const Vec3d normal = cross(ab, ac);
      const double area2 = squared_norm(normal);
      const double v = dot(cross(d, ac), normal) / area2, w = dot(cross(ab, d), normal) / area2;
      s.add(i, 1 - v - w);
      s.add(j, v);
      s.add(k, w);
    }
    s.distance = distance;
    return s;
  }

  std::vector<Sample> samples() const override {
    std::vector<Sample> all = surface_samples(surface_, flat_);
    std::vector<char> used(rest_.size());
    for (const auto& triangle : surface_.triangles)
      for (const int node : triangle) used[at(node)] = 1;
    for (std::size_t p = 0; p < rest_.size(); ++p)
      if (used[p] != 0) all.push_back({rest_[p], 0, {{static_cast<int>(p)}, {1}}});
    return all;
  }

 private:
  TriangleMesh surface_;
  TriangleTree tree_;
  std::size_t flat_;  ///< of the triangles; lines follow
};

}  // namespace

RestField::RestField(const std::vector<Vec3d>& rest) : rest_(rest), size_(bounds_of(rest).diagonal()) {}

std::vector<Vec3d> rest_positions(const io::VisualMesh& mesh) {
  std::vector<Vec3d> rest = mesh.points;
  const io::FieldArray* given = find_field(mesh, "rest_position");
  const io::FieldArray* moved = find_field(mesh, "displacement");
  if (given == nullptr && moved == nullptr)
    throw InputError("holds neither \"rest_position\" nor \"displacement\"; is it a result of this program?");
  for (std::size_t p = 0; p < rest.size(); ++p)
    for (int c = 0; c < 3; ++c) {
      const std::size_t i = 3 * p + at(c);
      rest[p][c] = given != nullptr ? given->values[i] : rest[p][c] - moved->values[i];
    }
  return rest;
}

std::vector<Sample> surface_samples(const TriangleMesh& surface, std::size_t flat) {
  constexpr double a = 2.0 / 3, b = 1.0 / 6;  // of a triangle; exact for degree 2
  constexpr double g = 0.21132486540518712;   // (1 − 1/√3)/2 of a line; exact for degree 3
  std::vector<Sample> all;
  const auto add = [&](const std::array<int, 3>& nodes, const std::array<double, 3>& weights, double measure) {
    Sample& s = all.emplace_back();
    s.weight = measure;
    for (std::size_t n = 0; n < 3; ++n) {
      s.X += weights[n] * surface.points[at(nodes[n])];
      s.stencil.add(nodes[n], weights[n]);
    }
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& nodes = surface.triangles[t];
    const Vec3d ab = surface.points[at(nodes[1])] - surface.points[at(nodes[0])];
    const Vec3d ac = surface.points[at(nodes[2])] - surface.points[at(nodes[0])];
    if (t < flat)
      for (const std::array<double, 3>& w : {std::array{a, b, b}, std::array{b, a, b}, std::array{b, b, a}})
        add(nodes, w, norm(cross(ab, ac)) / 6);
    else
      for (const double w : {g, 1 - g}) add(nodes, {w, 1 - w, 0}, norm(ab) / 2);
  }
  return all;
}

std::unique_ptr<RestField> rest_field(const io::VisualMesh& mesh, double volume) {
  const std::vector<Vec3d> rest = rest_positions(mesh);
  if (!mesh.volumes.empty()) return std::make_unique<ElementField>(mesh, rest);
  std::vector<int> points = integration_points(mesh);
  if (points.empty() && !(mesh.triangles.empty() && mesh.lines.empty()))
    return std::make_unique<SurfaceField>(mesh, rest);
  if (points.empty()) throw InputError("holds no cells and no points of a body");
  return std::make_unique<CloudField>(triangles_of(mesh, rest), mesh.triangles.size(), std::move(points), volume);
}

}  // namespace fascia::app
