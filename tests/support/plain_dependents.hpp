#pragma once

#include "core/node/node_force.hpp"
#include "core/structure/model.hpp"

#include <algorithm>
#include <vector>

namespace fascia::test {

/// Dependent nodes as their formulas say, one after the other: an oracle that shares no loop with Dependents.
class PlainDependents {
 public:
  PlainDependents(const PointSet& set, const State& state) : set_(set), Q_(state.u.size()) {
    for (std::size_t i = 0; i < Q_.size(); ++i) Q_[i] = Mat3d::identity() + state.D[i];
  }

  static void place(const PointSet& set, std::vector<Vec3d>& u, FrameMatrices& D) {
    for (const DependentNode& d : set.dependents) {
      Vec3d place;
      for (std::size_t k = 0; k < d.hosts.size(); ++k)
        place += u[at(d.hosts[k])] * d.w[k] + std::as_const(D)[at(d.hosts[k])] * d.b[k];
      u[at(d.node)] = place;
      if (d.turns) D[at(d.node)] = D[at(d.hosts[0])];
    }
  }

  void expand(std::vector<double>& d) const {
    for (const DependentNode& v : set_.dependents) {
      Vec3d dx;
      for (std::size_t a = 0; a < v.hosts.size(); ++a) {
        const double* host = d.data() + set_.dofs.begin(v.hosts[a]);
        const auto i = at(v.hosts[a]);
        dx += Vec3d{{host[0], host[1], host[2]}} * v.w[a] +
              frame_variation(set_.dofs.kind(v.hosts[a]), host + 3, Q_[i]) * v.b[a];
      }
      double* own = d.data() + set_.dofs.begin(v.node);
      std::copy_n(dx.v, 3, own);
      if (v.turns) std::copy_n(d.data() + set_.dofs.begin(v.hosts[0]) + 3, 3, own + 3);
    }
  }

  /// @param forces  (dependents × 6) takes what each hands on
  void transfer(std::vector<double>& g, std::vector<double>& forces) const {
    for (std::size_t k = set_.dependents.size(); k-- > 0;) {
      const DependentNode& v = set_.dependents[k];
      double* own = g.data() + set_.dofs.begin(v.node);
      const int m = dependent_dofs(v, set_.dofs);
      const Vec3d f{{own[0], own[1], own[2]}};
      for (std::size_t a = 0; a < v.hosts.size(); ++a) {
        double* host = g.data() + set_.dofs.begin(v.hosts[a]);
        for (int i = 0; i < 3; ++i) host[i] += v.w[a] * f[i];
        add_moment(set_.dofs.kind(v.hosts[a]), outer(f, v.b[a]), Q_[at(v.hosts[a])], host + 3);
        for (int i = 3; v.turns && a == 0 && i < 6; ++i) host[i] += own[i];
      }
      std::fill_n(std::copy_n(own, m, forces.data() + 6 * k), 6 - m, 0.0);
      std::fill_n(own, m, 0.0);
    }
  }

  void add_turning(const std::vector<double>& forces, std::vector<double>& node_blocks) const {
    for (std::size_t k = 0; k < set_.dependents.size(); ++k) {
      const DependentNode& v = set_.dependents[k];
      const Vec3d f{{forces[6 * k], forces[6 * k + 1], forces[6 * k + 2]}};
      for (std::size_t a = 0; a < v.hosts.size(); ++a)
        if (set_.dofs.kind(v.hosts[a]) == FrameKind::rigid)
          add_rotation_block(node_blocks.data() + set_.dofs.block_begin(v.hosts[a]),
                             rotation_tangent(outer(f, Q_[at(v.hosts[a])] * v.b[a])));
    }
  }

 private:
  const PointSet& set_;
  std::vector<Mat3d> Q_;
};

}  // namespace fascia::test
