#pragma once

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"
#include "core/space/node_rows.hpp"
#include "core/step/dependents.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

/// The bodies of Dependents, for the files that instantiate it.
namespace fascia {

template <class Space>
Dependents<Space>::Dependents(const PointSet& set, Space space) : space_(space), leverage_(at(set.part_count()), 1.0) {
  if (set.dependents.empty()) return;
  for (const DependentNode& d : set.dependents) {
    const auto part = at(set.node_part[at(d.node)]);
    for (std::size_t a = 0; a < d.hosts.size(); ++a)
      leverage_[part] = std::max(leverage_[part], std::hypot(d.w[a], norm(d.b[a]) / set.part_length[part]));
  }
  // Hosts come before those that depend on them.
  std::vector<int> level_of_node(at(set.node_count()), 0), index(set.dependents.size());
  for (const DependentNode& d : set.dependents)
    for (const int host : d.hosts)
      level_of_node[at(d.node)] = std::max(level_of_node[at(d.node)], level_of_node[at(host)] + 1);
  const auto level = [&](int k) { return level_of_node[at(set.dependents[at(k)].node)]; };
  std::iota(index.begin(), index.end(), 0);
  std::stable_sort(index.begin(), index.end(), [&](int a, int b) { return level(a) < level(b); });

  std::vector<int> node, pair_begin{0}, dependent, hosts;
  std::vector<char> turns;
  std::vector<FrameKind> kind;
  std::vector<double> w;
  std::vector<Vec3d> b;
  for (const int k : index) {
    const DependentNode& d = set.dependents[at(k)];
    dependent.insert(dependent.end(), d.hosts.size(), static_cast<int>(node.size()));
    node.push_back(d.node);
    turns.push_back(d.turns ? 1 : 0);
    hosts.insert(hosts.end(), d.hosts.begin(), d.hosts.end());
    w.insert(w.end(), d.w.begin(), d.w.end());
    b.insert(b.end(), d.b.begin(), d.b.end());
    pair_begin.push_back(static_cast<int>(hosts.size()));
  }
  for (const int host : hosts) {
    kind.push_back(set.dofs.kind(host));
    most_host_dofs_ = std::max(most_host_dofs_, set.dofs.size(host));
  }
  for (int k = 0; k < static_cast<int>(index.size());) {
    Level& next = levels_.emplace_back();
    next.begin = k;
    next.first_pair = pair_begin[at(k)];
    const int of = level(index[at(k)]);
    while (k < static_cast<int>(index.size()) && level(index[at(k)]) == of) ++k;
    next.count = k - next.begin;
    const NodeRows rows({hosts.begin() + next.first_pair, hosts.begin() + pair_begin[at(k)]}, set.node_count());
    next.by_host = RowSums<Space>(rows.row, static_cast<int>(rows.nodes.size()), kMostDofs, space_);
    next.hosts.upload(rows.nodes);
  }
  pairs_ = static_cast<int>(hosts.size());
  node_.upload(node);
  pair_begin_.upload(pair_begin);
  index_.upload(index);
  turns_.upload(turns);
  dependent_.upload(dependent);
  host_.upload(hosts);
  kind_.upload(kind);
  w_.upload(w);
  b_.upload(b);
  lever_.copy_from(b_);
  view_ = {node_.data(), pair_begin_.data(), index_.data(), turns_.data(), dependent_.data(),
           host_.data(), kind_.data(),       w_.data(),     b_.data(),     lever_.data()};
}

namespace loops {

struct PlaceDependent {
  DependentsView set;
  int first;
  Vec3d* u;
  Mat3d* D;

  FASCIA_HD void operator()(int i) const {
    const int k = first + i, node = set.node[k];
    Vec3d place;
    for (int p = set.pair_begin[k]; p < set.pair_begin[k + 1]; ++p) {
      place += u[set.host[p]] * set.w[p];
      if (D != nullptr) place += D[set.host[p]] * set.b[p];
    }
    u[node] = place;
    if (set.turns[k] != 0) D[node] = D[set.host[set.pair_begin[k]]];
  }
};

struct PlaceIncrement {
  DependentsView set;
  int first;
  Vec3d* du;
  Mat3d* Ds;
  const Mat3d* start_D;

