#pragma once

#include "core/base/thread_pool.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

/// A Cholesky factor L by supernodes: runs of columns that share their rows below. The numbers of one lie by columns,
/// as a dense matrix whose first rows are its own columns; what is above its diagonal is not read.
template <class T>
struct Supernodes {
  std::span<const int> first_column;          ///< of each, and of the end
  std::span<const std::int64_t> row_begin;    ///< of each in `row`, and of the end
  std::span<const std::int64_t> value_begin;  ///< of each in `value`, and of the end
  std::span<const int> row;                   ///< of L, ascending in each
  std::span<const T> value;
  std::span<const double> sign = {};  ///< of each column; none: all are positive
};

/// Solves with a factor of one pattern: L S Lᵀ x = b in place, with S = diag(±1). Each number of L is read once for
/// each triangle, four columns together: a direct solve with one right-hand side waits for memory, not for
/// multiplications. Subtrees of the elimination tree, which need nothing of one another, go to threads; what stands on
/// top of them follows. Which they are depends on the pattern alone, so that results do not depend on the number of
/// threads.
class SupernodeSolver {
 public:
  SupernodeSolver() = default;
  template <class T>
  explicit SupernodeSolver(const Supernodes<T>& pattern) {
    find_subtrees(pattern.first_column, pattern.row_begin, pattern.value_begin, pattern.row);
  }

  /// @tparam T  numbers of L: double, or float, which is half as much to read; they are multiplied and added in 64 bits
  template <class T>
  void solve(const Supernodes<T>& L, ThreadPool* pool, std::span<double> x);

  int subtrees() const { return static_cast<int>(subtree_.size()); }

 private:
  /// Supernodes [begin, end), of columns that end there.
  struct Subtree {
    int begin, end, end_column;
  };
  void find_subtrees(std::span<const int> first_column, std::span<const std::int64_t> row_begin,
                     std::span<const std::int64_t> value_begin, std::span<const int> row);
  void keep_large(std::span<const std::int64_t> value_begin, double most);

  std::vector<Subtree> subtree_;  ///< ascending
  std::vector<int> top_;          ///< supernodes of none of them, ascending
  std::vector<int> top_column_;   ///< their columns
  std::vector<int> place_;        ///< of each column among these
  std::size_t most_rows_ = 0;
  std::vector<double> work_;  ///< (subtrees + 1) × most_rows
  std::vector<double> sums_;  ///< (subtrees × top columns) what they have for these
};

}  // namespace fascia
