#pragma once

#include "core/cpu/thread_pool.hpp"
#include "core/model/aligned.hpp"
#include "core/model/point_set.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Symmetric matrix of blocks, one for each pair of frames that share a group, as large as the frames have degrees of
/// freedom and stored by rows. Both triangles are stored, columns ascending in each row. The pattern is fixed.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  explicit BlockMatrix(const PointSet& set);

  int rows() const { return static_cast<int>(row_begin_.size()) - 1; }
  std::size_t block_count() const { return column_.size(); }
  const DofLayout& dofs() const { return dofs_; }
  std::span<const int> columns(int row) const;
  int row_begin(int row) const { return row_begin_[static_cast<std::size_t>(row)]; }
  double* block(int index) { return values_.data() + value_begin_[static_cast<std::size_t>(index)]; }
  const double* block(int index) const { return values_.data() + value_begin_[static_cast<std::size_t>(index)]; }
  int find(int row, int column) const;  ///< index of a block that is in the pattern
  int diagonal(int row) const { return diagonal_[static_cast<std::size_t>(row)]; }

  void set_zero();
  /// Copies the blocks below the diagonal, transposed, above it.
  void mirror_lower();
  /// y = K x
  void multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;

  std::size_t value_count() const { return values_.size(); }

 private:
  void multiply_row(int row, std::span<const double> x, std::span<double> y) const;

  DofLayout dofs_;
  std::vector<int> row_begin_{0}, column_, diagonal_;
  std::vector<std::size_t> value_begin_;
  AlignedVector<double> values_;
};

}  // namespace fascia
