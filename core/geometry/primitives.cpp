#include "core/geometry/primitives.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <numbers>

namespace fascia {
namespace {

using LatticePoint = std::array<int, 3>;

/// A mesh whose points are named by integers, so that faces that meet share them.
template <class Place>
class LatticeMesh {
 public:
  explicit LatticeMesh(Place place) : place_(place) {}

  int point(const LatticePoint& p) {
    const auto [entry, fresh] = number_.try_emplace(p, static_cast<int>(mesh_.points.size()));
    if (fresh) mesh_.points.push_back(place_(p));
    return entry->second;
  }
  void add(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
    const int i = point(a), j = point(b), k = point(c);
    mesh_.triangles.push_back({i, j, k});
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  Place place_;
  std::map<LatticePoint, int> number_;
  TriangleMesh mesh_;
};

/// A vector normal to unit vector n, of length one.
Vec3d any_normal_to(const Vec3d& n) {
  const Vec3d other = std::abs(n[0]) < 0.6 ? Vec3d{{1, 0, 0}} : Vec3d{{0, 1, 0}};
  return normalized(cross(n, other));
}

}  // namespace

TriangleMesh box_surface(const Vec3d& min, const Vec3d& max, int nx, int ny, int nz) {
  const LatticePoint counts{nx, ny, nz};
  assert(nx >= 1 && ny >= 1 && nz >= 1);
  LatticeMesh mesh([&](const LatticePoint& p) {
    Vec3d x;
    for (int c = 0; c < 3; ++c) {
      const int i = p[static_cast<std::size_t>(c)], n = counts[static_cast<std::size_t>(c)];
      x[c] = i == n ? max[c] : min[c] + (max[c] - min[c]) * i / n;
    }
    return x;
  });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool upper : {false, true})
      for (int i = 0; i < counts[u]; ++i)
        for (int j = 0; j < counts[v]; ++j) {
          const auto at = [&](int di, int dj) {
            LatticePoint p{};
            p[axis] = upper ? counts[axis] : 0;
            p[u] = i + di;
            p[v] = j + dj;
            return p;
          };
          // u × v points along the axis: right-handed on the upper face.
          const LatticePoint b = upper ? at(1, 0) : at(0, 1), d = upper ? at(0, 1) : at(1, 0);
          mesh.add(at(0, 0), b, at(1, 1));
          mesh.add(at(0, 0), at(1, 1), d);
        }
  }
  return mesh.take();
}

TriangleMesh cylinder_surface(const Vec3d& from, const Vec3d& to, double radius, int n_around, int n_along) {
  assert(n_around >= 3 && n_along >= 1);
  const Vec3d axis = normalized(to - from), e1 = any_normal_to(axis), e2 = cross(axis, e1);
  TriangleMesh mesh;
  for (int k = 0; k <= n_along; ++k)
    for (int a = 0; a < n_around; ++a) {
      const double angle = 2 * std::numbers::pi * a / n_around;
      const Vec3d center = k == n_along ? to : from + (to - from) * (static_cast<double>(k) / n_along);
      mesh.points.push_back(center + radius * (std::cos(angle) * e1 + std::sin(angle) * e2));
    }
  const int from_center = static_cast<int>(mesh.points.size()), to_center = from_center + 1;
  mesh.points.push_back(from);
  mesh.points.push_back(to);
  const auto at = [&](int k, int a) { return k * n_around + a % n_around; };
  for (int a = 0; a < n_around; ++a) {
    for (int k = 0; k < n_along; ++k) {
      mesh.triangles.push_back({at(k, a), at(k, a + 1), at(k + 1, a + 1)});
      mesh.triangles.push_back({at(k, a), at(k + 1, a + 1), at(k + 1, a)});
    }
    mesh.triangles.push_back({from_center, at(0, a + 1), at(0, a)});
    mesh.triangles.push_back({to_center, at(n_along, a), at(n_along, a + 1)});
  }
  return mesh;
}

TriangleMesh ellipsoid_surface(const Vec3d& center, const Vec3d& radii, int n) {
  assert(n >= 1);
  // Lattice points with |i| + |j| + |k| = n; the sine spaces them evenly along the great circles of the axes.
  LatticeMesh mesh([&](const LatticePoint& p) {
    Vec3d direction;
    for (int c = 0; c < 3; ++c) {
      const int i = p[static_cast<std::size_t>(c)];
      const double s = std::abs(i) == n ? 1 : std::sin(std::numbers::pi / 2 * std::abs(i) / n);
      direction[c] = i < 0 ? -s : s;
    }
    direction = normalized(direction);
    return center + Vec3d{{radii[0] * direction[0], radii[1] * direction[1], radii[2] * direction[2]}};
  });
  for (const int sx : {-1, 1})
    for (const int sy : {-1, 1})
      for (const int sz : {-1, 1}) {
        const auto at = [&](int i, int j) { return LatticePoint{sx * i, sy * j, sz * (n - i - j)}; };
        const auto add = [&](const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
          sx* sy* sz > 0 ? mesh.add(a, b, c) : mesh.add(a, c, b);
        };
        for (int i = 0; i < n; ++i)
          for (int j = 0; i + j < n; ++j) {
            add(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 2 <= n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
          }
      }
  return mesh.take();
}

}  // namespace fascia
