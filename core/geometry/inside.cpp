#include "core/geometry/inside.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fascia {

InsideTest::InsideTest(const TriangleMesh& closed) : mesh_(closed), tree_(closed) {
  if (mesh_.triangles.empty()) return;
  for (const auto& triangle : mesh_.triangles)
    for (const int node : triangle) bounds_.include(mesh_.points[static_cast<std::size_t>(node)]);
  fill_bins();
}

int InsideTest::bin(int axis, double coordinate) const {
  const int count = bins_[static_cast<std::size_t>(axis - 1)];
  const double extent = bounds_.high[axis] - bounds_.low[axis];
  if (!(extent > 0)) return 0;
  const double place = std::floor((coordinate - bounds_.low[axis]) / extent * count);
  return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(count - 1)));
}

template <class Act>
void InsideTest::for_each_bin(const std::array<int, 3>& triangle, Act&& act) const {
  std::array<int, 2> from = bins_, to{0, 0};
  for (const int node : triangle)
    for (std::size_t a = 0; a < 2; ++a) {
      const int axis = static_cast<int>(a) + 1;
      const int b = bin(axis, mesh_.points[static_cast<std::size_t>(node)][axis]);
      from[a] = std::min(from[a], b);
      to[a] = std::max(to[a], b);
    }
  for (int j = from[0]; j <= to[0]; ++j)
    for (int k = from[1]; k <= to[1]; ++k) act(bin_number(j, k));
}

void InsideTest::fill_bins() {
  constexpr double most_bins = 1024;        // along an axis
  constexpr std::size_t most_members = 32;  // a triangle, on average: slivers across many bins make the bins wider
  int count = static_cast<int>(std::clamp(std::sqrt(static_cast<double>(mesh_.triangles.size())), 1.0, most_bins));
  for (;; count /= 2) {
    bins_.fill(count);
    std::size_t members = 0;
    const std::size_t limit = most_members * mesh_.triangles.size();
    for (std::size_t t = 0; t < mesh_.triangles.size() && members <= limit; ++t)
      for_each_bin(mesh_.triangles[t], [&](std::size_t) { ++members; });
    if (members <= limit) break;
  }

  const auto bin_count = static_cast<std::size_t>(count) * static_cast<std::size_t>(count);
  begin_.assign(bin_count + 1, 0);
  for (const auto& triangle : mesh_.triangles) for_each_bin(triangle, [&](std::size_t b) { ++begin_[b + 1]; });
  for (std::size_t b = 0; b < bin_count; ++b) begin_[b + 1] += begin_[b];
  members_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for_each_bin(mesh_.triangles[t], [&](std::size_t b) { members_[next[b]++] = static_cast<int>(t); });
}

/// Edges that span z and pass it on the side of larger y; opposite directions cancel. This and the place are computed
/// by one code for points and for lines, so that both round alike.
[[gnu::noinline]] int InsideTest::passes(const std::array<int, 3>& triangle, double y, double z) const {
  int passes = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const int from = triangle[n], to = triangle[(n + 1) % 3];
    const Vec3d& a = mesh_.points[static_cast<std::size_t>(std::min(from, to))];
    const Vec3d& b = mesh_.points[static_cast<std::size_t>(std::max(from, to))];
    const bool a_above = a[2] > z, b_above = b[2] > z;
    if (a_above == b_above) continue;
    const double side = (b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]);
    const bool beyond = b_above ? side > 0 : side < 0;
    if (beyond) passes += b_above == (from < to) ? 1 : -1;
  }
  return passes;
}

/// Within the triangle whatever the rounding; its lowest x where that leaves 0/0.
[[gnu::noinline]] double InsideTest::place_of_crossing(const std::array<int, 3>& triangle, double y, double z) const {
  const auto corner = [&](std::size_t n) { return mesh_.points[static_cast<std::size_t>(triangle[n])]; };
  const Vec3d p = corner(0), q = corner(1), r = corner(2);
  const auto [low, high] = std::minmax({p[0], q[0], r[0]});
  const Vec3d normal = cross(q - p, r - p);
  const double place = p[0] + ((p[1] - y) * normal[1] + (p[2] - z) * normal[2]) / normal[0];
  return std::isnan(place) ? low : std::clamp(place, low, high);
}

template <class Act>
void InsideTest::for_each_crossing(double y, double z, Act&& act) const {
  if (mesh_.triangles.empty()) return;
  if (!(y >= bounds_.low[1] && y <= bounds_.high[1] && z >= bounds_.low[2] && z <= bounds_.high[2])) return;
  const std::size_t b = bin_number(bin(1, y), bin(2, z));
  for (std::size_t m = begin_[b]; m < begin_[b + 1]; ++m) {
    const std::array<int, 3>& triangle = mesh_.triangles[static_cast<std::size_t>(members_[m])];
    if (const int n = passes(triangle, y, z); n != 0) act(Crossing{place_of_crossing(triangle, y, z), n});
  }
}

int InsideTest::winding_number(const Vec3d& x) const {
  int sum = 0;
  if (!(x[0] < bounds_.high[0])) return sum;  // far beyond a body most points are
  for_each_crossing(x[1], x[2], [&](const Crossing& c) { sum += c.x > x[0] ? c.passes : 0; });
  return sum;
}

void InsideTest::contains_on_line(double y, double z, std::span<const double> x, std::span<char> inside) const {
  std::vector<Crossing> crossings;
  for_each_crossing(y, z, [&](const Crossing& c) { crossings.push_back(c); });
  for (std::size_t i = 0; i < x.size(); ++i) {
    int sum = 0;
    for (const Crossing& c : crossings) sum += c.x > x[i] ? c.passes : 0;
    inside[i] = sum > 0 ? 1 : 0;
  }
}

InsideTest::Surrounded InsideTest::surrounded(double y, double z) const {
  std::vector<Crossing> crossings;
  for_each_crossing(y, z, [&](const Crossing& c) { crossings.push_back(c); });
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.x > b.x; });
  Surrounded out;
  int winding = 0;
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    winding += crossings[k].passes;
    const double length = crossings[k].x - crossings[k + 1].x;
    const int of_solid = winding > 0 ? 1 : 0;
    out.inside += of_solid * length;
    out.wrong += std::abs(winding - of_solid) * length;
  }
  return out;
}

}  // namespace fascia
