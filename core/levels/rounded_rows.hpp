#pragma once

#include "core/base/aligned.hpp"
#include "core/levels/block_rows.hpp"

namespace fascia {

/// The entries of BlockRows as products of a cycle read them: of 32 bits, which is exact enough for a preconditioner
/// and half as much to read, and each row of a block padded to eight. Sums are of 64 bits.
class RoundedRows {
 public:
  /// Numbers that lie beyond the last node in vectors of rigid frames: a product reads them, times zero, or adds zeros.
  static constexpr std::size_t kBeyond = 2;

  RoundedRows() = default;
  /// @param blocks  asked for places of rows and columns later on too
  explicit RoundedRows(const BlockRows& blocks);

  /// y += B x of a row. @param size  degrees of freedom of its node
  /// @param x  six numbers a column, and kBeyond behind them
  void add_product(const BlockRows& blocks, int row, int size, const double* x, double* y) const;
  /// x += Bᵀ y of a row.
  void add_transposed_product(const BlockRows& blocks, int row, int size, const double* y, double* x) const;

 private:
  static constexpr int kWide = 8;
  const float* row_of(const BlockRows& blocks, int row) const {
    return values_.data() + blocks.value_begin[at(row)] / kFrameDofs * kWide;
  }

  AlignedVector<float> values_;
};

}  // namespace fascia
