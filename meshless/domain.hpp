#pragma once

#include "core/geometry/mesh.hpp"

#include <functional>
#include <span>

namespace fascia {

/// A solid in the axes of its frame grid, before its rigid placement.
struct SolidDomain {
  Vec3d min{}, max{};                          ///< bounding box [m]
  double volume = 0;                           ///< [m³]
  std::function<bool(const Vec3d&)> contains;  ///< empty: the whole box
  /// Likewise of points on a line along x, of which there may be many; 1 or 0 for each. Empty: by contains.
  std::function<void(double y, double z, std::span<const double> x, std::span<char> inside)> contains_on_line;
  std::function<double(const Vec3d&)> distance;  ///< from a point to the solid [m], 0 inside; empty: the box
  TriangleMesh surface;                          ///< closed, outward; carried along for pictures and surface loads
};

}  // namespace fascia
