#pragma once

#include "core/base/aligned.hpp"
#include "core/levels/block_rows.hpp"

#include <vector>

namespace fascia {

/// The entries of BlockRows as products of a cycle read them: of 32 bits, which is exact enough for a preconditioner
/// and half as much to read, and each row of a block padded to eight. Sums are of 64 bits.
class RoundedRows {
 public:
  /// Numbers that lie beyond the last node in vectors of rigid frames: a product reads them, times zero, or adds zeros.
  static constexpr std::size_t kBeyond = 2;

  RoundedRows() = default;
  /// @param blocks  whose rows and columns stay the caller's
  /// @param size    size(row): degrees of freedom of a row's node
  template <class Size>
  RoundedRows(const BlockRows& blocks, const Size& size) : begin_{0} {
    begin_.reserve(at(blocks.rows()) + 1);
    for (int row = 0; row < blocks.rows(); ++row)
      begin_.push_back(begin_.back() + blocks.columns(row).size() * at(size(row)) * kWide);
    values_.resize(begin_.back());
    for (int row = 0; row < blocks.rows(); ++row)
      pad(blocks.block(row, 0, size(row)), blocks.columns(row).size() * at(size(row)),
          values_.data() + begin_[at(row)]);
  }

  /// y += B x of a row. @param x  six numbers a column, and kBeyond behind them
  void add_product(int row, int size, std::span<const int> columns, const double* x, double* y) const;
  /// x += Bᵀ y of a row.
  void add_transposed_product(int row, int size, std::span<const int> columns, const double* y, double* x) const;

 private:
  static constexpr std::size_t kWide = 8;
  static void pad(const double* from, std::size_t rows, float* to);

  std::vector<std::size_t> begin_;  ///< of each row's values
  AlignedVector<float> values_;
};

}  // namespace fascia
