#include "core/solver/free_matrix.hpp"

#include "core/math/index.hpp"

#include <cmath>

namespace fascia {

/// Visits the lower triangle column by column: row r of the symmetric matrix serves as column r.
/// begin_column(r, j), entry(offset of the block behind the diagonal, j, i, number of the row)
template <class BeginColumn, class Entry>
void FreeMatrix::visit(const BlockMatrix& pattern, const BeginColumn& begin_column, const Entry& entry) const {
  for (int r = 0; r < pattern.rows(); ++r) {
    const auto columns = pattern.columns(r).subspan(at(pattern.diagonal(r) - pattern.row_begin(r)));
    for (int j = 0; j < 6; ++j) {
      begin_column(r, j);
      if (number[at(6 * r + j)] < 0) continue;
      for (std::size_t k = 0; k < columns.size(); ++k)
        for (int i = k == 0 ? j : 0; i < 6; ++i)
          if (number[at(6 * columns[k] + i)] >= 0) entry(k, j, i, number[at(6 * columns[k] + i)]);
    }
  }
}

FreeMatrix::FreeMatrix(const BlockMatrix& pattern, const DofFilter& filter) : number(filter.size(), -1) {
  for (std::size_t i = 0; i < filter.size(); ++i)
    if (!filter.is_fixed(i)) number[i] = size++;
  visit(
      pattern,
      [&](int r, int j) {
        if (number[at(6 * r + j)] >= 0) column_begin.push_back(static_cast<int>(row.size()));
      },
      [&](std::size_t, int, int, int row_number) { row.push_back(row_number); });
  column_begin.push_back(static_cast<int>(row.size()));
  value.resize(row.size());
}

void FreeMatrix::fill(const BlockMatrix& matrix, const DofFilter& filter, double shift, const BlockMatrix* shift_from) {
  std::size_t next = 0;
  const auto turn_row = [&](int r, int j) {
    if (j != 0) return;
    const int first = matrix.diagonal(r), count = matrix.row_begin(r + 1) - first;
    const auto columns = matrix.columns(r).subspan(at(first - matrix.row_begin(r)));
    turned_.resize(at(count) * 36);
    for (int k = 0; k < count; ++k)
      filter.rotate_block(r, columns[at(k)], matrix.block(first + k), turned_.data() + at(k) * 36);
    if (shift == 0) return;
    double diagonal[36];
    filter.rotate_block(r, r, shift_from->block(shift_from->diagonal(r)), diagonal);
    for (std::size_t i = 0; i < 6; ++i) turned_[7 * i] += shift * std::abs(diagonal[7 * i]);
  };
  visit(matrix, turn_row, [&](std::size_t k, int j, int i, int) { value[next++] = turned_[36 * k + at(6 * j + i)]; });
}

}  // namespace fascia
