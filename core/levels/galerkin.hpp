#pragma once

#include "core/base/thread_pool.hpp"
#include "core/levels/aggregation.hpp"
#include "core/levels/block_rows.hpp"
#include "core/node/positive_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace fascia::galerkin {

/// Loops are cut into so many chunks, whatever the number of threads: each has slots of its own.
inline constexpr int kChunks = 64;

/// Where a chunk of n items begins.
inline int chunk_begin(int n, int chunk) { return static_cast<int>(static_cast<std::int64_t>(n) * chunk / kChunks); }

/// Coarse columns in the order in which they are met, with a slot for each; cleared by itself.
class Slots {
 public:
  explicit Slots(int columns) : slot_(at(columns), -1) {}
  int add(int column) {
    int& slot = slot_[at(column)];
    if (slot < 0) {
      slot = static_cast<int>(met_.size());
      met_.push_back(column);
    }
    return slot;
  }
  int slot(int column) const { return slot_[at(column)]; }
  const std::vector<int>& met() const { return met_; }
  void clear() {
    for (const int column : met_) slot_[at(column)] = -1;
    met_.clear();
  }
  /// From now on slots follow ascending columns.
  void sort() {
    std::sort(met_.begin(), met_.end());
    for (std::size_t k = 0; k < met_.size(); ++k) slot_[at(met_[k])] = static_cast<int>(k);
  }

 private:
  std::vector<int> slot_, met_;
};

/// Rows from chunks that were made side by side.
inline BlockRows joined(std::vector<BlockRows>& parts) {
  BlockRows all;
  std::size_t columns = 0, values = 0, rows = 0;
  for (const BlockRows& p : parts) rows += at(p.rows()), columns += p.column.size(), values += p.values.size();
  all.begin.reserve(rows + 1), all.value_begin.reserve(rows + 1);
  all.column.reserve(columns), all.values.reserve(values);
  for (BlockRows& p : parts) {
    const int before = static_cast<int>(all.column.size());
    const std::size_t values_before = all.values.size();
    for (std::size_t k = 1; k < p.begin.size(); ++k) {
      all.begin.push_back(before + p.begin[k]);
      all.value_begin.push_back(values_before + p.value_begin[k]);
    }
    all.column.insert(all.column.end(), p.column.begin(), p.column.end());
    all.values.insert(all.values.end(), p.values.begin(), p.values.end());
    p = {};
  }
  return all;
}

/// P = (I − omega D⁻¹ K) T by rows. @param tentative  tentative(i, T) gives the block of a node in an aggregate, size ×
/// 6
/// @param inverse  inverse(i): the block D⁻¹ of a node
template <class Matrix, class Tentative, class Inverse>
BlockRows smoothed(const Matrix& K, ThreadPool& pool, const Aggregates& groups, double omega,
                   const Tentative& tentative, const Inverse& inverse) {
  std::vector<BlockRows> parts(kChunks);
  pool.for_chunks(kChunks, [&](int chunk) {
    BlockRows& out = parts[at(chunk)];
    Slots slots(groups.count);
    std::vector<double> KT;
    for (int i = chunk_begin(K.rows(), chunk); i < chunk_begin(K.rows(), chunk + 1); ++i) {
      const int n = K.size(i), own = groups.of_node[at(i)];
      const unsigned fixed = K.fixed(i);
      slots.clear();
      if (fixed != (1U << n) - 1)
        K.for_each_column(i, [&](int j) {
          if (groups.of_node[at(j)] >= 0) slots.add(groups.of_node[at(j)]);
        });
      slots.sort();
      const std::size_t size = at(n * kFrameDofs);
      KT.assign(slots.met().size() * size, 0.0);
      if (!slots.met().empty())
        K.for_each_block(i, [&](int j, const double* B) {
          const int group = groups.of_node[at(j)];
          if (group < 0) return;
          double T[kMostDofs * kFrameDofs];
          tentative(j, T);
          add_matrix_product(B, n, K.size(j), T, KT.data() + at(slots.slot(group)) * size);
        });
      const double* D = inverse(i);
      for (std::size_t k = 0; k < slots.met().size(); ++k) {
        double P[kMostDofs * kFrameDofs] = {};
        if (slots.met()[k] == own) tentative(i, P);
        const double* sum = KT.data() + k * size;
        for (int a = 0; a < n; ++a) {
          for (int b = 0; b < n; ++b)
            for (int c = 0; c < kFrameDofs; ++c)
              P[kFrameDofs * a + c] -= omega * D[n * a + b] * sum[kFrameDofs * b + c];
          if (((fixed >> a) & 1U) != 0) std::fill(P + kFrameDofs * a, P + kFrameDofs * (a + 1), 0.0);
        }
        out.column.push_back(slots.met()[k]);
        out.values.insert(out.values.end(), P, P + size);
      }
      out.begin.push_back(static_cast<int>(out.column.size()));
      out.value_begin.push_back(out.values.size());
    }
  });
  return joined(parts);
}

