#include "core/structure/model.hpp"

#include <algorithm>

namespace fascia {

int Model::constrained_dof_count() const {
  int count = 0;
  for (const FrameConstraint& c : constraints) {
    if (kind(c.node) == FrameKind::vertex)
      count += c.translations;
    else if (kind(c.node) == FrameKind::rigid)
      count += c.translations + c.rotations;
    else
      count += c.translations + (c.whole ? 9 : 2 * c.rotations);
  }
  return count;
}

int Model::dependent_dof_count() const {
  int count = 0;
  for (const DependentNode& d : points.dependents) count += dependent_dofs(d, points.dofs);
  return count;
}

bool Model::has_frames() const {
  return std::any_of(frame_kind.begin(), frame_kind.end(), [](FrameKind kind) { return kind != FrameKind::vertex; });
}

bool Model::is_linear() const {
  return !has_frames() && points.point_count == 0 && points.springs.empty() && points.user_blocks.empty() &&
         points.dependents.empty() && followers.empty() && surfaces.empty() &&
         std::all_of(points.blocks.begin(), points.blocks.end(),
                     [](const ElementBlock& block) { return block.law == Law::linear; });
}

bool Model::loads_are_conservative() const {
  const auto has_torque = [](const DeadLoad& load) {
    return std::any_of(load.nodes.begin(), load.nodes.end(),
                       [](const NodeLoad& n) { return squared_norm(n.torque) > 0; });
  };
  return followers.empty() && std::none_of(loads.begin(), loads.end(), has_torque) &&
         std::all_of(surfaces.begin(), surfaces.end(), [](const SurfaceLoad& s) { return s.has_potential; });
}

State State::at_rest(const Model& model) {
  const auto n = static_cast<std::size_t>(model.node_count());
  State state;
  state.u.resize(n);
  state.D = state.Q_dot = FrameMatrices(n, model.has_frames());
  state.v.resize(n);
  state.turned.resize(model.constraints.size());
  return state;
}

}  // namespace fascia
