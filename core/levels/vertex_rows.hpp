#pragma once

#include "core/base/thread_pool.hpp"
#include "core/levels/block_rows.hpp"
#include "core/levels/edge_ends.hpp"

#include <array>
#include <span>
#include <vector>

namespace fascia {

/// P between the vertices of quadratic elements and those at their corners: a vertex in the middle of an edge moves by
/// the mean of its ends, every other one as it does there. Vectors are in constraint axes, of a coarse node in those of
/// the node that it is.
class Corners {
 public:
  /// @param filter  belongs to the caller
  Corners(const EdgeEnds& ends, const DofFilter& filter);

  int count() const { return static_cast<int>(origin_.size()); }
  /// The fine node of each coarse one.
  const std::vector<int>& origin() const { return origin_; }
  /// The two coarse nodes whose mean a fine one is; twice the same where it is one of them.
  const std::array<int, 2>& parents(int node) const { return parents_[at(node)]; }
  /// Fine nodes that a coarse one moves, by half or as a whole (weight()).
  std::span<const int> children(int coarse) const {
    return std::span(child_).subspan(at(begin_[at(coarse)]), at(begin_[at(coarse + 1)] - begin_[at(coarse)]));
  }
  double weight(int node) const { return parents_[at(node)][0] == parents_[at(node)][1] ? 1 : 0.5; }
  /// A block of a fine row and column in the axes of coarse ones: itself, or what was made in `copy`.
  const double* turned(int coarse_row, int row, int coarse_column, int column, const double* block, double* copy) const;

  /// coarse = Pᵀ r, without prescribed degrees of freedom.
  void restrict_to(const FineRows& fine, ThreadPool& pool, std::span<const double> r, std::span<double> coarse) const;
  /// x += P coarse, likewise.
  void add_prolonged(const FineRows& fine, ThreadPool& pool, std::span<const double> coarse, std::span<double> x) const;

 private:
  std::vector<int> origin_;
  std::vector<std::array<int, 2>> parents_;
  /// From the axes of one node into those of another.
  struct Turn {
    const DofTurn *from = nullptr, *to = nullptr;  ///< null: the axes of the world
    bool none() const { return from == nullptr && to == nullptr; }
    Vec3d apply(Vec3d v) const {
      if (from != nullptr) v = transpose(from->translation) * v;
      return to != nullptr ? to->translation * v : v;
    }
  };
  Turn turn(int from, int to) const {
    const DofTurn *a = filter_.turn_of(from), *b = filter_.turn_of(to);
    const bool alike = a != nullptr && b != nullptr && a->translation == b->translation;
    return alike ? Turn{} : Turn{a, b};
  }

  const DofFilter& filter_;
  std::vector<int> begin_, child_;
};

/// A symmetric matrix of vertices, all blocks stored: Pᵀ K P between corners.
class VertexRows {
 public:
  VertexRows(const FineRows& K, const Corners& corners, ThreadPool& pool);

  int rows() const { return static_cast<int>(fixed_.size()); }
  static int size(int) { return kDofs; }
  static int begin(int row) { return kDofs * row; }
  static std::size_t block_begin(int row) { return at(kSize * row); }
  unsigned fixed(int row) const { return fixed_[at(row)]; }
  template <class Act>
  void for_each_column(int row, const Act& act) const {
    for (int k = begin_[at(row)]; k < begin_[at(row + 1)]; ++k) act(column_[at(k)]);
  }
  template <class Act>
  void for_each_block(int row, const Act& act) const {
    for (int k = begin_[at(row)]; k < begin_[at(row + 1)]; ++k) act(column_[at(k)], values_.data() + block_begin(k));
  }
  /// y = K x, of entries rounded to 32 bits. Sums are of 64 bits.
  void multiply_rounded(ThreadPool& pool, std::span<const double> x, std::span<double> y) const;
  std::size_t value_count() const { return values_.size(); }

 private:
  static constexpr int kDofs = 3, kSize = kDofs * kDofs, kRoundedSize = 4 * kDofs;
  void round(ThreadPool& pool);

  std::vector<unsigned> fixed_;
  std::vector<int> begin_, column_;
  AlignedVector<double> values_;
  AlignedVector<float> rounded_;  ///< columns of each block, padded to four
};

}  // namespace fascia
