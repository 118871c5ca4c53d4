#pragma once

#include "core/math/vec3.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace fascia {

/// The least box along the axes that holds what was included.
struct Bounds {
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  Vec3d low{{infinite, infinite, infinite}}, high{{-infinite, -infinite, -infinite}};

  void include(const Vec3d& x) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], x[c]);
      high[c] = std::max(high[c], x[c]);
    }
  }
  void include(const Bounds& b) {
    include(b.low);
    include(b.high);
  }
  bool empty() const { return !(low[0] <= high[0]); }
  bool contains(const Vec3d& x) const {
    for (int c = 0; c < 3; ++c)
      if (!(x[c] >= low[c] && x[c] <= high[c])) return false;
    return true;
  }
  bool contains(const Bounds& b) const { return contains(b.low) && contains(b.high); }
  Vec3d middle() const { return (low + high) * 0.5; }
  /// Along each axis; of a box that holds something.
  Vec3d extent() const { return high - low; }
  double diagonal() const { return empty() ? 0 : norm(extent()); }
};

inline Bounds bounds_of(std::span<const Vec3d> points) {
  Bounds b;
  for (const Vec3d& x : points) b.include(x);
  return b;
}

/// The axis along which a box is longest, of several the first.
inline int longest_axis(const Bounds& b) {
  const Vec3d d = b.extent();
  return d[0] >= d[1] && d[0] >= d[2] ? 0 : (d[1] >= d[2] ? 1 : 2);
}

}  // namespace fascia
