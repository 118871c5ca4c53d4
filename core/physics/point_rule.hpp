#pragma once

#include "core/base/portability.hpp"

namespace fascia {

/// Stress of a point: of a solid, St Venant-Kirchhoff or neo-Hookean; plane stress; that of a rod; or no stress but a
/// spring to a place in space.
enum class Law : unsigned char { solid, neo_hookean, sheet, line, tether };

FASCIA_HD constexpr bool is_solid(Law law) { return law == Law::solid || law == Law::neo_hookean; }

/// What keeps frames from moving where strain does not see them: nothing; Qbar tied to the rotation in F; affine
/// frames: the blended A tied to F.
enum class Stabilization : unsigned char { none, drilling, affine };

/// How a group's points are computed.
struct PointRule {
  Law law = Law::solid;
  Stabilization stabilization = Stabilization::drilling;
  bool transverse = false;  ///< thin laws: directors may stretch (affine frames), and resist it on their own
};

/// What the compiler must know of a rule to leave out what it does not need.
struct PointKind {
  Stabilization stabilization = Stabilization::none;
  enum class Matter : unsigned char { solid, neo_hookean, thin } matter = Matter::solid;
};

/// The same in a point set.
struct GroupRule {
  PointRule rule;
  int axes = -1;  ///< index of the group among those that have axes, −1: none
};

}  // namespace fascia
