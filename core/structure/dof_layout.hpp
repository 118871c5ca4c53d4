#pragma once

#include "core/base/index.hpp"
#include "core/math/mat3.hpp"

#include <utility>
#include <vector>

namespace fascia {

/// Kind of a node by how it may move: a frame turns (6 degrees of freedom), or also stretches and shears (12); a vertex
/// only moves (3).
enum class FrameKind : unsigned char { rigid, affine, vertex };

/// Number of degrees of freedom of a node.
FASCIA_HD constexpr int dof_count(FrameKind kind) {
  return kind == FrameKind::vertex ? 3 : kind == FrameKind::rigid ? 6 : 12;
}

/// Where the degrees of freedom of each node stand in a vector: displacement (3), then for a rigid frame its rotation
/// vector (3), for an affine one the columns of A (9).
class DofLayout {
 public:
  DofLayout() = default;
  explicit DofLayout(std::vector<FrameKind> kinds) : kind_(std::move(kinds)) {
    for (const FrameKind kind : kind_) {
      const int n = dof_count(kind);
      begin_.push_back(begin_.back() + n);
      block_begin_.push_back(block_begin_.back() + at(n * n));
    }
  }

  int node_count() const { return static_cast<int>(kind_.size()); }
  int total() const { return begin_.back(); }
  FrameKind kind(int node) const { return kind_[at(node)]; }
  int begin(int node) const { return begin_[at(node)]; }
  int size(int node) const { return begin_[at(node + 1)] - begin_[at(node)]; }
  /// Where a frame's own square block starts in an array of such blocks.
  std::size_t block_begin(int node) const { return block_begin_[at(node)]; }
  std::size_t block_total() const { return block_begin_.back(); }
  // Arrays of these by node; begins also have where a next node would be.
  const std::vector<FrameKind>& kinds() const { return kind_; }
  const std::vector<int>& begins() const { return begin_; }
  const std::vector<std::size_t>& block_begins() const { return block_begin_; }

 private:
  std::vector<FrameKind> kind_;
  std::vector<int> begin_{0};
  std::vector<std::size_t> block_begin_{0};
};

inline constexpr int kMostDofs = 12;

/// dA of a frame for the increments behind its displacement. @param Q  its present I + D
FASCIA_HD inline Mat3d frame_variation(FrameKind kind, const double* d, const Mat3d& Q) {
  if (kind == FrameKind::rigid) return skew(Vec3d{{d[0], d[1], d[2]}}) * Q;
  Mat3d dA;
  if (kind == FrameKind::vertex) return dA;
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) dA(i, q) = d[3 * q + i];
  return dA;
}

/// Adds what N, conjugate to A, is on the degrees of freedom behind the displacement.
FASCIA_HD inline void add_moment(FrameKind kind, const Mat3d& N, const Mat3d& Q, double* g) {
  if (kind == FrameKind::vertex) return;
  if (kind == FrameKind::rigid) {
    const Vec3d torque = axl(Q * transpose(N));
    for (int k = 0; k < 3; ++k) g[k] += torque[k];
    return;
  }
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) g[3 * q + i] += N(i, q);
}

/// N of a torque: ½ [τ]× A⁻ᵀ, which works on the spin of A alone. (A rigid frame's A⁻ᵀ is A.)
FASCIA_HD inline Mat3d moment_of_torque(const Vec3d& torque, const Mat3d& A) {
  return skew(torque) * transpose(inverse(A)) * 0.5;
}

}  // namespace fascia
