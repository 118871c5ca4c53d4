#include "core/tangent/condensation.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace fascia {

namespace {

/// Calls act(size) with the number of columns of a block, which the compiler knows where it is a usual one.
template <class Act>
void with_columns(int size, const Act& act) {
  if (size == 3)
    act(std::integral_constant<int, 3>{});
  else if (size == 6)
    act(std::integral_constant<int, 6>{});
  else
    act(size);
}

/// C += A B of blocks, A the first m columns of one whose rows are `stride` long.
/// @param first  row of A and C from which on, of n
void add_product(const double* A, int stride, int first, int n, int m, const double* B, int p, double* C) {
  with_columns(p, [&](auto columns) {
    for (int i = first; i < n; ++i)
      for (int l = 0; l < m; ++l)
        for (int j = 0; j < columns; ++j) C[columns * i + j] += A[stride * i + l] * B[columns * l + j];
  });
}

/// C += Aᵀ B of blocks m × n and m × p. Most entries of A are zero.
void add_transposed_product(const double* A, int m, int n, const double* B, int p, double* C) {
  with_columns(p, [&](auto columns) {
    for (int l = 0; l < m; ++l)
      for (int i = 0; i < n; ++i) {
        const double a = A[n * l + i];
        if (a == 0) continue;
        for (int j = 0; j < columns; ++j) C[columns * i + j] += a * B[columns * l + j];
      }
  });
}

/// Writes T out: rows of dependent nodes by the nodes that are left in the end, through hosts that depend in turn.
class Expansion {
 public:
  /// Holds how one dependent node follows one other node: m × the other's degrees of freedom.
  struct Term {
    int dependent, node;
    std::size_t values;  ///< where they begin
  };

  Expansion(const Dependents<PoolSpace>& dependents, const DofLayout& dofs)
      : set_(dependents.view()), dofs_(dofs), count_(dependents.count()), place_(at(dofs.node_count()), -1) {
    for (int k = 0; k < count_; ++k) place_[at(set_.node[k])] = k;
    renew();
  }
  /// Takes the rotations of the present; terms keep their places.
  void renew() {
    terms_.clear();
    values_.clear();
    begin_.assign(1, 0);
    for (int k = 0; k < count_; ++k) {  // hosts that depend come before
      for (int pair = set_.pair_begin[k]; pair < set_.pair_begin[k + 1]; ++pair) add_pair(k, pair);
      begin_.push_back(static_cast<int>(terms_.size()));
    }
  }

  int count() const { return count_; }
  /// Number of a dependent node; −1 of others.
  int place(int node) const { return place_[at(node)]; }
  int node(int k) const { return set_.node[k]; }
  int dofs(int k) const { return set_.turns[k] != 0 ? dofs_.size(set_.node[k]) : 3; }
  std::span<const Term> terms() const { return terms_; }
  std::span<const Term> terms(int k) const {
    return terms().subspan(at(begin_[at(k)]), at(begin_[at(k) + 1] - begin_[at(k)]));
  }
  const double* values(const Term& term) const { return values_.data() + term.values; }

 private:
  void add_pair(int k, int pair) {
    const int host = set_.host[pair], m = dofs(k), n = dofs_.size(host), other = place(host);
    double J[6 * kMostDofs] = {};
    for (int dof = 0; dof < n; ++dof) {
      double column[6] = {};
      set_.host_column(pair, dof, column);
      for (int i = 0; i < m; ++i) J[n * i + dof] = column[i];
    }
    if (other < 0) return add(values_of(k, host), J, m * n);
    const int followed = dofs(other);
    for (int t = begin_[at(other)]; t < begin_[at(other) + 1]; ++t) {
      const Term by = terms_[at(t)];
      double through[6 * kMostDofs] = {};
      add_product(J, n, 0, m, followed, values_.data() + by.values, dofs_.size(by.node), through);
      add(values_of(k, by.node), through, m * dofs_.size(by.node));
    }
    if (followed == n) return;
    for (int i = 0; i < m; ++i) std::fill_n(J + n * i, followed, 0.0);
    add(values_of(k, host), J, m * n);
  }
  static void add(double* to, const double* values, int count) {
    for (int i = 0; i < count; ++i) to[i] += values[i];
  }
  /// Returns the values of a dependent node that is being added.
  double* values_of(int k, int node) {
    for (auto t = terms_.begin() + begin_[at(k)]; t != terms_.end(); ++t)
      if (t->node == node) return values_.data() + t->values;
    terms_.push_back({k, node, values_.size()});
    values_.resize(values_.size() + at(dofs(k) * dofs_.size(node)));
    return values_.data() + terms_.back().values;
  }

