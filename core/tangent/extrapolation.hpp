#pragma once

#include "core/physics/point_physics.hpp"
#include "core/structure/point_set.hpp"

#include <algorithm>

namespace fascia {

/// Some dependent node has a host that is a rigid frame, which forces on the node turn.
inline bool forces_turn_hosts(const PointSet& set) {
  return std::any_of(set.dependents.begin(), set.dependents.end(), [&](const DependentNode& d) {
    return std::any_of(d.hosts.begin(), d.hosts.end(),
                       [&](int host) { return set.dofs.kind(host) == FrameKind::rigid; });
  });
}

/// Newton's tangent extrapolates stresses. Forces on dependent nodes are those of the state, and what these do to the
/// turning of hosts must not meet extrapolated stresses elsewhere: such models keep the stresses of the state. So do
/// those with user blocks, which know no others.
inline bool extrapolates_stresses(const PointSet& set, Tangent tangent) {
  return tangent == Tangent::full && set.user_blocks.empty() && !forces_turn_hosts(set);
}

}  // namespace fascia
