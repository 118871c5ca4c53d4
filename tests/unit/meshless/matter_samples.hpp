#pragma once

#include "core/base/index.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/primitives.hpp"
#include "meshless/matter.hpp"
#include "meshless/scattered/scatter.hpp"

#include <memory>
#include <numbers>

namespace fascia::test {

inline SolidDomain box_domain(const Vec3d& min, const Vec3d& max) {
  SolidDomain d;
  d.min = min;
  d.max = max;
  d.volume = (max[0] - min[0]) * (max[1] - min[1]) * (max[2] - min[2]);
  d.surface = box_surface(min, max, 1, 1, 1);
  return d;
}

/// An ellipsoid around the origin, faceted, with the exact volume.
inline SolidDomain ellipsoid_domain(const Vec3d& radii, int n) {
  SolidDomain d;
  d.min = -radii;
  d.max = radii;
  d.volume = 4.0 / 3 * std::numbers::pi * radii[0] * radii[1] * radii[2];
  d.surface = ellipsoid_surface({}, radii, n);
  d.contains = [test = std::make_shared<InsideTest>(d.surface)](const Vec3d& x) { return test->contains(x); };
  return d;
}

inline SheetPart sheet_of(const TriangleMesh& surface, double thickness) {
  return {surface, std::vector<double>(surface.triangles.size(), thickness)};
}

/// A rectangle of two triangles.
inline SheetPart rectangle(const Vec3d& origin, const Vec3d& u, const Vec3d& v, double thickness) {
  return sheet_of({{origin, origin + u, origin + u + v, origin + v}, {{0, 1, 2}, {0, 2, 3}}}, thickness);
}

/// Two flanges of 2 × 3 and 1 × 3 that meet at a right angle along y, the second of twice the thickness.
inline SheetPart angle_sheet() {
  SheetPart s;
  s.surface.points = {{{2, 0, 0}}, {{2, 3, 0}}, {{0, 3, 0}}, {{0, 0, 0}}, {{0, 3, 1}}, {{0, 0, 1}}};
  s.surface.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {3, 4, 5}};
  s.thickness = {0.1, 0.1, 0.2, 0.2};
  return s;
}

inline LinePart polyline(std::vector<Vec3d> points, double radius) {
  LinePart line;
  line.points = std::move(points);
  line.radius = radius;
  for (int i = 0; i + 1 < static_cast<int>(line.points.size()); ++i) line.segments.push_back({i, i + 1});
  return line;
}

inline ThreadPool& one_thread() {
  static ThreadPool pool(1);
  return pool;
}

inline void add_solid(Matter& matter, const SolidDomain& domain, double piece_size, PieceUse use = PieceUse::frames) {
  fascia::add_solid(matter, domain, piece_size, use, one_thread());
}

inline std::vector<SamplePlace> poisson_disk(const Matter& matter, double spacing, int seed, bool with_features) {
  return fascia::poisson_disk(matter, spacing, seed, with_features, one_thread());
}
inline std::vector<Share> voronoi_shares(const Matter& matter, const std::vector<SamplePlace>& samples) {
  return fascia::voronoi_shares(matter, samples, one_thread());
}
inline double volume_of(const std::vector<Share>& shares) {
  double sum = 0;
  for (const Share& s : shares) sum += s.volume;
  return sum;
}

inline Matter cube(double size, double piece) {
  Matter m;
  add_solid(m, box_domain({{0, 0, 0}}, {{size, size, size}}), piece);
  return m;
}

inline double volume_sum(const Matter& matter) {
  double sum = 0;
  for (const MatterPiece& p : matter.pieces) sum += p.volume;
  for (const double v : matter.voxels.volume) sum += v;
  return sum;
}

inline int count_feature(const Matter& matter, int feature) {
  int count = feature == 3 ? static_cast<int>(matter.voxels.size()) : 0;
  for (const MatterPiece& p : matter.pieces) count += p.feature == feature ? 1 : 0;
  return count;
}

}  // namespace fascia::test
