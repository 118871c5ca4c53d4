#include "assembly/specification/fibres.hpp"

#include "assembly/specification/errors.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fascia {

Vec3d fibre_direction(const Fibres& fibres, const Vec3d& X) {
  if (const auto* straight = std::get_if<StraightFibres>(&fibres.field)) return straight->direction;
  const auto& wound = std::get<WoundFibres>(fibres.field);
  constexpr double kAlong = 1e-15;  // a right angle as rounding leaves it
  if (std::abs(std::cos(wound.angle)) < kAlong) return wound.axis * std::copysign(1.0, std::sin(wound.angle));
  const Vec3d from = X - wound.point, out = from - wound.axis * dot(from, wound.axis);
  constexpr double kOnAxis = 1e-12;  // of the distance to the point: rounding alone parts it from the axis
  if (!(norm(out) > kOnAxis * norm(from)))
    throw SceneError({{fibres.place,
                       fmt::format("winds fibres about an axis that passes through matter at ({:.6g}, {:.6g}, {:.6g}), "
                                   "where rings have no direction; move the axis off the integration points, or give "
                                   "the core another material",
                                   X[0], X[1], X[2])}});
  return normalized(cross(wound.axis, out)) * std::cos(wound.angle) + wound.axis * std::sin(wound.angle);
}

}  // namespace fascia
