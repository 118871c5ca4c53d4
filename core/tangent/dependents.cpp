#include "core/tangent/dependents.hpp"

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

void place_dependents(const PointSet& set, State& state) {
  for (const DependentNode& d : set.dependents) {
    Vec3d u;
    for (std::size_t k = 0; k < d.hosts.size(); ++k)
      u += state.u[at(d.hosts[k])] * d.w[k] + state.D[at(d.hosts[k])] * d.b[k];
    state.u[at(d.node)] = u;
    if (d.turns) state.D[at(d.node)] = state.D[at(d.hosts[0])];
  }
}

void place_dependent_rates(const PointSet& set, State& state) {
  for (const DependentNode& d : set.dependents) {
    Vec3d v;
    for (std::size_t k = 0; k < d.hosts.size(); ++k)
      v += state.v[at(d.hosts[k])] * d.w[k] + state.Q_dot[at(d.hosts[k])] * d.b[k];
    state.v[at(d.node)] = v;
    if (d.turns) state.Q_dot[at(d.node)] = state.Q_dot[at(d.hosts[0])];
  }
}

bool forces_turn_hosts(const PointSet& set) {
  return std::any_of(set.dependents.begin(), set.dependents.end(), [&](const DependentNode& d) {
    return std::any_of(d.hosts.begin(), d.hosts.end(),
                       [&](int host) { return set.dofs.kind(host) == FrameKind::rigid; });
  });
}

DependentNodes::DependentNodes(const PointSet& set) : set_(set) {
  if (empty()) return;
  dependent_.assign(at(set.node_count()), -1);
  leverage_.assign(at(set.part_count()), 1.0);
  for (std::size_t k = 0; k < set.dependents.size(); ++k) {
    const DependentNode& d = set.dependents[k];
    dependent_[at(d.node)] = static_cast<int>(k);
    lever_begin_.push_back(lever_.size());
    lever_.insert(lever_.end(), d.b.begin(), d.b.end());
    const auto part = at(set.node_part[at(d.node)]);
    for (std::size_t a = 0; a < d.hosts.size(); ++a)
      leverage_[part] = std::max(leverage_[part], std::hypot(d.w[a], norm(d.b[a]) / set.part_length[part]));
  }
}

void DependentNodes::turn(const FrameMatrices& D) {
  for (std::size_t k = 0; k < set_.dependents.size(); ++k) {
    const DependentNode& d = set_.dependents[k];
    for (std::size_t a = 0; a < d.hosts.size(); ++a)
      if (set_.dofs.kind(d.hosts[a]) == FrameKind::rigid)
        lever_[lever_begin_[k] + a] = d.b[a] + D[at(d.hosts[a])] * d.b[a];
  }
}

void DependentNodes::turn(const std::vector<Mat3d>& Q) {
  for (std::size_t k = 0; k < set_.dependents.size(); ++k) {
    const DependentNode& d = set_.dependents[k];
    for (std::size_t a = 0; a < d.hosts.size(); ++a)
      if (set_.dofs.kind(d.hosts[a]) == FrameKind::rigid) lever_[lever_begin_[k] + a] = Q[at(d.hosts[a])] * d.b[a];
  }
}

void DependentNodes::expand(std::span<double> d) const {
  for (std::size_t k = 0; k < set_.dependents.size(); ++k) {
    const DependentNode& v = set_.dependents[k];
    Vec3d dx;
    for (std::size_t a = 0; a < v.hosts.size(); ++a) {
      const double* host = d.data() + set_.dofs.begin(v.hosts[a]);
      const FrameKind kind = set_.dofs.kind(v.hosts[a]);
      dx += Vec3d{{host[0], host[1], host[2]}} * v.w[a];
      if (kind == FrameKind::rigid)
        dx += cross(Vec3d{{host[3], host[4], host[5]}}, lever(k, a));
      else if (kind == FrameKind::affine)
        dx += frame_variation(kind, host + 3, {}) * lever(k, a);
    }
    double* own = d.data() + set_.dofs.begin(v.node);
    std::copy_n(dx.v, 3, own);
    if (v.turns) std::copy_n(d.data() + set_.dofs.begin(v.hosts[0]) + 3, 3, own + 3);
  }
}

void DependentNodes::transfer(std::span<double> g, std::span<double> forces) const {
  for (std::size_t k = set_.dependents.size(); k-- > 0;) {
    const DependentNode& v = set_.dependents[k];
    double* own = g.data() + set_.dofs.begin(v.node);
    const int m = dependent_dofs(v, set_.dofs);
    const Vec3d f{{own[0], own[1], own[2]}};
    for (std::size_t a = 0; a < v.hosts.size(); ++a) {
      double* host = g.data() + set_.dofs.begin(v.hosts[a]);
      for (int i = 0; i < 3; ++i) host[i] += v.w[a] * f[i];
      // The lever of a rigid frame is turned already.
      add_moment(set_.dofs.kind(v.hosts[a]), outer(f, lever(k, a)), Mat3d::identity(), host + 3);
      if (v.turns && a == 0)
        for (int i = 3; i < 6; ++i) host[i] += own[i];
    }
    if (!forces.empty()) std::fill_n(std::copy_n(own, m, forces.data() + 6 * k), 6 - m, 0.0);
    std::fill_n(own, m, 0.0);
  }
}

