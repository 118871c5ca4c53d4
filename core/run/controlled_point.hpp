#pragma once

#include "core/math/vec3.hpp"
#include "core/structure/point_set.hpp"

#include <optional>
#include <vector>

namespace fascia {

/// A material point whose displacement along a direction is prescribed.
struct ControlledPoint {
  std::vector<int> nodes;
  std::vector<Influence> influences;
  Vec3d direction{};         ///< of length 1
  std::optional<double> to;  ///< the run ends there; without it where the load factor is 1 [m]
};

}  // namespace fascia
