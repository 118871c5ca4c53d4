#pragma once

#include "assembly/specification/region.hpp"
#include "assembly/specification/schedule.hpp"
#include "core/math/vec3.hpp"

#include <cstddef>
#include <variant>

/// Fibres of a material, and the stress that muscle makes along them.
namespace fascia {

/// All fibres run alike at rest.
struct StraightFibres {
  Vec3d direction{{1, 0, 0}};  ///< a unit vector
};
/// They wind about an axis, by `angle` from the rings about it towards it: 0 are rings, a right angle runs along it.
struct WoundFibres {
  Vec3d point{}, axis{{0, 0, 1}};  ///< a unit vector
  double angle = 0;                ///< [rad]
};
/// One family.
struct Fibres {
  Place place{};
  std::variant<StraightFibres, WoundFibres> field{};
};

/// The unit vector of fibres at a rest position.
/// @throws SceneError  on the axis about which they wind, where rings have no direction
Vec3d fibre_direction(const Fibres& fibres, const Vec3d& X);

/// A family of fibres pulls along itself (core/physics/active_stress.hpp).
struct Activation {
  Place place{};
  double stress = 0;       ///< at a factor of 1 [Pa]
  std::size_t fibres = 0;  ///< index into the material's
  Schedule schedule{};
  int factor = -1;  ///< of its schedule in the simulation; set where one is built
};

}  // namespace fascia
