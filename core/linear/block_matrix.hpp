#pragma once

#include "core/base/aligned.hpp"
#include "core/base/thread_pool.hpp"
#include "core/structure/point_set.hpp"
#include "core/structure/surface_load.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace fascia {

/// Symmetric matrix of blocks, one for each pair of nodes that share a point or an element, as large as the nodes have
/// degrees of freedom and stored by rows, columns ascending. The pattern is fixed. Where all nodes are vertices, or all
/// rigid frames, only the blocks on and above the diagonal are stored: half as much to read in a product. Where nodes
/// depend on others, all are stored, and the hosts have the blocks that their dependent nodes bring them when the
/// matrix is condensed (core/tangent/condensation.hpp): then products leave out what is zero by that.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// @param surfaces  loads whose faces tie the nodes that move them, whether these share a point or not
  explicit BlockMatrix(const PointSet& set, std::span<const SurfaceLoad> surfaces = {});

  int rows() const { return static_cast<int>(row_begin_.size()) - 1; }
  std::size_t block_count() const { return column_.size(); }
  const DofLayout& dofs() const { return dofs_; }
  std::span<const int> columns(int row) const;
  int row_begin(int row) const { return row_begin_[static_cast<std::size_t>(row)]; }
  double* block(int index) { return values_.data() + value_begin_[static_cast<std::size_t>(index)]; }
  const double* block(int index) const { return values_.data() + value_begin_[static_cast<std::size_t>(index)]; }
  static constexpr std::size_t kPlace = 9;  ///< every block has some times so many numbers
  static constexpr std::size_t kMostValues = kPlace * std::numeric_limits<std::uint32_t>::max();
  /// Where the numbers of a stored block begin, for loops that meet blocks in an order of their own: in 32 bits, for
  /// matrices of up to kMostValues, and without a list to be looked up.
  std::uint32_t place(int index) const {
    return static_cast<std::uint32_t>(value_begin_[static_cast<std::size_t>(index)] / kPlace);
  }
  double* at_place(std::uint32_t place) { return values_.data() + kPlace * place; }
  /// Equal for matrices with blocks at equal places; who keeps places in one asks for it.
  std::uint64_t pattern() const { return pattern_; }
  int find(int row, int column) const;  ///< index of a block that is in the pattern
  int diagonal(int row) const { return diagonal_[static_cast<std::size_t>(row)]; }

  /// Column of a stored block.
  int column(int index) const { return column_[static_cast<std::size_t>(index)]; }
  /// Calls act(index) for the stored blocks of a row that have entries once the matrix is condensed, and the
  /// diagonal's.
  template <class Act>
  void for_each_left(int row, const Act& act) const {
    if (left_begin_.empty()) {
      for (int k = row_begin(row); k < row_begin(row + 1); ++k) act(k);
    } else {
      const auto begin = left_.begin() + left_begin_[static_cast<std::size_t>(row)];
      std::for_each(begin, left_.begin() + left_begin_[static_cast<std::size_t>(row) + 1], act);
    }
  }
  /// True where the blocks are those of the condensed matrix; only where nodes depend on others.
  void set_condensed(bool condensed) { condensed_ = condensed && !left_begin_.empty(); }

  /// Sets the blocks of a row to zero.
  void clear_row(int row);
  /// Only blocks on and above the diagonal are stored; otherwise those on and below are filled, then mirrored.
  bool fills_upper() const { return uniform_ > 0; }
  /// Copies the blocks below the diagonal, transposed, above it, where those are filled.
  void mirror_lower(ThreadPool& pool);
  /// y = K x; returns x · y. No part of y is one of x. One product at a time: what they sum up waits in the matrix.
  double multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;
  /// Makes x = z + s x first, then does so.
  double multiply_next(ThreadPool& pool, std::span<const double> z, double s, std::span<double> x,
                       std::span<double> y) const;
  /// Keeps the entries rounded to 32 bits beside those of 64, as multiply_rounded() reads them.
  void round(ThreadPool& pool);
  /// Both with the entries that the last round() found: half as much to read. They are multiplied and added in 64 bits.
  double multiply_rounded(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;
  double multiply_next_rounded(ThreadPool& pool, std::span<const double> z, double s, std::span<double> x,
                               std::span<double> y) const;

  std::size_t value_count() const { return value_begin_.back(); }
  /// Numbers that a product reads, of the condensed matrix where nodes depend on others.
  std::size_t read_count() const { return read_count_; }
  double* values() { return values_.data(); }
  const double* values() const { return values_.data(); }

 private:
  void find_pattern(const PointSet& set, std::span<const SurfaceLoad> surfaces);
  void add_blocks_of_hosts(const PointSet& set);
  /// Makes x = z + s x of some of the numbers of x; does nothing without z.
  struct Xpay {
    const double* z = nullptr;
    double s = 0;
    double* x = nullptr;
    void operator()(std::size_t begin, std::size_t end) const {
      for (std::size_t i = z == nullptr ? end : begin; i < end; ++i) x[i] = z[i] + s * x[i];
    }
  };
  /// Products take entries of double or of float, that lie as values_ do.
  template <class T>
  double multiply_by(const T* values, ThreadPool& pool, const Xpay& renew, std::span<const double> x,
                     std::span<double> y) const;
  template <class T>
  double multiply_row(const T* values, int row, std::span<const double> x, std::span<double> y) const;
  template <int N, class T>
  double multiply_upper(const T* values, ThreadPool& pool, const Xpay& renew, std::span<const double> x,
                        std::span<double> y) const;
  template <int N, class T>
  void multiply_chunk(const T* values, int chunk) const;
  template <int N>
  double gather_chunk(int chunk, std::span<const double> x, std::span<double> y) const;
  void size_chunks();
  void find_mirrors();

  DofLayout dofs_;
  std::vector<int> row_begin_{0}, column_, diagonal_;
  bool condensed_ = false;
  std::vector<int> left_begin_, left_;  ///< of each row: blocks that a condensed matrix has; empty: all
  std::vector<int> mirror_;             ///< of each block below the diagonal, the one above it
  std::uint64_t pattern_ = 0;
  int uniform_ = 0;                       ///< every block is 3 × 3, or 6 × 6; 0: neither
  std::vector<std::size_t> value_begin_;  ///< of each block, and of all
  std::size_t read_count_ = 0;
  AlignedVector<double> values_;
  AlignedVector<float> rounded_;  ///< these of 32 bits; empty where nobody asked

  /// Products with the upper triangle take rows in a few chunks, whose sums for rows behind them wait in a buffer, so
  /// that the order of additions does not depend on threads. Vectors have four or eight numbers a node there.
  std::vector<int> chunk_begin_;             ///< (chunks + 1) rows
  std::vector<std::size_t> overhang_begin_;  ///< (chunks + 1): what a chunk has for rows from its end on
  std::vector<int> overhang_row_;            ///< these rows, ascending in each chunk
  std::vector<int> overhang_slot_;           ///< of each block in such a column: its place in the chunk's part
  struct Part {
    int begin, end;  ///< of what one chunk has for rows of another
  };
  std::vector<Part> part_;       ///< for the rows of each chunk, by those before it
  std::vector<int> part_begin_;  ///< (chunks + 1)
  mutable AlignedVector<double> wide_x_, wide_y_, overhang_;
  mutable std::vector<double> sums_;  ///< x · y of each chunk, or of each range of rows
};

}  // namespace fascia
