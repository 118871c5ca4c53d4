#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "meshless/matter_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace fascia {
namespace {

constexpr double kLongestEdge = 1.2;  // of a part of a triangle, over the piece size

/// Columns t1, t2, n.
Mat3d sheet_axes(const Vec3d& normal) {
  const Mat3d rows = basis_from(normal);
  return Mat3d::from_columns(rows.row(1), rows.row(2), rows.row(0));
}

/// Columns t, s1, s2.
Mat3d line_axes(const Vec3d& tangent) { return transpose(basis_from(tangent)); }

/// The sheet's edges: its chains lie along the open, sharp and branched ones.
void add_sheet_edges(Matter& matter, const SheetPart& sheet, const SurfaceFeatures& features) {
  std::vector<std::array<int, 2>> edges;
  std::vector<EdgeMatter> along;
  for (const SurfaceEdge& e : features.edges) {
    edges.push_back(e.vertices);
    along.push_back({sheet_axes(e.normal), sheet.thickness[at(e.triangle)]});
  }
  add_edges(matter, sheet.surface.points, edges, along, 2);
}

}  // namespace

void cut_triangle(const std::array<Vec3d, 3>& corners, const std::array<Vec3d, 3>& normals, double area, double size,
                  std::vector<TrianglePart>& parts) {
  std::size_t longest = 0;
  double squared = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const double e = squared_norm(corners[(n + 1) % 3] - corners[n]);
    if (e > squared * (1 + 1e-9)) {
      squared = e;
      longest = n;
    }
  }
  if (squared <= kLongestEdge * kLongestEdge * size * size * (1 + 1e-9)) {
    const Vec3d sum = normals[0] + normals[1] + normals[2];
    parts.push_back({(corners[0] + corners[1] + corners[2]) * (1.0 / 3), sum, area});
    return;
  }
  const std::size_t next = (longest + 1) % 3;
  const Vec3d middle = (corners[longest] + corners[next]) * 0.5;
  const Vec3d normal = (normals[longest] + normals[next]) * 0.5;
  for (const std::size_t replaced : {longest, next}) {
    std::array<Vec3d, 3> x = corners, n = normals;
    x[replaced] = middle;
    n[replaced] = normal;
    cut_triangle(x, n, area / 2, size, parts);
  }
}

double expected_parts(const TriangleMesh& surface, double size) {
  const double widest = kLongestEdge * size;
  double count = 0;
  for (const auto& t : surface.triangles) {
    const Vec3d &a = surface.points[at(t[0])], &b = surface.points[at(t[1])], &c = surface.points[at(t[2])];
    const double longest = std::sqrt(std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)}));
    const double area = 0.5 * norm(cross(b - a, c - a));
    count += 1 + 2 * longest / widest + 8 * area / (widest * widest);
  }
  return count;
}

void add_sheet(Matter& matter, const SheetPart& sheet, double piece_size) {
  const TriangleMesh& surface = sheet.surface;
  assert(sheet.thickness.size() == surface.triangles.size());
  check_pieces(matter, piece_size, expected_parts(surface, piece_size));
  const SurfaceFeatures features = find_features(surface);
  add_sheet_edges(matter, sheet, features);

  std::vector<Vec3d> vertex_normal(surface.points.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const int v : surface.triangles[t]) vertex_normal[at(v)] += features.triangle_normal[t];

  std::vector<TrianglePart> parts;
  double volume = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const double twice_area = norm(features.triangle_normal[t]);
    if (!(twice_area > 0)) continue;
    const Vec3d flat = features.triangle_normal[t] * (1 / twice_area);
    std::array<Vec3d, 3> corners, normals;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::size_t v = at(surface.triangles[t][n]);
      corners[n] = surface.points[v];
      const double length = norm(vertex_normal[v]);
      normals[n] = features.smooth[v] != 0 && length > 0 ? vertex_normal[v] * (1 / length) : flat;
    }
    parts.clear();
    cut_triangle(corners, normals, 0.5 * twice_area, piece_size, parts);
    for (const TrianglePart& p : parts) {
      // Opposite normals at the corners of a fold would leave no direction.
      const Vec3d normal = dot(p.normal, flat) > 0.3 ? p.normal : flat;
      matter.pieces.push_back({p.x, p.area * sheet.thickness[t], p.area, 2, 2, sheet_axes(normal), sheet.thickness[t]});
      if (matter.pieces.back().volume > 0) matter.measure[2] += p.area;
    }
    volume += 0.5 * twice_area * sheet.thickness[t];
  }
  if (!(volume > 0)) throw InputError("the sheet has no volume; it needs triangles with an area and a thickness");
  matter.volume += volume;
  matter.piece_size = std::max(matter.piece_size, piece_size);
}

void add_line(Matter& matter, const LinePart& line, double piece_size) {
  std::vector<std::array<int, 2>> edges;
  std::vector<EdgeMatter> along;
  double length = 0;
  for (const auto& s : line.segments) {
    const Vec3d step = line.points[at(s[1])] - line.points[at(s[0])];
    if (!(squared_norm(step) > 0)) continue;
    edges.push_back(s);
    along.push_back({line_axes(step), line.radius});
    length += norm(step);
  }
  check_pieces(matter, piece_size, length / piece_size + static_cast<double>(edges.size()));
  const double section = std::numbers::pi * line.radius * line.radius;
  if (!(length * section > 0)) throw InputError("the line has no volume; it needs segments with a length and a radius");
  add_edges(matter, line.points, edges, along, 1);

  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Vec3d from = line.points[at(edges[e][0])], step = line.points[at(edges[e][1])] - from;
    const int count = std::max(1, static_cast<int>(std::ceil(norm(step) / piece_size * (1 - 1e-9))));
    const double part = norm(step) / count;
    for (int k = 0; k < count; ++k) {
      matter.pieces.push_back(
          {from + step * ((k + 0.5) / count), part * section, part, 1, 1, along[e].axes, line.radius});
      matter.measure[1] += part;
    }
  }
  matter.volume += length * section;
  matter.piece_size = std::max(matter.piece_size, piece_size);
}

}  // namespace fascia
