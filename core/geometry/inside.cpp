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

int InsideTest::crossing(const std::array<int, 3>& triangle, const Vec3d& x) const {
  // Edges that span the point's z and pass it on the side of larger y; opposite directions cancel.
  int passes = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const int from = triangle[n], to = triangle[(n + 1) % 3];
    const Vec3d& a = mesh_.points[static_cast<std::size_t>(std::min(from, to))];
    const Vec3d& b = mesh_.points[static_cast<std::size_t>(std::max(from, to))];
    const bool a_above = a[2] > x[2], b_above = b[2] > x[2];
    if (a_above == b_above) continue;
    const double side = (b[1] - a[1]) * (x[2] - a[2]) - (b[2] - a[2]) * (x[1] - a[1]);
    const bool beyond = b_above ? side > 0 : side < 0;
    if (beyond) passes += b_above == (from < to) ? 1 : -1;
  }
  if (passes == 0) return 0;

  const auto corner = [&](std::size_t n) { return mesh_.points[static_cast<std::size_t>(triangle[n])]; };
  const Vec3d p = corner(0), q = corner(1), r = corner(2);
  const auto [x_low, x_high] = std::minmax({p[0], q[0], r[0]});
  if (x[0] < x_low) return passes;
  if (x[0] >= x_high) return 0;
  const Vec3d normal = cross(q - p, r - p);
  const double height = ((p[1] - x[1]) * normal[1] + (p[2] - x[2]) * normal[2]) / normal[0];
  return std::clamp(p[0] + height, x_low, x_high) > x[0] ? passes : 0;
}

int InsideTest::winding_number(const Vec3d& x) const {
  if (mesh_.triangles.empty() || !(x[0] < bounds_.high[0])) return 0;
  for (int axis = 1; axis < 3; ++axis)
    if (!(x[axis] >= bounds_.low[axis] && x[axis] <= bounds_.high[axis])) return 0;
  const std::size_t b = bin_number(bin(1, x[1]), bin(2, x[2]));
  int sum = 0;
  for (std::size_t m = begin_[b]; m < begin_[b + 1]; ++m)
    sum += crossing(mesh_.triangles[static_cast<std::size_t>(members_[m])], x);
  return sum;
}

}  // namespace fascia
