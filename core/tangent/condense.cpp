#include "core/tangent/condense.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <vector>

namespace fascia {

namespace {

/// One host's part of J, by rows.
struct Columns {
  int count = 0;  ///< degrees of freedom of the host
  double entry[6][kMostDofs] = {};

  Columns(const DependentsView& set, int pair) : count(dof_count(set.kind[pair])) {
    for (int dof = 0; dof < count; ++dof) {
      double column[6] = {};
      set.host_column(pair, dof, column);
      for (int i = 0; i < 6; ++i) entry[i][dof] = column[i];
    }
  }
};

class Condensation {
 public:
  Condensation(const Dependents<PoolSpace>& dependents, BlockMatrix& K)
      : set_(dependents.view()), K_(K), place_(at(K.dofs().node_count()), -1), in_order_(at(dependents.count())) {
    for (int k = 0; k < dependents.count(); ++k) {
      place_[at(set_.node[k])] = set_.index[k];
      in_order_[at(set_.index[k])] = k;
    }
  }

  /// In the order for which the matrix has places: those that depend go before their hosts.
  void condense() {
    for (std::size_t i = in_order_.size(); i-- > 0;) condense_node(in_order_[i]);
  }

 private:
  /// With R the rows of the node that depend, V what they have with each other and J its hosts' columns,
  ///
  ///   K_au += J_aᵀ R_u and its transpose,   K_ab += J_aᵀ V J_b.
  void condense_node(int dependent) {
    const DofLayout& dofs = K_.dofs();
    const int node = set_.node[dependent], n = dofs.size(node), m = dofs_of(dependent);
    const int first = set_.pair_begin[dependent], hosts = set_.pair_begin[dependent + 1] - first;
    J_.clear();
    for (int a = 0; a < hosts; ++a) J_.emplace_back(set_, first + a);
    const auto host = [&](int a) { return set_.host[first + a]; };
    double* own = K_.block(K_.diagonal(node));

    // K_au += P and K_ua += Pᵀ, of entries of u from `from` on; P = J_aᵀ R.
    const auto add = [&](int a, int u, const double* R, int from) {
      const int rows = J_[at(a)].count, columns = dofs.size(u);
      double *above = K_.block(K_.find(host(a), u)), *below = K_.block(K_.find(u, host(a)));
      for (int i = 0; i < rows; ++i) {
        double P[kMostDofs] = {};
        for (int l = 0; l < m; ++l) {
          const double factor = J_[at(a)].entry[l][i];  // most are zero
          if (factor == 0) continue;
          for (int j = from; j < columns; ++j) P[j] += factor * R[columns * l + j];
        }
        for (int j = from; j < columns; ++j) {
          above[columns * i + j] += P[j];
          below[rows * j + i] += P[j];
        }
      }
    };
    const std::span<const int> columns = K_.columns(node);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const int u = columns[c];
      if (u == node || is_gone(u, dependent)) continue;
      double R[6 * kMostDofs];
      const int size = dofs.size(u);
      double *right = K_.block(K_.row_begin(node) + static_cast<int>(c)), *down = K_.block(K_.find(u, node));
      std::copy_n(right, m * size, R);
      std::fill_n(right, m * size, 0.0);
      for (int i = 0; i < size; ++i) std::fill_n(down + n * i, m, 0.0);
      for (int a = 0; a < hosts; ++a) add(a, u, R, 0);
    }
    for (int a = 0; a < hosts && m < n; ++a) add(a, node, own, m);
    for (int b = 0; b < hosts; ++b) {
      const Columns& right = J_[at(b)];
      double VJ[6][kMostDofs] = {};
      for (int i = 0; i < m; ++i)
        for (int l = 0; l < m; ++l)
          for (int j = 0; j < right.count; ++j) VJ[i][j] += own[n * i + l] * right.entry[l][j];
      for (int a = 0; a < hosts; ++a) {
        double* block = K_.block(K_.find(host(a), host(b)));
        for (int i = 0; i < J_[at(a)].count; ++i)
          for (int l = 0; l < m; ++l) {
            const double factor = J_[at(a)].entry[l][i];
            if (factor == 0) continue;
            for (int j = 0; j < right.count; ++j) block[right.count * i + j] += factor * VJ[l][j];
          }
      }
    }
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (i < m || j < m) own[n * i + j] = 0;
  }

  int dofs_of(int dependent) const { return set_.turns[dependent] != 0 ? K_.dofs().size(set_.node[dependent]) : 3; }
  /// No free degree of the node was left when a dependent node's turn came.
  bool is_gone(int node, int dependent) const {
    const int other = place_[at(node)];
    return other > set_.index[dependent] && dofs_of(in_order_[at(other)]) == K_.dofs().size(node);
  }

  const DependentsView& set_;
  BlockMatrix& K_;
  std::vector<int> place_;     ///< of each node in PointSet::dependents, −1: none
  std::vector<int> in_order_;  ///< dependents of the view by that place
  std::vector<Columns> J_;     ///< of the hosts of a node
};

}  // namespace

void condense(const Dependents<PoolSpace>& dependents, BlockMatrix& K) {
  if (dependents.empty()) return;
  Condensation(dependents, K).condense();
}

}  // namespace fascia