void DependentNodes::add_turning(std::span<const double> forces, std::vector<double>& node_blocks) const {
  for (std::size_t k = 0; k < set_.dependents.size(); ++k) {
    const DependentNode& v = set_.dependents[k];
    const Vec3d f{{forces[6 * k], forces[6 * k + 1], forces[6 * k + 2]}};
    for (std::size_t a = 0; a < v.hosts.size(); ++a)
      if (set_.dofs.kind(v.hosts[a]) == FrameKind::rigid)
        add_rotation_block(node_blocks.data() + set_.dofs.block_begin(v.hosts[a]),
                           rotation_tangent(outer(f, lever(k, a))));
  }
}

DependentNodes::Columns DependentNodes::columns_of(std::size_t dependent, std::size_t host) const {
  const DependentNode& v = set_.dependents[dependent];
  const FrameKind kind = set_.dofs.kind(v.hosts[host]);
  const Vec3d& b = lever(dependent, host);
  Columns J;
  J.count = dof_count(kind);
  for (int i = 0; i < 3; ++i) J.entry[i][i] = v.w[host];
  if (kind == FrameKind::rigid) {
    const Mat3d W = skew(b);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) J.entry[i][3 + j] = -W(i, j);
    if (v.turns && host == 0)
      for (int i = 3; i < 6; ++i) J.entry[i][i] = 1;
  } else if (kind == FrameKind::affine) {
    for (int q = 0; q < 3; ++q)
      for (int i = 0; i < 3; ++i) J.entry[i][3 + 3 * q + i] = b[q];
  }
  return J;
}

/// No free degree of the node was left when a dependent node's turn came.
bool DependentNodes::is_gone(int node, std::size_t dependent) const {
  const int other = dependent_[at(node)];
  return other >= 0 && at(other) > dependent &&
         dependent_dofs(set_.dependents[at(other)], set_.dofs) == set_.dofs.size(node);
}

void DependentNodes::condense(BlockMatrix& K) const {
  for (std::size_t k = set_.dependents.size(); k-- > 0;) condense_node(k, K);
}

/// With R the rows of the node that depend, V what they have with each other and J its hosts' columns,
///
///   K_au += J_aᵀ R_u and its transpose,   K_ab += J_aᵀ V J_b.
void DependentNodes::condense_node(std::size_t dependent, BlockMatrix& K) const {
  const DependentNode& v = set_.dependents[dependent];
  const DofLayout& dofs = set_.dofs;
  const int n = dofs.size(v.node), m = dependent_dofs(v, dofs);
  std::vector<Columns> J;
  for (std::size_t a = 0; a < v.hosts.size(); ++a) J.push_back(columns_of(dependent, a));
  double* own = K.block(K.diagonal(v.node));

  // K_au += P and K_ua += Pᵀ, of entries of u from `first` on; P = J_aᵀ R.
  const auto add = [&](std::size_t a, int u, const double* R, int first) {
    const int host = v.hosts[a], rows = J[a].count, columns = dofs.size(u);
    double *above = K.block(K.find(host, u)), *below = K.block(K.find(u, host));
    for (int i = 0; i < rows; ++i) {
      double P[kMostDofs] = {};
      for (int l = 0; l < m; ++l) {
        const double factor = J[a].entry[l][i];  // most are zero
        if (factor == 0) continue;
        for (int j = first; j < columns; ++j) P[j] += factor * R[columns * l + j];
      }
      for (int j = first; j < columns; ++j) {
        above[columns * i + j] += P[j];
        below[rows * j + i] += P[j];
      }
    }
  };
  const std::span<const int> columns = K.columns(v.node);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int u = columns[c];
    if (u == v.node || is_gone(u, dependent)) continue;
    double R[6 * kMostDofs];
    const int size = dofs.size(u);
    double *right = K.block(K.row_begin(v.node) + static_cast<int>(c)), *down = K.block(K.find(u, v.node));
    std::copy_n(right, m * size, R);
    std::fill_n(right, m * size, 0.0);
    for (int i = 0; i < size; ++i) std::fill_n(down + n * i, m, 0.0);
    for (std::size_t a = 0; a < v.hosts.size(); ++a) add(a, u, R, 0);
  }
  for (std::size_t a = 0; a < v.hosts.size() && m < n; ++a) add(a, v.node, own, m);
  for (std::size_t b = 0; b < v.hosts.size(); ++b) {
    double VJ[6][kMostDofs] = {};
    for (int i = 0; i < m; ++i)
      for (int l = 0; l < m; ++l)
        for (int j = 0; j < J[b].count; ++j) VJ[i][j] += own[n * i + l] * J[b].entry[l][j];
    for (std::size_t a = 0; a < v.hosts.size(); ++a) {
      double* block = K.block(K.find(v.hosts[a], v.hosts[b]));
      for (int i = 0; i < J[a].count; ++i)
        for (int l = 0; l < m; ++l) {
          const double factor = J[a].entry[l][i];
          if (factor == 0) continue;
          for (int j = 0; j < J[b].count; ++j) block[J[b].count * i + j] += factor * VJ[l][j];
        }
    }
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i < m || j < m) own[n * i + j] = 0;
}

}  // namespace fascia