/// Where each coarse column stands in the rows of P: (row, place in the row), rows ascending.
struct Transposed {
  std::vector<int> begin, row, place;

  Transposed(const BlockRows& P, int columns) : begin(at(columns) + 1, 0), row(P.column.size()), place(row) {
    for (const int c : P.column) ++begin[at(c) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (int i = 0; i < P.rows(); ++i) {
      const std::span<const int> columns_of_row = P.columns(i);
      for (std::size_t k = 0; k < columns_of_row.size(); ++k) {
        const std::size_t to = at(next[at(columns_of_row[k])]++);
        row[to] = i;
        place[to] = static_cast<int>(k);
      }
    }
  }
};

/// Row i of K P: columns as they are met, blocks size(i) × 6.
template <class Matrix>
void row_of_product(const Matrix& K, const BlockRows& P, int i, Slots& slots, std::vector<double>& KP) {
  slots.clear();
  K.for_each_column(i, [&](int j) {
    for (const int c : P.columns(j)) slots.add(c);
  });
  const int n = K.size(i);
  const std::size_t size = at(n * kFrameDofs);
  KP.assign(slots.met().size() * size, 0.0);
  K.for_each_block(i, [&](int j, const double* B) {
    const int m = K.size(j);
    const std::span<const int> columns = P.columns(j);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double* p = P.block(j, static_cast<int>(k), m);
      add_matrix_product(B, n, m, p, KP.data() + at(slots.slot(columns[k])) * size);
    }
  });
}

/// Rows of a symmetric matrix of N × N blocks from those of its upper half, whose columns come in any order. They are
/// used up.
template <int N>
void mirror(std::vector<std::vector<int>>& columns, std::vector<std::vector<double>>& blocks, std::vector<int>& begin,
            std::vector<int>& column, AlignedVector<double>& values) {
  constexpr std::size_t kSize = N * N;
  const std::size_t rows = columns.size();
  std::vector<int> next(rows + 1, 0);
  for (std::size_t I = 0; I < rows; ++I)
    for (const int J : columns[I]) {
      ++next[I + 1];
      if (at(J) != I) ++next[at(J) + 1];
    }
  std::partial_sum(next.begin(), next.end(), next.begin());
  begin = next;
  column.resize(at(next[rows]));
  values.resize(kSize * at(next[rows]));
  // What a row has of the lower half comes from rows above, in their order, before its own half begins.
  std::vector<int> order;
  for (std::size_t I = 0; I < rows; ++I) {
    order.resize(columns[I].size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return columns[I][at(a)] < columns[I][at(b)]; });
    for (const int k : order) {
      const int J = columns[I][at(k)];
      const double* block = blocks[I].data() + at(k) * kSize;
      const std::size_t own = at(next[I]++);
      column[own] = J;
      std::copy(block, block + kSize, values.data() + own * kSize);
      if (at(J) == I) continue;
      const std::size_t other = at(next[at(J)]++);
      column[other] = static_cast<int>(I);
      double* turned = values.data() + other * kSize;
      for (int a = 0; a < N; ++a)
        for (int b = 0; b < N; ++b) turned[N * b + a] = block[N * a + b];
    }
    columns[I] = std::vector<int>();  // {} would keep the memory
    blocks[I] = std::vector<double>();
  }
}

