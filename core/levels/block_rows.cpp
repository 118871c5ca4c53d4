#include "core/levels/block_rows.hpp"

namespace fascia {

void FineRows::find_lower() {
  if (!matrix_.fills_upper()) return;
  lower_begin_.assign(at(rows()) + 1, 0);
  for (int row = 0; row < rows(); ++row)
    for (const int column : matrix_.columns(row))
      if (column > row) ++lower_begin_[at(column) + 1];
  for (int row = 0; row < rows(); ++row) lower_begin_[at(row) + 1] += lower_begin_[at(row)];
  lower_column_.resize(at(lower_begin_.back()));
  lower_block_.resize(lower_column_.size());
  std::vector<int> next(lower_begin_.begin(), lower_begin_.end() - 1);
  for (int row = 0; row < rows(); ++row) {
    const std::span<const int> columns = matrix_.columns(row);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (columns[k] <= row) continue;
      const std::size_t place = at(next[at(columns[k])]++);
      lower_column_[place] = row;
      lower_block_[place] = matrix_.row_begin(row) + static_cast<int>(k);
    }
  }
}

const double* FineRows::taken(int row, int column, const double* stored, double* copy) const {
  const unsigned held = fixed(row), held_column = fixed(column);
  if ((held | held_column) == 0 && filter_.turn_of(row) == nullptr && filter_.turn_of(column) == nullptr) return stored;
  const int n = size(row), m = size(column);
  filter_.rotate_block(row, column, stored, copy);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j)
      if (((held >> i) & 1U) != 0 || ((held_column >> j) & 1U) != 0) copy[m * i + j] = 0;
  return copy;
}

}  // namespace fascia
