#pragma once

#include "core/space/array.hpp"
#include "core/space/row_sums.hpp"
#include "core/step/model_view.hpp"

namespace fascia {

/// A follower without its nodes.
struct FollowerRule {
  int schedule = 0;
  bool vertices = false;
  Vec3d force{}, torque{};  ///< at rest
};

/// Followers, and their shares: one for each node of each of them.
struct FollowersView {
  const FollowerRule* rule = nullptr;
  TurnedFollower* turned = nullptr;                ///< of each follower, at the last pose
  const int *follower = nullptr, *node = nullptr;  ///< of each share
  const double* w = nullptr;
  const Vec3d *b = nullptr, *g = nullptr;
};

/// The follower loads of a model: their rotations first, then the forces of each node.
template <class Space>
class Followers {
 public:
  explicit Followers(const Model& model, Space space = Space());

  bool empty() const { return by_follower_.rows() == 0; }

  /// Adds forces to the degrees of freedom. @param factors  of schedules, in the space
  void add_forces(const NodesView& nodes, const PoseView& pose, const double* factors, double* load);

 private:
  RowSums<Space> by_follower_, by_node_;  ///< shares
  Array<Space, FollowerRule> rule_;
  Array<Space, TurnedFollower> turned_;
  Array<Space, int> follower_, node_, loaded_;  ///< loaded_: nodes that have shares
  Array<Space, double> w_;
  Array<Space, Vec3d> b_, g_;
  FollowersView view_;
};

}  // namespace fascia
