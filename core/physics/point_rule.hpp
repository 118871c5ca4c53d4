#pragma once

#include "core/physics/law.hpp"

namespace fascia {

/// Stabilisation that keeps frames from moving where strain does not see them: nothing; Qbar tied to the rotation in F;
/// affine frames: the blended A tied to F.
enum class Stabilization : unsigned char { none, drilling, affine };

/// How a group's points are computed.
struct PointRule {
  Law law = Law::st_venant_kirchhoff;
  Stabilization stabilization = Stabilization::drilling;
  bool transverse = false;  ///< thin laws: directors may stretch (affine frames), and resist it on their own
};

/// The compiler knows this much of a rule and leaves out the rest: to it all thin laws are one.
struct PointKind {
  Stabilization stabilization = Stabilization::none;
  Law law = Law::st_venant_kirchhoff;
};

/// Rule of a group in a point set.
struct GroupRule {
  PointRule rule;
  int axes = -1;  ///< index of the group among those that have axes, −1: none
  int own = -1;   ///< first row of its law's own constants, −1: none
};

}  // namespace fascia
