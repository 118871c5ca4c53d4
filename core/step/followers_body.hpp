#pragma once

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"
#include "core/space/node_rows.hpp"
#include "core/step/followers.hpp"

/// The bodies of Followers, for the files that instantiate it.
namespace fascia {

template <class Space>
Followers<Space>::Followers(const Model& model, Space space) {
  if (model.followers.empty()) return;
  std::vector<FollowerRule> rules;
  std::vector<int> follower, node;
  std::vector<double> w;
  std::vector<Vec3d> b, g;
  for (const FollowerLoad& load : model.followers) {
    const bool vertices = !load.g.empty();
    follower.insert(follower.end(), load.nodes.size(), static_cast<int>(rules.size()));
    rules.push_back({load.schedule, vertices, load.force, load.torque});
    node.insert(node.end(), load.nodes.begin(), load.nodes.end());
    w.insert(w.end(), load.w.begin(), load.w.end());
    b.insert(b.end(), load.b.begin(), load.b.end());
    g.insert(g.end(), load.g.begin(), load.g.end());
    b.resize(node.size());
    g.resize(node.size());
  }
  const NodeRows rows(node, model.node_count());
  by_follower_ = RowSums<Space>(follower, static_cast<int>(rules.size()), 0, space);
  by_node_ = RowSums<Space>(rows.row, static_cast<int>(rows.nodes.size()), 0, space);
  rule_.upload(rules);
  turned_.resize(rules.size());
  follower_.upload(follower);
  node_.upload(node);
  loaded_.upload(rows.nodes);
  w_.upload(w);
  b_.upload(b);
  g_.upload(g);
  view_ = {rule_.data(), turned_.data(), follower_.data(), node_.data(), w_.data(), b_.data(), g_.data()};
}

namespace loops {

/// Σ w D or Σ u gᵀ.
struct FollowerMotion {
  FollowersView set;
  PoseView pose;

  FASCIA_HD void operator()(int share, Sums<9>& sums) const {
    const int node = set.node[share];
    const Mat3d D =
        set.rule[set.follower[share]].vertices ? outer(pose.u[node], set.g[share]) : pose.D_of(node) * set.w[share];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sums.v[3 * i + j] += D(i, j);
  }
};

struct TurnFollower {
  FollowersView set;
  const double* factors;

  FASCIA_HD void operator()(int follower, const Sums<9>& sums) const {
    Mat3d D;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) D(i, j) = sums.v[3 * i + j];
    const FollowerRule& rule = set.rule[follower];
    set.turned[follower] = turned_follower(rule.force, rule.torque, D, rule.vertices, factors[rule.schedule]);
  }
};

/// Force, N and torque of a share.
struct FollowerShare {
  FollowersView set;

  FASCIA_HD void operator()(int share, Sums<15>& sums) const {
    const TurnedFollower& pull = set.turned[set.follower[share]];
    const bool vertices = set.rule[set.follower[share]].vertices;
    const double w = set.w[share];
    const Vec3d force = vertices ? pull.force * w + pull.couple * set.g[share] : pull.force * w;
    for (int i = 0; i < 3; ++i) {
      sums.v[i] += force[i];
      if (vertices) continue;
      for (int j = 0; j < 3; ++j) sums.v[3 + 3 * i + j] += pull.force[i] * set.b[share][j];
      sums.v[12 + i] += pull.torque[i] * w;
    }
  }
};

struct AddFollowers {
  const int* loaded;
  NodesView nodes;
  PoseView pose;
  double* load;

  FASCIA_HD void operator()(int row, const Sums<15>& sums) const {
    const int node = loaded[row];
    Vec3d force, torque;
    Mat3d N;
    for (int i = 0; i < 3; ++i) {
      force[i] = sums.v[i];
      torque[i] = sums.v[12 + i];
      for (int j = 0; j < 3; ++j) N(i, j) = sums.v[3 + 3 * i + j];
    }
    add_node_force(nodes.kind[node], pose.D_of(node), force, N, torque, load + nodes.dof[node]);
  }
};

}  // namespace loops

template <class Space>
void Followers<Space>::add_forces(const NodesView& nodes, const PoseView& pose, const double* factors, double* load) {
  by_follower_.template sum<9>(loops::FollowerMotion{view_, pose}, loops::TurnFollower{view_, factors});
  by_node_.template sum<15>(loops::FollowerShare{view_}, loops::AddFollowers{loaded_.data(), nodes, pose, load});
}

}  // namespace fascia
