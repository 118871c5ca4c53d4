#pragma once

#include "core/math/mat3.hpp"
#include "core/structure/dof_layout.hpp"

#include <vector>

namespace fascia {

/// A node that follows others, its hosts, and has no unknowns of its own for that: welded to a frame, or embedded in a
/// body's field. With displacement u and D = A − I of the hosts a,
///
///   u = Σ w_a u_a + D_a b_a,   and where it turns, with its first host,   D = D_0.
///
/// A frame that does not turn with its host keeps its own rotation.
struct DependentNode {
  int node = 0;
  std::vector<int> hosts;  ///< distinct; they may depend on others in turn
  std::vector<double> w;   ///< [-]
  std::vector<Vec3d> b;    ///< [m]
  bool turns = false;      ///< the first host is a rigid frame, whose rotation it has
};

/// Degrees of freedom that follow the hosts; they are the node's first.
inline int dependent_dofs(const DependentNode& dependent, const DofLayout& dofs) {
  return dependent.turns ? dofs.size(dependent.node) : 3;
}

}  // namespace fascia
