#pragma once

#include "core/math/mat3.hpp"

namespace fascia {

/// A node of another body that is a frame of a meshless one too: the two are one body mechanically, without unknowns
/// between them.
struct SharedFrame {
  int node = 0;  ///< of the model
  Vec3d x{};     ///< where it acts as a frame [m]
  Vec3d arm{};   ///< x minus the rest position of the node: not 0 on the surface of a rigid body, which moves with it
  bool turns = true;  ///< false: a vertex that keeps no rotation; the points that follow it take displacements alone
};

}  // namespace fascia