  const DependentsView& set_;
  const DofLayout& dofs_;
  int count_;
  std::vector<int> place_, begin_;  ///< of each node; (dependents + 1) terms
  std::vector<Term> terms_;
  std::vector<double> values_;
};

/// Keeps the rows of K T of one dependent node, of its degrees of freedom that follow others.
struct DependentRows {
  std::vector<int> column;  ///< ascending
  std::vector<std::size_t> begin;
  std::vector<double> values;

  /// Makes room for so many rows of blocks in the columns that were added, all zero.
  void make_room(const DofLayout& dofs, int rows) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    begin.assign(1, 0);
    for (const int c : column) begin.push_back(begin.back() + at(rows * dofs.size(c)));
    values.assign(begin.back(), 0.0);
  }
  double* block(int c) {
    const auto place = std::lower_bound(column.begin(), column.end(), c) - column.begin();
    return values.data() + begin[at(static_cast<int>(place))];
  }
};

}  // namespace

/// Rows take what their own blocks with dependent nodes bring, each from itself; then nodes that others follow take
/// Tᵀ (K T) of these, some rows at a time. So each row has one writer, and sums have one order, whatever the number of
/// threads. Blocks on and below the diagonal are found, then mirrored.
class Condensation::Impl {
 public:
  Impl(const Dependents<PoolSpace>& dependents, const DofLayout& dofs, ThreadPool& pool, int at_once)
      : T_(dependents, dofs), dofs_(dofs), pool_(pool), rows_(at(std::min(T_.count(), at_once))) {
    by_node_begin_.assign(at(dofs.node_count()) + 1, 0);
    for (const Expansion::Term& t : T_.terms()) ++by_node_begin_[at(t.node) + 1];
    for (int i = 0; i < dofs.node_count(); ++i) by_node_begin_[at(i) + 1] += by_node_begin_[at(i)];
    for (int i = 0; i < dofs.node_count(); ++i)
      if (by_node_begin_[at(i)] < by_node_begin_[at(i) + 1]) followed_.push_back(i);
    by_node_.resize(T_.terms().size());
    std::vector<int> next(by_node_begin_.begin(), by_node_begin_.end() - 1);
    for (const Expansion::Term& t : T_.terms()) by_node_[at(next[at(t.node)]++)] = t;
  }

  void condense(BlockMatrix& K) {
    T_.renew();
    const auto for_rows = [&](const auto& act) {
      pool_.for_ranges(K.rows(), kGrain, [&](int begin, int end) {
        for (int row = begin; row < end; ++row) act(row);
      });
    };
    for_rows([&](int row) { replace_columns(row, K); });
    const int at_once = static_cast<int>(rows_.size());
    for (int first = 0; first < T_.count(); first += at_once) {
      const int end = std::min(T_.count(), first + at_once);
      pool_.for_ranges(end - first, kGrain, [&](int begin, int last) {
        for (int k = begin; k < last; ++k) take_rows(first + k, K, rows_[at(k)]);
      });
      pool_.for_ranges(static_cast<int>(followed_.size()), 1,
                       [&](int i, int) { add_followers(followed_[at(i)], first, end, K); });
    }
    for_rows([&](int row) { mirror_diagonal(row, K); });
    K.mirror_lower(pool_);
    K.set_condensed(true);
  }

 private:
  static constexpr int kGrain = 16;

  /// First degree of freedom of a node that does not depend.
  int first_own(int node) const { return T_.place(node) < 0 ? 0 : T_.dofs(T_.place(node)); }