/// D⁻¹ of each node of a matrix, with 1 in the place of what is fixed.
template <class Matrix>
std::vector<double> inverse_diagonal(const Matrix& K, ThreadPool& pool) {
  std::vector<double> inverse(K.block_begin(K.rows()));
  pool.for_ranges(K.rows(), 64, [&](int first, int end) {
    for (int row = first; row < end; ++row)
      K.for_each_block(row, [&](int column, const double* B) {
        if (column != row) return;
        const int n = K.size(row);
        double* D = inverse.data() + K.block_begin(row);
        std::copy(B, B + n * n, D);
        for (int k = 0; k < n; ++k)
          if (((K.fixed(row) >> k) & 1U) != 0) D[(n + 1) * k] = 1;
        positive_inverse(D, n);
      });
  });
  return inverse;
}

/// Pᵀ K P of a symmetric K. Rows of K P are made for a few thousand nodes at a time, by node; then each coarse row adds
/// what is its own of them, in ascending order of nodes, from its diagonal on.
template <class Matrix>
BlockRows product(const Matrix& K, const BlockRows& P, ThreadPool& pool, int coarse) {
  constexpr int kRowsAtOnce = 2048;
  struct Row {
    std::vector<int> column;
    std::vector<double> value;
  };
  const Transposed of_column(P, coarse);
  std::vector<std::vector<int>> pattern(at(coarse));
  std::vector<std::vector<double>> sums(at(coarse));
  std::vector<int> next(of_column.begin.begin(), of_column.begin.end() - 1);
  std::vector<Row> made(at(std::min(kRowsAtOnce, K.rows())));
  std::vector<Slots> own(kChunks, Slots(coarse));
  Slots reached(coarse);
  for (int from = 0; from < K.rows(); from += kRowsAtOnce) {
    const int to = std::min(K.rows(), from + kRowsAtOnce);
    pool.for_chunks(kChunks, [&](int chunk) {
      Slots& slots = own[at(chunk)];
      for (int k = chunk_begin(to - from, chunk); k < chunk_begin(to - from, chunk + 1); ++k) {
        Row& row = made[at(k)];
        if (P.columns(from + k).empty()) continue;
        row_of_product(K, P, from + k, slots, row.value);
        row.column = slots.met();
      }
    });
    reached.clear();
    for (int i = from; i < to; ++i)
      for (const int column : P.columns(i)) reached.add(column);
    const int rows = static_cast<int>(reached.met().size());
    pool.for_chunks(kChunks, [&](int chunk) {
      Slots& slots = own[at(chunk)];
      for (int c = chunk_begin(rows, chunk); c < chunk_begin(rows, chunk + 1); ++c) {
        const int I = reached.met()[at(c)];
        int& k = next[at(I)];
        slots.clear();
        for (const int column : pattern[at(I)]) slots.add(column);
        for (; k < of_column.begin[at(I + 1)] && of_column.row[at(k)] < to; ++k) {
          const int i = of_column.row[at(k)], n = K.size(i);
          const double* p = P.block(i, of_column.place[at(k)], n);
          const Row& row = made[at(i - from)];
          for (std::size_t b = 0; b < row.column.size(); ++b) {
            if (row.column[b] < I) continue;
            const std::size_t slot = at(slots.add(row.column[b])) * kFrameDofs * kFrameDofs;
            if (sums[at(I)].size() <= slot) sums[at(I)].resize(slot + kFrameDofs * kFrameDofs, 0.0);
            add_transposed_matrix_product(p, n, row.value.data() + b * at(n * kFrameDofs), sums[at(I)].data() + slot);
          }
        }
        pattern[at(I)] = slots.met();
      }
    });
  }
  BlockRows out;
  mirror<kFrameDofs>(pattern, sums, out.begin, out.column, out.values);
  out.value_begin.reserve(out.begin.size());
  for (const int k : std::span(out.begin).subspan(1)) out.value_begin.push_back(at(kFrameDofs * kFrameDofs * k));
  return out;
}

}  // namespace fascia::galerkin
