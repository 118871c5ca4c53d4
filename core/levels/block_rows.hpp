#pragma once

#include "core/base/aligned.hpp"
#include "core/base/index.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/node/dof_filter.hpp"

#include <algorithm>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace fascia {

/// Degrees of freedom of a node of a coarse level: a rigid frame.
inline constexpr int kFrameDofs = 6;

/// A matrix whose columns are rigid frames, by rows of blocks: block k has as many rows as its node has degrees of
/// freedom, and six columns.
struct BlockRows {
  std::vector<int> begin{0}, column;        ///< (rows + 1), columns ascending in each row
  std::vector<std::size_t> value_begin{0};  ///< of each row
  AlignedVector<double> values;

  int rows() const { return static_cast<int>(begin.size()) - 1; }
  std::span<const int> columns(int row) const {
    return std::span(column).subspan(at(begin[at(row)]), at(begin[at(row + 1)] - begin[at(row)]));
  }
  double* block(int row, int k, int size) { return values.data() + value_begin[at(row)] + at(k * size * kFrameDofs); }
  const double* block(int row, int k, int size) const {
    return values.data() + value_begin[at(row)] + at(k * size * kFrameDofs);
  }
};

/// Whole rows of a BlockMatrix in constraint axes, without prescribed degrees of freedom and nodes that depend on
/// others, whichever of its blocks are stored.
class FineRows {
 public:
  FineRows(const BlockMatrix& matrix, const DofFilter& filter) : matrix_(matrix), filter_(filter), fixed_(at(rows())) {
    for (int row = 0; row < rows(); ++row) fixed_[at(row)] = filter.fixed_of(row);
    find_lower();
  }

  int rows() const { return matrix_.rows(); }
  int size(int row) const { return matrix_.dofs().size(row); }
  int largest_size() const {
    int largest = 0;
    for (int row = 0; row < rows(); ++row) largest = std::max(largest, size(row));
    return largest;
  }
  int begin(int row) const { return matrix_.dofs().begin(row); }
  std::size_t block_begin(int row) const { return matrix_.dofs().block_begin(row); }  ///< of the diagonal's blocks
  unsigned fixed(int row) const { return fixed_[at(row)]; }

  /// Calls act(column) for each block of a row.
  template <class Act>
  void for_each_column(int row, const Act& act) const {
    if (matrix_.fills_upper()) {
      for (int k = lower_begin_[at(row)]; k < lower_begin_[at(row + 1)]; ++k) act(lower_column_[at(k)]);
      for (const int column : matrix_.columns(row))
        if (column >= row) act(column);
    } else {
      matrix_.for_each_left(row, [&](int k) { act(matrix_.column(k)); });
    }
  }

  /// Calls act(column, block) for each block of a row; block: size(row) × size(column).
  template <class Act>
  void for_each_block(int row, const Act& act) const {
    double block[kMostDofs * kMostDofs];
    if (matrix_.fills_upper())
      for (int k = lower_begin_[at(row)]; k < lower_begin_[at(row + 1)]; ++k) {
        const int column = lower_column_[at(k)], n = size(row), m = size(column);
        double copy[kMostDofs * kMostDofs];
        const double* above = taken(column, row, matrix_.block(lower_block_[at(k)]), copy);
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < m; ++j) block[m * i + j] = above[n * j + i];
        act(column, block);
      }
    matrix_.for_each_left(row, [&](int k) {
      const int column = matrix_.column(k);
      if (matrix_.fills_upper() && column < row) return;
      act(column, taken(row, column, matrix_.block(k), block));
    });
  }

 private:
  void find_lower();
  /// A stored block in constraint axes, zero where a degree of freedom is prescribed: itself, or what was made in
  /// `copy`.
  const double* taken(int row, int column, const double* stored, double* copy) const;

  const BlockMatrix& matrix_;
  const DofFilter& filter_;
  std::vector<unsigned> fixed_;  ///< bit k: the degree of freedom k of a node is prescribed
  std::vector<int> lower_begin_, lower_column_,
      lower_block_;  ///< blocks below the diagonal, where those are not stored
};

/// A symmetric matrix of rigid frames, all blocks stored.
class FrameMatrix {
 public:
  explicit FrameMatrix(BlockRows blocks, std::vector<unsigned> fixed)
      : blocks_(std::move(blocks)), fixed_(std::move(fixed)) {}

  int rows() const { return blocks_.rows(); }
  static int size(int) { return kFrameDofs; }
  static int begin(int row) { return kFrameDofs * row; }
  static std::size_t block_begin(int row) { return at(kFrameDofs * kFrameDofs * row); }
  unsigned fixed(int row) const { return fixed_[at(row)]; }
  template <class Act>
  void for_each_column(int row, const Act& act) const {
    for (const int column : blocks_.columns(row)) act(column);
  }
  template <class Act>
  void for_each_block(int row, const Act& act) const {
    const std::span<const int> columns = blocks_.columns(row);
    for (std::size_t k = 0; k < columns.size(); ++k)
      act(columns[k], blocks_.block(row, static_cast<int>(k), kFrameDofs));
  }
  const BlockRows& blocks() const { return blocks_; }

 private:
  BlockRows blocks_;
  std::vector<unsigned> fixed_;  ///< bit k: the degree of freedom k of a node is none
};

/// C += A B of blocks n × m and m × 6.
inline void add_matrix_product(const double* A, int n, int m, const double* B, double* C) {
  const auto sized = [&](auto N, auto M) {
    for (int i = 0; i < N; ++i)
      for (int k = 0; k < M; ++k) {
        const double a = A[M * i + k];
        for (int j = 0; j < kFrameDofs; ++j) C[kFrameDofs * i + j] += a * B[kFrameDofs * k + j];
      }
  };
  if (n == 6 && m == 6)
    sized(std::integral_constant<int, 6>{}, std::integral_constant<int, 6>{});
  else if (n == 3 && m == 3)
    sized(std::integral_constant<int, 3>{}, std::integral_constant<int, 3>{});
  else
    sized(n, m);
}

/// C += Aᵀ B of blocks n × 6 and n × 6.
inline void add_transposed_matrix_product(const double* A, int n, const double* B, double* C) {
  const auto sized = [&](auto N) {
    for (int i = 0; i < kFrameDofs; ++i) {
      double sum[kFrameDofs] = {};
      for (int k = 0; k < N; ++k)
        for (int j = 0; j < kFrameDofs; ++j) sum[j] += A[kFrameDofs * k + i] * B[kFrameDofs * k + j];
      for (int j = 0; j < kFrameDofs; ++j) C[kFrameDofs * i + j] += sum[j];
    }
  };
  if (n == 3)
    sized(std::integral_constant<int, 3>{});
  else if (n == 6)
    sized(std::integral_constant<int, 6>{});
  else
    sized(n);
}

}  // namespace fascia
