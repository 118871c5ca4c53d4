#include "core/solver/block_matrix.hpp"

#include <algorithm>

namespace fascia {

BlockMatrix::BlockMatrix(const PointSet& set) {
  std::vector<int> group_of_slot(static_cast<std::size_t>(set.slot_count()));
  for (int group = 0; group < set.group_count(); ++group)
    for (int s = set.slot_begin[static_cast<std::size_t>(group)];
         s < set.slot_begin[static_cast<std::size_t>(group) + 1]; ++s)
      group_of_slot[static_cast<std::size_t>(s)] = group;
  std::vector<int> last_seen(static_cast<std::size_t>(set.node_count), -1);
  for (int row = 0; row < set.node_count; ++row) {
    const std::size_t begin = column_.size();
    last_seen[static_cast<std::size_t>(row)] = row;
    column_.push_back(row);
    for (int k = set.node_slot_begin[static_cast<std::size_t>(row)];
         k < set.node_slot_begin[static_cast<std::size_t>(row) + 1]; ++k) {
      const int slot = set.node_slot[static_cast<std::size_t>(k)];
      for (const int column : set.nodes(group_of_slot[static_cast<std::size_t>(slot)])) {
        if (last_seen[static_cast<std::size_t>(column)] == row) continue;
        last_seen[static_cast<std::size_t>(column)] = row;
        column_.push_back(column);
      }
    }
    std::sort(column_.begin() + static_cast<std::ptrdiff_t>(begin), column_.end());
    row_begin_.push_back(static_cast<int>(column_.size()));
    diagonal_.push_back(find(row, row));
  }
  values_.assign(column_.size() * 36, 0.0);
}

std::span<const int> BlockMatrix::columns(int row) const {
  const auto begin = static_cast<std::size_t>(row_begin(row)), end = static_cast<std::size_t>(row_begin(row + 1));
  return std::span(column_).subspan(begin, end - begin);
}

int BlockMatrix::find(int row, int column) const {
  const auto begin = column_.begin() + row_begin(row), end = column_.begin() + row_begin(row + 1);
  return static_cast<int>(std::lower_bound(begin, end, column) - column_.begin());
}

void BlockMatrix::set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

void BlockMatrix::mirror_lower() {
  for (int row = 0; row < rows(); ++row) {
    for (int k = row_begin(row); k < diagonal(row); ++k) {
      const double* lower = block(k);
      double* upper = block(find(column_[static_cast<std::size_t>(k)], row));
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) upper[6 * j + i] = lower[6 * i + j];
    }
  }
}

void BlockMatrix::multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  pool.for_ranges(rows(), 64, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      double sum[6] = {};
      for (int k = row_begin(row); k < row_begin(row + 1); ++k) {
        const double* b = block(k);
        const double* xc = x.data() + 6 * static_cast<std::size_t>(column_[static_cast<std::size_t>(k)]);
        for (int i = 0; i < 6; ++i)
          for (int j = 0; j < 6; ++j) sum[i] += b[6 * i + j] * xc[j];
      }
      std::copy(sum, sum + 6, y.data() + 6 * static_cast<std::size_t>(row));
    }
  });
}

}  // namespace fascia