  FASCIA_HD void operator()(int i) const {
    const int k = first + i, node = set.node[k];
    Vec3d moved;
    for (int p = set.pair_begin[k]; p < set.pair_begin[k + 1]; ++p) {
      const int host = set.host[p];
      moved += du[host] * set.w[p];
      if (Ds == nullptr) continue;
      moved += (set.kind[p] == FrameKind::rigid ? Ds[host] + Ds[host] * start_D[host] : Ds[host]) * set.b[p];
    }
    du[node] = moved;
    if (set.turns[k] != 0) Ds[node] = Ds[set.host[set.pair_begin[k]]];
  }
};

struct ExpandDependent {
  DependentsView set;
  int first;
  NodesView nodes;
  double* d;
  Vec3d* dx;
  Mat3d* dA;
  const Mat3d* Q;

  FASCIA_HD void operator()(int i) const {
    const int k = first + i, node = set.node[k];
    double* own = d + nodes.dof[node];
    Vec3d moved;
    for (int p = set.pair_begin[k]; p < set.pair_begin[k + 1]; ++p) {
      const double* host = d + nodes.dof[set.host[p]];
      moved += Vec3d{{host[0], host[1], host[2]}} * set.w[p];
      if (set.kind[p] == FrameKind::rigid)
        moved += cross(Vec3d{{host[3], host[4], host[5]}}, set.lever[p]);
      else if (set.kind[p] == FrameKind::affine)
        moved += frame_variation(FrameKind::affine, host + 3, {}) * set.lever[p];
    }
    for (int a = 0; a < 3; ++a) own[a] = moved[a];
    if (dx != nullptr) dx[node] = moved;
    if (set.turns[k] == 0) return;
    const double* turning = d + nodes.dof[set.host[set.pair_begin[k]]] + 3;
    for (int a = 0; a < 3; ++a) own[3 + a] = turning[a];
    if (dA != nullptr) dA[node] = frame_variation(FrameKind::rigid, turning, Q[node]);
  }
};

struct TransferredForce {
  DependentsView set;
  int first_pair;
  NodesView nodes;
  const double* g;

  FASCIA_HD void operator()(int i, Sums<kMostDofs>& sums) const {
    const int pair = first_pair + i;
    set.add_to_host(pair, g + nodes.dof[set.node[set.dependent[pair]]], sums);
  }
};

struct AddToHosts {
  const int* hosts;
  NodesView nodes;
  double* g;

  FASCIA_HD void operator()(int row, const Sums<kMostDofs>& sums) const {
    const int host = hosts[row];
    for (int i = 0; i < nodes.size(host); ++i) g[nodes.dof[host] + i] += sums.v[i];
  }
};

/// Keeps what a dependent node handed on, and clears it.
struct ClearForce {
  DependentsView set;
  int first;
  NodesView nodes;
  double *g, *forces;

  FASCIA_HD void operator()(int i) const {
    const int k = first + i, m = set.dofs(nodes, k);
    double* own = g + nodes.dof[set.node[k]];
    for (int a = 0; forces != nullptr && a < 6; ++a) forces[6 * set.index[k] + a] = a < m ? own[a] : 0.0;
    for (int a = 0; a < m; ++a) own[a] = 0;
  }
};

/// Σ f (Q b)ᵀ of a rigid host.
struct TurningMoment {
  DependentsView set;
  int first_pair;
  const double* forces;

  FASCIA_HD void operator()(int i, Sums<9>& L) const {
    const int pair = first_pair + i;
    const double* f = forces + 6 * static_cast<std::size_t>(set.index[set.dependent[pair]]);
    for (int a = 0; a < 3; ++a)
      for (int c = 0; c < 3; ++c) L.v[3 * a + c] += f[a] * set.lever[pair][c];
  }
};

struct AddTurningBlock {
  const int* hosts;
  NodesView nodes;
  double* node_blocks;

  FASCIA_HD void operator()(int row, const Sums<9>& sums) const {
    const int host = hosts[row];
    if (nodes.kind[host] != FrameKind::rigid) return;
    Mat3d L;
    for (int a = 0; a < 3; ++a)
      for (int c = 0; c < 3; ++c) L(a, c) = sums.v[3 * a + c];
    add_rotation_block(node_blocks + nodes.block[host], rotation_tangent(L));
  }
};

/// A column of Jᵀ K_vv J of a pair.
struct DiagonalColumn {
  DependentsView set;
  int first_pair, dof;
  NodesView nodes;
  const double* blocks;

