#pragma once

#include "core/base/thread_pool.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace fascia {

/// A Cholesky factor L by supernodes: runs of columns that share their rows below. The numbers of one lie by columns,
/// as a dense matrix whose first rows are its own columns; what is above its diagonal is not read.
/// @tparam Int  of places in `value`, of which there may be more than 32 bits count: int or std::int64_t
template <class T, class Int = int>
struct Supernodes {
  std::span<const Int> first_column;  ///< of each, and of the end
  std::span<const Int> row_begin;     ///< of each in `row`, and of the end
  std::span<const Int> value_begin;   ///< of each in `value`, and of the end
  std::span<const Int> row;           ///< of L, ascending in each
  std::span<const T> value;
};

/// Solves with a factor of one pattern: L Lᵀ x = b in place. Each number of L is read once for each triangle, four
/// columns together: a direct solve with one right-hand side waits for memory, not for multiplications. Subtrees of the
/// elimination tree, which need nothing of one another, go to threads; what stands on top of them follows. Which they
/// are depends on the pattern alone, so that results do not depend on the number of threads.
class SupernodeSolver {
 public:
  SupernodeSolver() = default;
  template <class T, class Int>
  explicit SupernodeSolver(const Supernodes<T, Int>& pattern) {
    find_subtrees(pattern.first_column, pattern.row_begin, pattern.value_begin, pattern.row);
  }

  /// @tparam T  numbers of L: double, or float, which is half as much to read; they are multiplied and added in 64 bits
  template <class T, class Int>
  void solve(const Supernodes<T, Int>& L, ThreadPool* pool, std::span<double> x);

  int subtrees() const { return static_cast<int>(subtree_.size()); }

 private:
  /// Supernodes [begin, end), of columns that end there.
  struct Subtree {
    int begin, end, end_column;
  };
  template <class Int>
  void find_subtrees(std::span<const Int> first_column, std::span<const Int> row_begin,
                     std::span<const Int> value_begin, std::span<const Int> row);
  template <class Int>
  void keep_large(std::span<const Int> value_begin, double most);

  std::vector<Subtree> subtree_;  ///< ascending
  std::vector<int> top_;          ///< supernodes of none of them, ascending
  std::vector<int> top_column_;   ///< their columns
  std::vector<int> place_;        ///< of each column among these
  std::size_t most_rows_ = 0;
  std::vector<double> work_;  ///< (subtrees + 1) × most_rows
  std::vector<double> sums_;  ///< (subtrees × top columns) what they have for these
};

}  // namespace fascia
