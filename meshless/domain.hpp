#pragma once

#include "core/geometry/mesh.hpp"

#include <functional>

namespace fascia {

/// A solid in the axes of its frame grid, before its rigid placement.
struct SolidDomain {
  Vec3d min{}, max{};                            ///< bounding box [m]
  double volume = 0;                             ///< [m³]
  std::function<bool(const Vec3d&)> contains;    ///< empty: the whole box
  std::function<double(const Vec3d&)> distance;  ///< from a point to the solid [m], 0 inside; empty: the box
  TriangleMesh surface;                          ///< closed, outward; carried along for pictures and surface loads
};

}  // namespace fascia
