#include "app/compare/cloud_field.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia::app {
namespace {

/// Volume that a surface encloses [m³]; 0 where it does not close.
double enclosed_volume(const TriangleMesh& surface) {
  std::map<std::pair<int, int>, int> edges;  // how often forward more than backward
  double volume = 0;
  if (surface.triangles.empty()) return 0;
  const Vec3d origin = surface.points[at(surface.triangles.front()[0])];
  for (const auto& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = t[k], to = t[(k + 1) % 3];
      edges[std::minmax(from, to)] += from < to ? 1 : -1;
    }
    const auto corner = [&](std::size_t k) { return surface.points[at(t[k])] - origin; };
    volume += dot(corner(0), cross(corner(1), corner(2))) / 6;
  }
  const bool closed = std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; });
  return closed ? volume : 0;
}

/// Points of the surface and integration points, ascending.
std::vector<int> points_with_values(const TriangleMesh& surface, std::vector<int> points) {
  for (const auto& t : surface.triangles) points.insert(points.end(), t.begin(), t.end());
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::vector<Vec3d> places_of(const TriangleMesh& surface, const std::vector<int>& points) {
  std::vector<Vec3d> places;
  places.reserve(points.size());
  for (const int p : points) places.push_back(surface.points[at(p)]);
  return places;
}

}  // namespace

std::vector<int> integration_points(const io::VisualMesh& mesh) {
  constexpr int kPart = 2;  // of the .vtu's array "part"
  std::vector<int> points;
  const std::size_t first = mesh.triangles.size() + mesh.lines.size();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (first + v < mesh.part.size() && mesh.part[first + v] == kPart) points.push_back(mesh.vertices[v]);
  return points;
}

CloudField::CloudField(TriangleMesh surface, std::size_t flat, std::vector<int> integration_points, double volume)
    : RestField(surface.points),
      surface_(std::move(surface)),
      flat_(flat),
      points_(points_with_values(surface_, integration_points)),
      integration_points_(std::move(integration_points)),
      fit_(places_of(surface_, points_)),
      tree_(surface_) {
  // Frames of a grid may lie beside the body.
  size_ = bounds_of(fit_.places()).diagonal();
  // The matter of a closed sheet is a small part of what it encloses, that of a solid all of it.
  const double enclosed = flat_ == surface_.triangles.size() ? enclosed_volume(surface_) : 0;
  if (enclosed > 0 && (volume <= 0 || volume > 0.5 * enclosed)) solid_.emplace(surface_);
}

int CloudField::dimension() const {
  if (solid_) return 3;
  return flat_ > 0 ? 2 : surface_.triangles.empty() ? 0 : 1;
}

Stencil CloudField::fitted(const Vec3d& X, int except) const {
  Stencil s;
  for (const auto& [place, weight] : fit_.shares_at(X, except)) s.add(points_[at(place)], weight);
  return s;
}

Stencil CloudField::stencil_at(const Vec3d& X) const {
  if (solid_ && solid_->contains(X)) return fitted(X);
  Vec3d nearest = X;
  double distance = 0;
  if (surface_.triangles.empty()) {
    const Vec3d& place = fit_.places()[at(fit_.shares_at(X).front().first)];
    distance = norm(place - X);
  } else {
    distance = tree_.distance(X, &nearest);
  }
  Stencil s = fitted(nearest);
  s.distance = distance;
  return s;
}

std::vector<Sample> CloudField::solid_samples() const {
  constexpr int kLeast = 2;  // cells along an axis
  const double cells = std::clamp(static_cast<double>(points_.size()) / 2, 250.0, 5000.0);
  const Bounds box = bounds_of(fit_.places());
  const Vec3d extent = box.extent();
  const double side = std::cbrt(extent[0] * extent[1] * extent[2] / cells);
  std::array<int, 3> count{};
  Vec3d step;
  for (int c = 0; c < 3; ++c) {
    count[at(c)] = std::max(kLeast, static_cast<int>(std::lround(extent[c] / side)));
    step[c] = extent[c] / count[at(c)];
  }
  const double gauss = 0.5 / std::sqrt(3.0);  // of a cell's side, from its middle
  // Two Gauss points a cell and axis; each stands for an eighth of the cell.
  const auto coordinate = [&](int axis, int i) {
    const int cell = i / 2;
    return box.low[axis] + step[axis] * (cell + 0.5 + (i % 2 == 0 ? -gauss : gauss));
  };
  std::vector<Sample> all;
  for (int i = 0; i < 2 * count[0]; ++i)
    for (int j = 0; j < 2 * count[1]; ++j)
      for (int k = 0; k < 2 * count[2]; ++k) {
        const Vec3d X{{coordinate(0, i), coordinate(1, j), coordinate(2, k)}};
        if (solid_->contains(X)) all.push_back({X, step[0] * step[1] * step[2] / 8, fitted(X)});
      }
  return all;
}

std::vector<Sample> CloudField::samples() const {
  std::vector<Sample> all = solid_ ? solid_samples() : surface_samples(surface_, flat_);
  if (!solid_)
    for (Sample& s : all) s.stencil = fitted(s.X);
  const double of_points = all.empty() ? 1 : 0;
  for (std::size_t p = 0; p < points_.size(); ++p) all.push_back({fit_.places()[p], of_points, {{points_[p]}, {1}}});
  return all;
}

std::vector<Stencil> CloudField::checks() const {
  constexpr std::size_t kMost = 200;
  const std::size_t step = std::max<std::size_t>(1, integration_points_.size() / kMost);
  std::vector<Stencil> all;
  for (std::size_t i = 0; i < integration_points_.size(); i += step) {
    const int point = integration_points_[i];
    const auto place = std::lower_bound(points_.begin(), points_.end(), point) - points_.begin();
    all.push_back(fitted(rest_[at(point)], static_cast<int>(place)));
    all.back().add(point, -1);
  }
  return all;
}

}  // namespace fascia::app
