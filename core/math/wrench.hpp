#pragma once

#include "core/math/vec3.hpp"

namespace fascia {

/// A force and its moment about a point.
struct Wrench {
  Vec3d force{};   ///< [N]
  Vec3d moment{};  ///< [N m]

  /// Adds a force at an arm from that point, and a torque.
  void add(const Vec3d& arm, const Vec3d& f, const Vec3d& torque) {
    force += f;
    moment += cross(arm, f) + torque;
  }
  Wrench& operator+=(const Wrench& o) {
    force += o.force;
    moment += o.moment;
    return *this;
  }
  Wrench& operator-=(const Wrench& o) {
    force -= o.force;
    moment -= o.moment;
    return *this;
  }
};

}  // namespace fascia
