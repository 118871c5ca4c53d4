#pragma once

#include "core/step/followers.hpp"
#include "core/step/surfaces.hpp"

namespace fascia {

/// Loads of a model that turn or move with the body: all but dead ones, which a node has by itself. A kind of them is a
/// member here, and whoever sums forces follows.
template <class Space>
struct MovingLoads {
  Followers<Space> followers;
  Surfaces<Space> surfaces;

  explicit MovingLoads(const Model& model, Space space = Space()) : followers(model, space), surfaces(model, space) {}

  bool empty() const { return followers.empty() && surfaces.empty(); }
  /// Adds forces at a pose to the degrees of freedom. @param factors  of schedules, in the space
  void add_forces(const NodesView& nodes, const PoseView& pose, const double* factors, double* load) {
    if (!followers.empty()) followers.add_forces(nodes, pose, factors, load);
    if (!surfaces.empty()) surfaces.add_forces(nodes, pose, factors, load);
  }
};

}  // namespace fascia
