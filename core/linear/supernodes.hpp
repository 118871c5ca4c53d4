#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace fascia {

/// A Cholesky factor L by supernodes: runs of columns that share their rows below. The numbers of one lie by columns,
/// as a dense matrix whose first rows are its own columns; what is above its diagonal is not read.
template <class T>
struct Supernodes {
  std::span<const int> first_column;  ///< of each, and of the end
  std::span<const int> row_begin;     ///< of each in `row`, and of the end
  std::span<const int> value_begin;   ///< of each in `value`, and of the end
  std::span<const int> row;           ///< of L, ascending in each
  std::span<const T> value;

  int count() const { return static_cast<int>(first_column.size()) - 1; }
  int most_rows() const {
    int most = 0;
    for (std::size_t s = 1; s < row_begin.size(); ++s) most = std::max(most, row_begin[s] - row_begin[s - 1]);
    return most;
  }
};

/// L Lᵀ x = b in place. Each number of L is read once for each triangle, four columns together: a direct solve with one
/// right-hand side waits for memory, not for multiplications.
/// @tparam T    numbers of L: double, or float, which is half as much to read; they are multiplied and added in 64 bits
/// @param work  for most_rows() numbers
template <class T>
void solve(const Supernodes<T>& L, std::span<double> x, std::span<double> work);

}  // namespace fascia
