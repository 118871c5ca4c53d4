#include "core/linear/free_matrix.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

/// Visits the lower triangle column by column: row r of the symmetric matrix serves as column r.
/// begin_column(r, j), entry(offset of the block behind the diagonal, place in that block, number of the row)
template <class Int>
template <class BeginColumn, class Entry>
void FreeMatrix<Int>::visit(const BlockMatrix& pattern, const BeginColumn& begin_column, const Entry& entry) const {
  const DofLayout& dofs = pattern.dofs();
  for (int r = 0; r < pattern.rows(); ++r) {
    const auto columns = pattern.columns(r).subspan(at(pattern.diagonal(r) - pattern.row_begin(r)));
    for (int j = 0; j < dofs.size(r); ++j) {
      begin_column(r, j);
      if (number[at(dofs.begin(r) + j)] < 0) continue;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const int first = dofs.begin(columns[k]), n = dofs.size(columns[k]);
        for (int i = k == 0 ? j : 0; i < n; ++i)
          if (number[at(first + i)] >= 0) entry(k, j * n + i, number[at(first + i)]);
      }
    }
  }
}

template <class Int>
FreeMatrix<Int>::FreeMatrix(const BlockMatrix& pattern, const DofFilter& filter) : number(filter.size(), -1) {
  for (std::size_t i = 0; i < filter.size(); ++i)
    if (!filter.is_fixed(i)) number[i] = size++;
  visit(
      pattern,
      [&](int r, int j) {
        if (number[at(pattern.dofs().begin(r) + j)] >= 0) column_begin.push_back(static_cast<Int>(row.size()));
      },
      [&](std::size_t, int, int row_number) { row.push_back(row_number); });
  column_begin.push_back(static_cast<Int>(row.size()));
  value.resize(row.size());
}

template <class Int>
std::vector<int> FreeMatrix<Int>::numbers_of(const std::vector<int>& nodes, const DofLayout& dofs) const {
  std::vector<int> numbers;
  for (const int node : nodes)
    for (int i = dofs.begin(node); i < dofs.begin(node) + dofs.size(node); ++i)
      if (number[at(i)] >= 0) numbers.push_back(number[at(i)]);
  return numbers;
}

template <class Int>
void FreeMatrix<Int>::fill(const BlockMatrix& matrix, const DofFilter& filter, double shift,
                           const BlockMatrix* shift_from) {
  constexpr double kLeast = 1e-3;                        // rows that nothing resists need a shift too
  constexpr std::size_t kBlock = kMostDofs * kMostDofs;  // room for the largest
  std::size_t next = 0;
  const auto turn_row = [&](int r, int j) {
    if (j != 0) return;
    const int first = matrix.diagonal(r), count = matrix.row_begin(r + 1) - first;
    const auto columns = matrix.columns(r).subspan(at(first - matrix.row_begin(r)));
    turned_.resize(at(count) * kBlock);
    for (int k = 0; k < count; ++k)
      filter.rotate_block(r, columns[at(k)], matrix.block(first + k), turned_.data() + at(k) * kBlock);
    if (shift == 0) return;
    double diagonal[kBlock];
    filter.rotate_block(r, r, shift_from->block(shift_from->diagonal(r)), diagonal);
    const int n = matrix.dofs().size(r);
    double largest[2] = {0, 0};  // of displacements, of rotations
    for (int i = 0; i < n; ++i) largest[i / 3 > 0] = std::max(largest[i / 3 > 0], std::abs(diagonal[(n + 1) * i]));
    for (int i = 0; i < n; ++i)
      turned_[at((n + 1) * i)] += shift * std::max(std::abs(diagonal[(n + 1) * i]), kLeast * largest[i / 3 > 0]);
  };
  visit(matrix, turn_row, [&](std::size_t k, int place, int) { value[next++] = turned_[kBlock * k + at(place)]; });
}

template struct FreeMatrix<int>;
template struct FreeMatrix<std::int64_t>;

}  // namespace fascia
