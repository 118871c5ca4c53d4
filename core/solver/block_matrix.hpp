#pragma once

#include "core/cpu/thread_pool.hpp"
#include "core/model/aligned.hpp"
#include "core/model/point_set.hpp"

#include <array>
#include <span>
#include <vector>

namespace fascia {

/// A 6×6 block by rows: translations, then rotations.
using Block6 = std::array<double, 36>;

/// Symmetric matrix of 6×6 blocks; both triangles are stored, columns ascending in each row. The pattern is fixed.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// The pattern of a point set: a block for each pair of frames that share a group.
  explicit BlockMatrix(const PointSet& set);

  int rows() const { return static_cast<int>(row_begin_.size()) - 1; }
  std::size_t block_count() const { return column_.size(); }
  std::span<const int> columns(int row) const;
  int row_begin(int row) const { return row_begin_[static_cast<std::size_t>(row)]; }
  double* block(int index) { return values_.data() + static_cast<std::size_t>(index) * 36; }
  const double* block(int index) const { return values_.data() + static_cast<std::size_t>(index) * 36; }
  int find(int row, int column) const;  ///< index of a block that is in the pattern
  int diagonal(int row) const { return diagonal_[static_cast<std::size_t>(row)]; }

  void set_zero();
  /// Copies the blocks below the diagonal, transposed, above it.
  void mirror_lower();
  /// y = K x
  void multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;

  std::size_t memory_bytes() const { return values_.size() * sizeof(double) + column_.size() * sizeof(int); }

 private:
  std::vector<int> row_begin_{0}, column_, diagonal_;
  AlignedVector<double> values_;
};

}  // namespace fascia