  /// Adds K_rd T_ds to K_rs, of the row's own degrees of freedom.
  void replace_columns(int row, BlockMatrix& K) const {
    const int first = first_own(row), n = dofs_.size(row);
    for (int index = K.row_begin(row); index < K.row_begin(row + 1) && first < n; ++index) {
      const int k = T_.place(K.column(index));
      if (k < 0) continue;
      double* block = K.block(index);
      const int stride = dofs_.size(K.column(index)), m = T_.dofs(k);
      for (const Expansion::Term& t : T_.terms(k))
        if (t.node <= row)
          add_product(block, stride, first, n, m, T_.values(t), dofs_.size(t.node), K.block(K.find(row, t.node)));
      for (int i = first; i < n; ++i) std::fill_n(block + stride * i, m, 0.0);
    }
  }

  /// Moves the dependent rows of a node into rows of K T.
  void take_rows(int k, BlockMatrix& K, DependentRows& rows) const {
    const int node = T_.node(k), m = T_.dofs(k);
    rows.column.clear();
    for (const int c : K.columns(node)) {
      const int other = T_.place(c);
      if (first_own(c) < dofs_.size(c)) rows.column.push_back(c);
      if (other < 0) continue;
      for (const Expansion::Term& t : T_.terms(other)) rows.column.push_back(t.node);
    }
    rows.make_room(dofs_, m);
    for (int index = K.row_begin(node); index < K.row_begin(node + 1); ++index) {
      const int c = K.column(index), size = dofs_.size(c), own = first_own(c);
      double* block = K.block(index);
      if (own < size) {
        double* to = rows.block(c);
        for (int i = 0; i < m; ++i)
          for (int j = own; j < size; ++j) to[size * i + j] += block[size * i + j];
      }
      if (own > 0)
        for (const Expansion::Term& t : T_.terms(T_.place(c)))
          add_product(block, size, 0, m, own, T_.values(t), dofs_.size(t.node), rows.block(t.node));
      std::fill_n(block, m * size, 0.0);
    }
  }

  /// Adds T_drᵀ (K T)_ds to K_rs, of the dependent nodes d from `first` to `end` that follow the row's.
  void add_followers(int row, int first, int end, BlockMatrix& K) const {
    const std::span<const Expansion::Term> all = std::span(by_node_).subspan(
        at(by_node_begin_[at(row)]), at(by_node_begin_[at(row) + 1] - by_node_begin_[at(row)]));
    const auto before = [](const Expansion::Term& t, int k) { return t.dependent < k; };
    const auto from = std::lower_bound(all.begin(), all.end(), first, before);
    for (auto t = from; t != all.end() && t->dependent < end; ++t) {
      const DependentRows& rows = rows_[at(t->dependent - first)];
      for (std::size_t c = 0; c < rows.column.size() && rows.column[c] <= row; ++c)
        add_transposed_product(T_.values(*t), T_.dofs(t->dependent), dofs_.size(row),
                               rows.values.data() + rows.begin[c], dofs_.size(rows.column[c]),
                               K.block(K.find(row, rows.column[c])));
    }
  }

  void mirror_diagonal(int row, BlockMatrix& K) const {
    const int n = dofs_.size(row);
    double* own = K.block(K.diagonal(row));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) own[n * j + i] = own[n * i + j];
  }

  Expansion T_;
  const DofLayout& dofs_;
  ThreadPool& pool_;
  std::vector<int> by_node_begin_, followed_;  ///< followed_: nodes that others follow
  std::vector<Expansion::Term> by_node_;       ///< by the node that is followed, then in their order
  std::vector<DependentRows> rows_;
};

Condensation::Condensation(const Dependents<PoolSpace>& dependents, const DofLayout& dofs, ThreadPool& pool,
                           int at_once)
    : impl_(dependents.empty() ? nullptr : std::make_unique<Impl>(dependents, dofs, pool, at_once)) {}
Condensation::~Condensation() = default;

void Condensation::condense(BlockMatrix& K) {
  if (impl_ != nullptr) impl_->condense(K);
}

}  // namespace fascia
