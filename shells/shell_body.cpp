#include "shells/shell_body.hpp"

#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/space_order.hpp"
#include "core/math/rotation.hpp"
#include "shells/surface_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace fascia {

namespace {

/// Second moment, in the plane, of a corner's mass over m A: about half of what its third of the triangle has. Less
/// would leave the drilling rotation to limit explicit steps, more would slow the lowest frequencies (by order h²
/// either way).
constexpr double kDrillingInertia = 1.0 / 12;

/// Cosine of the angle between triangles beyond which an edge is a crease.
constexpr double kCrease = 0.5;

}  // namespace

ShellBody::ShellBody(ShellBodySpec spec, Model& model, PointSetBuilder& points)
    : mesh_(std::move(spec.mesh)),
      thickness_(std::move(spec.thickness)),
      material_(std::move(spec.material)),
      tree_({mesh_.nodes, mesh_.triangles}) {
  messages_ = mesh_.messages;
  for (const auto& t : mesh_.triangles) {
    const Vec3d &a = mesh_.nodes[at(t[0])], &b = mesh_.nodes[at(t[1])], &c = mesh_.nodes[at(t[2])];
    const Vec3d normal = cross(b - a, c - a), n = normalized(normal), e = normalized(b - a);
    triangle_axes_.push_back(Mat3d::from_columns(e, cross(n, e), n));
    area_.push_back(0.5 * norm(normal));
  }
  around_.resize(mesh_.nodes.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& nodes = mesh_.triangles[t];
      around_[at(nodes[k])].push_back(static_cast<int>(angle_.size()));
      const Vec3d &o = mesh_.nodes[at(nodes[k])], u = mesh_.nodes[at(nodes[(k + 1) % 3])] - o,
                  v = mesh_.nodes[at(nodes[(k + 2) % 3])] - o;
      angle_.push_back(std::atan2(norm(cross(u, v)), dot(u, v)));
    }
  number_nodes(model);
  add_triangles(spec, points);
  add_mass(spec.density, model);
  describe();
  around_ = {};
  angle_ = {};
}

PlaneTriangle ShellBody::corners(std::size_t t) const {
  PlaneTriangle p{};
  const Vec3d& origin = mesh_.nodes[at(mesh_.triangles[t][0])];
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3d d = mesh_.nodes[at(mesh_.triangles[t][a])] - origin;
    p[a] = {dot(d, triangle_axes_[t].column(0)), dot(d, triangle_axes_[t].column(1))};
  }
  return p;
}

ShellSection ShellBody::section(std::size_t t) const {
  return {material_[t].young(), material_[t].poisson(), thickness_[t]};
}

void ShellBody::number_nodes(Model& model) {
  first_node_ = model.node_count();
  node_count_ = static_cast<int>(mesh_.nodes.size());
  std::vector<Vec3d> normal(mesh_.nodes.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const int node : mesh_.triangles[t]) normal[at(node)] += triangle_axes_[t].column(2) * area_[t];
  for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
    const bool defined = squared_norm(normal[i]) > 0;  // a fold may leave none
    const Mat3d rows = basis_from(defined ? normal[i] : Vec3d{{0, 0, 1}});
    model.rest_position.push_back(mesh_.nodes[i]);
    model.rest_orientation.push_back(Mat3d::from_columns(rows.row(1), rows.row(2), rows.row(0)));
    model.frame_kind.push_back(FrameKind::rigid);
  }
  surface_ = {mesh_.nodes, mesh_.triangles};
  size_ = bounds_of(mesh_.nodes).diagonal();
  groups_ = mesh_.groups;
  cells_.type = CellType::triangle;
  cells_.nodes_per_cell = 3;
  for (const auto& t : mesh_.triangles) cells_.nodes.insert(cells_.nodes.end(), t.begin(), t.end());
}

/// Mean square angle to the smooth surface's normals at the corners: the means over the triangles there, but not across
/// creases.
double ShellBody::tilt(std::size_t t) const {
  constexpr std::size_t kMost = 64;  // of more triangles around a node, every so many
  const Vec3d own = triangle_axes_[t].column(2);
  double squares = 0;
  for (const int node : mesh_.triangles[t]) {
    const std::vector<int>& corners = around_[at(node)];
    Vec3d sum = own * 1e-6;
    for (std::size_t k = 0; k < corners.size(); k += corners.size() / kMost + 1) {
      const Vec3d n = triangle_axes_[at(corners[k] / 3)].column(2);
      if (dot(n, own) > kCrease) sum += n * angle_[at(corners[k])];
    }
    squares += squared_norm(normalized(sum) - own) / 3;
  }
  return squares;
}

