#include "meshless/cloud_parts.hpp"

#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/triangle_tree.hpp"
#include "meshless/gauss.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace fascia {

namespace {

double triangle_area(const TriangleMesh& mesh, const std::array<int, 3>& t) {
  const Vec3d& a = mesh.points[at(t[0])];
  return 0.5 * norm(cross(mesh.points[at(t[1])] - a, mesh.points[at(t[2])] - a));
}

/// Nearest point of a segment.
Vec3d nearest_on_segment(const Vec3d& x, const Vec3d& a, const Vec3d& b) {
  const Vec3d e = b - a;
  return a + e * std::clamp(dot(x - a, e) / squared_norm(e), 0.0, 1.0);
}

constexpr double kLeaning = 0.2;

/// Where positions lie in parts of matter. Axes are those of the nearest integration point of the same dimension.
class Locator {
 public:
  Locator(const MatterParts& parts, const std::vector<CloudPoint>& points) : parts_(parts) {
    for (const SheetPart& s : parts.sheets) sheets_.emplace_back(s.surface);
    for (const int dimension : {1, 2}) {
      std::vector<Vec3d> x;
      for (const CloudPoint& p : points) {
        if (p.place.dimension != dimension) continue;
        x.push_back(p.place.X);
        thin_[at(dimension)].push_back(p);
      }
      search_.emplace_back(x);
    }
  }

  Location at_position(const Vec3d& X) const {
    const Vec3d x = transpose(parts_.rotation) * (X - parts_.translation);
    Location best;
    best.distance = std::numeric_limits<double>::infinity();
    if (parts_.solid) best = {{X, Mat3d::identity(), 3}, {}, solid_distance(x)};
    Vec3d nearest;
    for (const TriangleTree& sheet : sheets_) {
      sheet.distance(x, &nearest);
      offer(X, nearest, 2, best);
    }
    for (const LinePart& line : parts_.lines)
      for (const auto& s : line.segments)
        offer(X, nearest_on_segment(x, line.points[at(s[0])], line.points[at(s[1])]), 1, best);
    return best;
  }

 private:
  double solid_distance(const Vec3d& x) const {
    const SolidDomain& solid = *parts_.solid;
    if (solid.distance) return solid.distance(x);
    Vec3d outside;
    for (int a = 0; a < 3; ++a) outside[a] = std::max({solid.min[a] - x[a], x[a] - solid.max[a], 0.0});
    return norm(outside);
  }

  /// Takes a point on the middle of thin matter where the position is nearer to that than to the best so far.
  void offer(const Vec3d& X, const Vec3d& local, int dimension, Location& best) const {
    const Vec3d middle = to_world(parts_, local);
    const std::vector<CloudPoint>& points = thin_[at(dimension)];
    if (points.empty()) return;
    const CloudPoint& near = points[at(search_[at(dimension - 1)].nearest(middle, 1)[0])];
    const Mat3d& T = near.place.axes;
    const Vec3d d = transpose(T) * (X - middle);
    const double along = dimension == 2 ? std::hypot(d[0], d[1]) : std::abs(d[0]);
    const double across = dimension == 2 ? std::abs(d[2]) : std::hypot(d[1], d[2]);
    const double reach = dimension == 2 ? 0.5 * near.extent : near.extent;
    // Smooth normals lean a little against those of the facets.
    const double distance = std::hypot(std::max(0.0, along - kLeaning * across), std::max(0.0, across - reach));
    if (distance < best.distance) best = {{middle, T, dimension}, X - middle, distance};
  }

  MatterParts parts_;
  std::vector<TriangleTree> sheets_;
  std::array<std::vector<CloudPoint>, 3> thin_;  ///< by dimension
  std::vector<FrameSearch> search_;              ///< lines, sheets
};

}  // namespace

std::string text(const Vec3d& x) {
  std::ostringstream out;
  out << "(" << x[0] << ", " << x[1] << ", " << x[2] << ")";
  return out.str();
}

Matter matter_for(const MatterParts& parts, double spacing, PieceUse use, ThreadPool& pool) {
  constexpr int kManyFrames = 400'000, kManyPoints = 50'000, kMost = 4'000'000;  // pieces in all
  constexpr double kFine = 6, kFrames = 4, kPoints = 3, kCoarsest = 2.5;         // pieces a spacing
  const double fine = spacing / kFine;
  const auto affordable = [&](double finest) {
    return std::clamp(rough_spacing(parts, kMost), finest, spacing / kCoarsest);
  };
  Matter matter;
  if (parts.solid) {
    // Few samples want to be even. Where a solid is thinner than its pieces, tests of them might miss it.
    const bool frames = use == PieceUse::frames;
    const double wide = std::max(rough_spacing(parts, frames ? kManyFrames : kManyPoints), fine);
    const double finest = std::min(wide, spacing / (frames ? kFrames : kPoints));
    add_solid(matter, *parts.solid, affordable(std::clamp(0.5 * thickness_of(*parts.solid), fine, finest)), use, pool);
  }
  for (const SheetPart& s : parts.sheets) add_sheet(matter, s, affordable(fine));
  for (const LinePart& l : parts.lines) add_line(matter, l, affordable(fine));
  return matter;
}