  FASCIA_HD void operator()(int i, Sums<kMostDofs>& sums) const {
    const int pair = first_pair + i, k = set.dependent[pair];
    if (dof >= dof_count(set.kind[pair])) return;
    const int n = nodes.size(set.node[k]), m = set.dofs(nodes, k);
    const double* K = blocks + nodes.block[set.node[k]];
    double column[6] = {}, f[6] = {};
    set.host_column(pair, dof, column);
    for (int r = 0; r < m; ++r)
      for (int c = 0; c < m; ++c) f[r] += K[n * r + c] * column[c];
    set.add_to_host(pair, f, sums);
  }
};

struct AddDiagonalColumn {
  const int* hosts;
  int dof;
  NodesView nodes;
  double* blocks;

  FASCIA_HD void operator()(int row, const Sums<kMostDofs>& sums) const {
    const int host = hosts[row], n = nodes.size(host);
    if (dof >= n) return;
    for (int r = 0; r < n; ++r) blocks[nodes.block[host] + at(n * r + dof)] += sums.v[r];
  }
};

struct ClearBlock {
  DependentsView set;
  int first;
  NodesView nodes;
  double* blocks;

  FASCIA_HD void operator()(int i) const {
    const int k = first + i, n = nodes.size(set.node[k]), m = set.dofs(nodes, k);
    double* own = blocks + nodes.block[set.node[k]];
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c)
        if (r < m || c < m) own[n * r + c] = r == c ? 1.0 : 0.0;
  }
};

}  // namespace loops

template <class Space>
void Dependents<Space>::place(Vec3d* u, Mat3d* D) const {
  for (const Level& level : levels_) space_.for_each(level.count, loops::PlaceDependent{view_, level.begin, u, D});
}

template <class Space>
void Dependents<Space>::place_increments(Vec3d* du, Mat3d* Ds, const Mat3d* start_D) const {
  for (const Level& level : levels_)
    space_.for_each(level.count, loops::PlaceIncrement{view_, level.begin, du, Ds, start_D});
}

template <class Space>
void Dependents<Space>::turn(const Mat3d* D) {
  if (D == nullptr) return;
  const DependentsView set = view_;
  space_.for_each(pairs_, [set, D] FASCIA_HD(int p) {
    if (set.kind[p] == FrameKind::rigid) set.lever[p] = set.b[p] + D[set.host[p]] * set.b[p];
  });
}

template <class Space>
void Dependents<Space>::turn_to(const Mat3d* Q) {
  const DependentsView set = view_;
  space_.for_each(pairs_, [set, Q] FASCIA_HD(int p) {
    if (set.kind[p] == FrameKind::rigid) set.lever[p] = Q[set.host[p]] * set.b[p];
  });
}

template <class Space>
void Dependents<Space>::expand(const NodesView& nodes, double* d, Vec3d* dx, Mat3d* dA, const Mat3d* Q) const {
  for (const Level& level : levels_)
    space_.for_each(level.count, loops::ExpandDependent{view_, level.begin, nodes, d, dx, dA, Q});
}

template <class Space>
void Dependents<Space>::transfer(const NodesView& nodes, double* g, double* forces) {
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    level.by_host.template sum<kMostDofs>(loops::TransferredForce{view_, level.first_pair, nodes, g},
                                          loops::AddToHosts{level.hosts.data(), nodes, g});
    space_.for_each(level.count, loops::ClearForce{view_, level.begin, nodes, g, forces});
  }
}

template <class Space>
void Dependents<Space>::add_turning(const NodesView& nodes, const double* forces, double* node_blocks) {
  for (Level& level : levels_)
    level.by_host.template sum<9>(loops::TurningMoment{view_, level.first_pair, forces},
                                  loops::AddTurningBlock{level.hosts.data(), nodes, node_blocks});
}

template <class Space>
void Dependents<Space>::add_diagonal(const NodesView& nodes, double* blocks) {
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    for (int dof = 0; dof < most_host_dofs_; ++dof)
      level.by_host.template sum<kMostDofs>(loops::DiagonalColumn{view_, level.first_pair, dof, nodes, blocks},
                                            loops::AddDiagonalColumn{level.hosts.data(), dof, nodes, blocks});
    space_.for_each(level.count, loops::ClearBlock{view_, level.begin, nodes, blocks});
  }
}

}  // namespace fascia
