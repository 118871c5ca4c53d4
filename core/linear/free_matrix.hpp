#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/node/dof_filter.hpp"

#include <cstdint>
#include <vector>

namespace fascia {

/// Lower triangle of a block matrix without its prescribed degrees of freedom, by compressed columns. The pattern is
/// built once, fill() renews the values.
/// @tparam Int  of its places: int or std::int64_t
template <class Int>
struct FreeMatrix {
  std::vector<Int> column_begin, row;
  std::vector<double> value;
  std::vector<int> number;  ///< of each degree of freedom among the free ones, −1 where prescribed
  int size = 0;

  FreeMatrix() = default;
  FreeMatrix(const BlockMatrix& pattern, const DofFilter& filter);
  /// matrix + shift · diagonal of shift_from
  void fill(const BlockMatrix& matrix, const DofFilter& filter, double shift, const BlockMatrix* shift_from);
  /// Those of the free degrees of freedom of nodes, one node after the other.
  std::vector<int> numbers_of(const std::vector<int>& nodes, const DofLayout& dofs) const;

 private:
  template <class BeginColumn, class Entry>
  void visit(const BlockMatrix& pattern, const BeginColumn& begin_column, const Entry& entry) const;
  std::vector<double> turned_;  ///< blocks of one row in constraint axes
};

extern template struct FreeMatrix<int>;
extern template struct FreeMatrix<std::int64_t>;

}  // namespace fascia