double rough_spacing(const MatterParts& parts, int count) {
  const double volume = parts.solid ? parts.solid->volume : 0;
  double area = 0, length = 0;
  for (const SheetPart& s : parts.sheets)
    for (const auto& t : s.surface.triangles) area += triangle_area(s.surface, t);
  for (const LinePart& l : parts.lines)
    for (const auto& s : l.segments) length += norm(l.points[at(s[1])] - l.points[at(s[0])]);
  double low = 0, high = size_of(parts);
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    (volume / (s * s * s) + area / (s * s) + length / s > count ? low : high) = s;
  }
  return high;
}

double size_of(const MatterParts& parts) {
  Bounds bounds;
  if (parts.solid) bounds.include({parts.solid->min, parts.solid->max});
  for (const SheetPart& s : parts.sheets) bounds.include(bounds_of(s.surface.points));
  for (const LinePart& l : parts.lines) bounds.include(bounds_of(l.points));
  return bounds.diagonal();
}

double thickness_of(const SolidDomain& solid) {
  double area = 0;
  for (const auto& t : solid.surface.triangles) area += triangle_area(solid.surface, t);
  double thickness = area > 0 ? 4 * solid.volume / area : INFINITY;
  for (int a = 0; a < 3; ++a) thickness = std::min(thickness, solid.max[a] - solid.min[a]);
  return thickness;
}

std::vector<CloudPoint> gauss_cells(const ThinGridSpec& choice, const Mat3d& axes) {
  const ThinGrid& grid = choice.grid;
  const std::size_t directions = grid.edge.size();
  std::array<std::vector<GaussPoint>, 2> rule{gauss_legendre(1), gauss_legendre(1)};
  std::array<int, 2> cells{1, 1};
  for (std::size_t a = 0; a < directions; ++a) {
    cells[a] = grid.count[a] - 1;
    rule[a] = gauss_legendre(!choice.per_cell.empty() ? choice.per_cell[a] : cells[a] == 1 ? 3 : 2);
  }
  const MatterParts& parts = choice.parts;
  double measure = norm(grid.edge[0]);
  if (directions == 2) measure = norm(cross(grid.edge[0], grid.edge[1]));
  std::vector<CloudPoint> points;
  for (int j = 0; j < cells[1]; ++j)
    for (int i = 0; i < cells[0]; ++i)
      for (const GaussPoint& v : rule[1])
        for (const GaussPoint& u : rule[0]) {
          Vec3d x = grid.origin + grid.edge[0] * ((i + u.x) / cells[0]);
          if (directions == 2) x += grid.edge[1] * ((j + v.x) / cells[1]);
          const double extent = choice.extent(to_world(parts, x));
          const double across = directions == 2 ? extent : std::numbers::pi * extent * extent;
          points.push_back({{to_world(parts, x), parts.rotation * axes, static_cast<int>(directions)},
                            measure * u.weight * v.weight / (cells[0] * cells[1]) * across,
                            extent});
        }
  return points;
}

void finish_cloud(const MatterParts& parts, CloudSpec& spec) {
  const auto carry = [&](const std::vector<Vec3d>& points) {
    const int first = static_cast<int>(spec.surface.points.size());
    for (const Vec3d& x : points) spec.surface.points.push_back(to_world(parts, x));
    return first;
  };
  const auto carry_triangles = [&](const TriangleMesh& mesh) {
    const int first = carry(mesh.points);
    for (const auto& t : mesh.triangles) spec.surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  };
  if (parts.solid) carry_triangles(parts.solid->surface);
  for (const SheetPart& s : parts.sheets) carry_triangles(s.surface);
  for (const LinePart& l : parts.lines) {
    const int first = carry(l.points);
    for (const auto& s : l.segments) spec.segments.push_back({s[0] + first, s[1] + first});
  }
  const auto locator = std::make_shared<const Locator>(parts, spec.points);
  spec.locate = [locator](const Vec3d& X) { return locator->at_position(X); };
}

}  // namespace fascia
