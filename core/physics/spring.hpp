#pragma once

#include "core/math/mat3.hpp"

namespace fascia {

/// A spring between a node, or a place fixed in it, and a point that is fixed in space. Along a direction n it resists
/// the displacement along n alone, as a ligament does that is long beside what it stretches: energy k (u · n)² / 2.
/// Otherwise it runs to the point and resists a change of its length l from that at rest: energy k (l − l₀)² / 2.
struct Spring {
  int node = 0;
  double stiffness = 0;  ///< k [N/m]
  Vec3d X{};             ///< where it is attached, at rest [m]
  Vec3d point{};         ///< [m]
  Vec3d direction{};     ///< n, unit; 0: towards the point
  Vec3d arm{};           ///< X minus the rest position of the node, a rigid frame that takes it along; 0 on others [m]
};

}  // namespace fascia
