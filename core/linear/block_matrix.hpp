#pragma once

#include "core/base/aligned.hpp"
#include "core/base/thread_pool.hpp"
#include "core/structure/point_set.hpp"
#include "core/structure/surface_load.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

/// Symmetric matrix of blocks, one for each pair of nodes that share a point or an element, as large as the nodes have
/// degrees of freedom and stored by rows, columns ascending. The pattern is fixed. Where all nodes are vertices, or all
/// rigid frames, only the blocks on and above the diagonal are stored: half as much to read in a product. Where nodes
/// depend on others, all are stored, and the hosts have the blocks that their dependent nodes bring them.
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
  /// Equal for matrices with blocks at equal places; who keeps places in one asks for it.
  std::uint64_t pattern() const { return pattern_; }
  int find(int row, int column) const;  ///< index of a block that is in the pattern
  int diagonal(int row) const { return diagonal_[static_cast<std::size_t>(row)]; }

  void set_zero(ThreadPool& pool);
  /// Only blocks on and above the diagonal are stored; otherwise those on and below are filled, then mirrored.
  bool fills_upper() const { return uniform_ > 0; }
  /// Copies the blocks below the diagonal, transposed, above it, where those are filled.
  void mirror_lower(ThreadPool& pool);
  /// y = K x
  void multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;
  /// Keeps the entries rounded to 32 bits beside those of 64, as multiply_rounded() reads them.
  void round(ThreadPool& pool);
  /// y = K x with the entries that the last round() found: half as much to read. They are multiplied and added in 64
  /// bits.
  void multiply_rounded(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;

  std::size_t value_count() const { return value_begin_.back(); }
  double* values() { return values_.data(); }
  const double* values() const { return values_.data(); }

 private:
  void find_pattern(const PointSet& set, std::span<const SurfaceLoad> surfaces);
  void add_blocks_of_hosts(const PointSet& set);
  /// Products take entries of double or of float, that lie as values_ do.
  template <class T>
  void multiply_by(const T* values, ThreadPool& pool, std::span<const double> x, std::span<double> y) const;
  template <class T>
  void multiply_row(const T* values, int row, std::span<const double> x, std::span<double> y) const;
  template <int N, class T>
  void multiply_upper(const T* values, ThreadPool& pool, std::span<const double> x, std::span<double> y) const;
  template <int N, class T>
  void multiply_chunk(const T* values, int chunk) const;
  void size_chunks();
  void find_mirrors();

  DofLayout dofs_;
  std::vector<int> row_begin_{0}, column_, diagonal_;
  std::vector<int> mirror_;  ///< of each block below the diagonal, the one above it
  std::uint64_t pattern_ = 0;
  int uniform_ = 0;                       ///< every block is 3 × 3, or 6 × 6; 0: neither
  std::vector<std::size_t> value_begin_;  ///< of each block, and of all
  AlignedVector<double> values_;
  AlignedVector<float> rounded_;  ///< these of 32 bits; empty where nobody asked

  /// Products with the upper triangle take rows in a few chunks, whose sums for rows behind them wait in a buffer, so
  /// that the order of additions does not depend on threads. Vectors have four or eight numbers a node there.
  std::vector<int> chunk_begin_;             ///< (chunks + 1) rows
  std::vector<std::size_t> overhang_begin_;  ///< (chunks + 1): what a chunk has for rows from its end on
  std::vector<int> overhang_row_;            ///< these rows, ascending in each chunk
  std::vector<int> overhang_slot_;           ///< of each block in such a column: its place in the chunk's part
  mutable AlignedVector<double> wide_x_, wide_y_, overhang_;
};

}  // namespace fascia
