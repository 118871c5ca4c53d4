#include "core/solver/block_matrix.hpp"

#include <algorithm>

namespace fascia {

BlockMatrix::BlockMatrix(const PointSet& set) : dofs_(set.dofs) {
  std::vector<int> group_of_slot(static_cast<std::size_t>(set.slot_count()));
  for (int group = 0; group < set.group_count(); ++group)
    for (int s = set.slot_begin[static_cast<std::size_t>(group)];
         s < set.slot_begin[static_cast<std::size_t>(group) + 1]; ++s)
      group_of_slot[static_cast<std::size_t>(s)] = group;
  std::vector<int> last_seen(static_cast<std::size_t>(set.node_count()), -1);
  for (int row = 0; row < set.node_count(); ++row) {
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
  std::size_t next = 0;
  for (int row = 0; row < rows(); ++row) {
    for (const int column : columns(row)) {
      value_begin_.push_back(next);
      next += static_cast<std::size_t>(dofs_.size(row) * dofs_.size(column));
    }
  }
  values_.assign(next, 0.0);
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
      const int column = column_[static_cast<std::size_t>(k)], n = dofs_.size(row), m = dofs_.size(column);
      const double* lower = block(k);
      double* upper = block(find(column, row));
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) upper[n * j + i] = lower[m * i + j];
    }
  }
}

namespace {

/// y += B x of a block whose size is known to the compiler.
template <int N, int M>
void add_product(const double* b, const double* x, double* y) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < M; ++j) y[i] += b[M * i + j] * x[j];
}

}  // namespace

void BlockMatrix::multiply_row(int row, std::span<const double> x, std::span<double> y) const {
  double sum[kMostDofs] = {};
  const bool rigid_row = dofs_.kind(row) == FrameKind::rigid;
  for (int k = row_begin(row); k < row_begin(row + 1); ++k) {
    const int column = column_[static_cast<std::size_t>(k)];
    const double* xc = x.data() + dofs_.begin(column);
    const bool rigid_column = dofs_.kind(column) == FrameKind::rigid;
    if (rigid_row && rigid_column)
      add_product<6, 6>(block(k), xc, sum);
    else if (rigid_row)
      add_product<6, 12>(block(k), xc, sum);
    else if (rigid_column)
      add_product<12, 6>(block(k), xc, sum);
    else
      add_product<12, 12>(block(k), xc, sum);
  }
  std::copy(sum, sum + dofs_.size(row), y.data() + dofs_.begin(row));
}

void BlockMatrix::multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  pool.for_ranges(rows(), 64, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) multiply_row(row, x, y);
  });
}

}  // namespace fascia
