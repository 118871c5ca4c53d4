#pragma once

#include "core/math/vec3.hpp"

#include <vector>

namespace fascia {

/// Frames or integration points that a user lists, in the order of the file.
struct PointTable {
  std::vector<Vec3d> position;  ///< (n) [m], n > 0
  std::vector<Vec3d> rotation;  ///< rotation vectors [rad]: none or n
  std::vector<double> volume;   ///< [m³], above 0: none or n
};

}  // namespace fascia