void ShellBody::add_triangles(const ShellBodySpec& spec, PointSetBuilder& builder) {
  std::vector<ShellElementSpec> elements;
  double edges = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const PlaneTriangle p = corners(t);
    ShellSection s = section(t);
    s.tilt = tilt(t);
    ShellElementSpec e;
    for (std::size_t a = 0; a < 3; ++a) {
      e.node[a] = first_node_ + mesh_.triangles[t][a];
      edges += norm(mesh_.nodes[at(mesh_.triangles[t][a])] - mesh_.nodes[at(mesh_.triangles[t][(a + 1) % 3])]);
    }
    e.axes = triangle_axes_[t];
    e.constants = spec.stiffness(p, s);
    e.stiffness_damping = material_[t].stiffness_damping;
    e.viscosity = material_[t].viscosity;
    e.source = static_cast<int>(t);
    elements.push_back(e);
    BodyPoint point;
    for (const int node : mesh_.triangles[t]) point.X += mesh_.nodes[at(node)] * (1.0 / 3);
    point.middle = point.X;
    point.volume = area_[t] * thickness_[t];
    static_cast<LawConstants&>(point) = material_[t];
    point.law = Law::sheet;
    point.cell = static_cast<int>(t);
    points_.push_back(point);
    volume_ += point.volume;
  }
  mass_ = volume_ * spec.density;
  std::vector<Vec3d> middles;
  for (const BodyPoint& p : points_) middles.push_back(p.middle);
  std::vector<ShellElementSpec> ordered;
  for (const std::size_t t : order_in_space(middles)) ordered.push_back(elements[t]);
  builder.add_shell(make_shell_block(ordered, edges / (3.0 * static_cast<double>(mesh_.triangles.size()))));
}

void ShellBody::add_mass(double density, Model& model) {
  model.inertia.resize(model.rest_position.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const Vec3d n = triangle_axes_[t].column(2);
    const double m = density * area_[t] * thickness_[t] / 3;
    const double fibre = thickness_[t] * thickness_[t] / 12, disc = kDrillingInertia * area_[t];
    const FrameInertia inertia{m, {}, outer(n, n) * (m * (fibre - disc)) + Mat3d::diagonal(m * disc)};
    for (const int node : mesh_.triangles[t]) {
      const auto i = at(first_node_ + node);
      model.inertia[i] += inertia;
      const double damping = material_[t].mass_damping;
      if (damping <= 0) continue;
      model.mass_damping.resize(model.rest_position.size());
      model.mass_damping[i] += {inertia.mass * damping, {}, inertia.second * damping};
    }
  }
  if (!model.mass_damping.empty()) model.mass_damping.resize(model.rest_position.size());
}

void ShellBody::describe() {
  double thin = 0, thick = 0;
  for (std::size_t t = 0; t < thickness_.size(); ++t) {
    const double ratio = thickness_[t] / std::sqrt(area_[t]);
    thin = t == 0 ? ratio : std::min(thin, ratio);
    thick = std::max(thick, ratio);
  }
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "; thickness %.3g to %.3g of a triangle's size", thin, thick);
  quality_ = shell_quality(mesh_).sentence + text.data();
}

Attachment ShellBody::attachment(std::size_t t, const std::array<double, 3>& L, double offset) const {
  const Mat3d& axes = triangle_axes_[t];
  const LinearGradients linear = linear_gradients(corners(t));
  const Vec3d n = axes.column(2);
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return mesh_.triangles[t][a] < mesh_.triangles[t][b]; });
  Attachment a;
  a.cell = static_cast<int>(t);
  for (const std::size_t k : order) {
    const Vec3d g = axes.column(0) * linear.g[k][0] + axes.column(1) * linear.g[k][1];
    a.nodes.push_back(first_node_ + mesh_.triangles[t][k]);
    a.influences.push_back({L[k], g, n * (L[k] * offset), outer(n, n * L[k] + g * offset)});
  }
  return a;
}

Attachment ShellBody::attach(const Vec3d& X) const {
  Vec3d foot;
  int t = 0;
  tree_.distance(X, &foot, &t);
  const Mat3d& axes = triangle_axes_[at(t)];
  const Vec3d d = foot - mesh_.nodes[at(mesh_.triangles[at(t)][0])];
  const LinearGradients linear = linear_gradients(corners(at(t)));
  std::array<double, 3> L{1, 0, 0};
  for (std::size_t a = 0; a < 3; ++a)
    L[a] += linear.g[a][0] * dot(d, axes.column(0)) + linear.g[a][1] * dot(d, axes.column(1));
  const double half = 0.5 * thickness_[at(t)], offset = std::clamp(dot(X - foot, axes.column(2)), -half, half);
  return attachment(at(t), L, std::abs(offset) > 1e-9 * size_ ? offset : 0.0);
}

Attachment ShellBody::attach_point(std::size_t point) const {
  return attachment(point, {1.0 / 3, 1.0 / 3, 1.0 / 3}, 0);
}

Attachment ShellBody::attach_surface(std::size_t point) const {
  Attachment a;
  a.nodes = {first_node_ + static_cast<int>(point)};
  a.influences.resize(1);
  a.influences[0].w = 1;
  return a;
}

std::vector<FacePoint> ShellBody::face_points() const {
  std::vector<FacePoint> points;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto& nodes = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> L{1.0 / 6, 1.0 / 6, 1.0 / 6};
      L[k] = 2.0 / 3;
      Vec3d X;
      for (std::size_t a = 0; a < 3; ++a) X += mesh_.nodes[at(nodes[a])] * L[a];
      points.push_back({X, area_[t] / 3, attachment(t, L, 0), {nodes[0], nodes[1], nodes[2]}});
    }
  }
  return points;
}

std::vector<char> ShellBody::nodes_on_boundary() const {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : mesh_.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  std::vector<char> rim(mesh_.nodes.size(), 0);
  for (const auto& [edge, count] : edges)
    if (count == 1) rim[at(edge.first)] = rim[at(edge.second)] = 1;
  return rim;
}

double ShellBody::distance(const Vec3d& X) const {
  int t = 0;
  const double d = tree_.distance(X, nullptr, &t);
  return std::max(0.0, d - 0.5 * thickness_[at(t)]);
}

}  // namespace fascia
