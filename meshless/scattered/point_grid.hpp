#pragma once

#include "core/base/index.hpp"
#include "core/math/vec3.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace fascia {

/// Squared distances that differ by less, relative to them, are the same: rounding, and with it the unit of length and
/// the distance from the origin, must not choose between neighbours in regular places.
inline constexpr double kTie = 1e-6;

/// Points in cubic cells that are found through a hash: insertion and near neighbours in constant time.
///
/// Cells that share a slot only add candidates, whose distance is measured anyway.
class PointGrid {
 public:
  /// @param cell  about the distance that is asked for [m]
  explicit PointGrid(double cell) : cell_(cell), head_(64, -1) {}

  std::size_t size() const { return points_.size(); }

  void insert(const Vec3d& x) {
    if (points_.size() >= head_.size()) grow();
    points_.push_back(x);
    next_.push_back(-1);
    link(static_cast<int>(points_.size()) - 1);
  }

  /// Whether some point at most `radius` away, no more than a cell, is accepted: accept(index, squared distance).
  template <class Accept>
  bool any_within(const Vec3d& x, double radius, Accept&& accept) const {
    const Cell home = cell_of(x);
    const Gaps gaps = gaps_around(home, x);
    const double most = radius * radius * (1 + kTie);
    std::array<std::array<double, 3>, 3> squares{};  // of the gaps, and parts of the hashes, by axis and offset
    std::array<std::array<std::uint64_t, 3>, 3> parts{};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t o = 0; o < 3; ++o) {
        squares[a][o] = gaps[a][o] * gaps[a][o] * (1 - 4 * kTie);
        parts[a][o] = hash_part(a, home[a] + static_cast<int>(o) - 1);
      }
    for (const auto& offset : kNearFirst) {
      const std::size_t i = at(offset[0] + 1), j = at(offset[1] + 1), k = at(offset[2] + 1);
      if (squares[0][i] + squares[1][j] + squares[2][k] > most) continue;
      for (int n = head_[(parts[0][i] + parts[1][j] + parts[2][k]) >> shift_]; n >= 0; n = next_[at(n)]) {
        const double squared = squared_norm(points_[at(n)] - x);
        if (squared <= most && accept(n, squared)) return true;
      }
    }
    return false;
  }

  double squared_distance(int point, const Vec3d& x) const { return squared_norm(points_[at(point)] - x); }
  /// Whether any_within() offers a point.
  bool is_within(int point, const Vec3d& x, double radius) const {
    return squared_distance(point, x) <= radius * radius * (1 + kTie);
  }
  /// Fetches what a search around x begins with.
  void prefetch(const Vec3d& x) const { __builtin_prefetch(&head_[slot(cell_of(x))]); }

  /// The nearest point that accept(index) takes, of equals the first; −1: none. Beyond `reach` one may be missed.
  template <class Accept>
  int nearest(const Vec3d& x, double reach, Accept&& accept) const {
    Best best;
    const Cell home = cell_of(x);
    const auto gaps = gaps_around(home, x);
    double margin = cell_;
    for (const auto& g : gaps) margin = std::min({margin, g[0], g[2]});
    const auto covered = [&](int ring) { return std::max(0.0, margin) + ring * cell_; };
    const auto offer = [&](int i) { best.offer(i, squared_norm(points_[at(i)] - x), accept); };
    for (const auto& offset : kNearFirst) {
      if (squared_gap(gaps, offset) > best.reach()) continue;
      for (int i = first_in(home, offset); i >= 0; i = next_[at(i)]) offer(i);
    }
    for (int ring = 1;; ++ring) {
      if (ring > 1) visit_ring(home, ring, offer);
      if (best.index >= 0 && best.reach() <= covered(ring) * covered(ring)) return best.index;
      if (covered(ring) >= reach) return best.index;
      if (ring == kMostRings) break;
    }
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) offer(i);
    return best.index;
  }

  /// Calls visit(index) for each point at most `radius` away, for some of them more than once.
  template <class Visit>
  void visit_within(const Vec3d& x, double radius, Visit&& visit) const {
    const double most = radius * radius;
    const auto offer = [&](int i) {
      if (squared_norm(points_[at(i)] - x) <= most) visit(i);
    };
    const Vec3d reach{{radius, radius, radius}};
    const Cell low = cell_of(x - reach), high = cell_of(x + reach);
    double cells = 1;
    for (std::size_t a = 0; a < 3; ++a) cells *= static_cast<double>(high[a] - low[a] + 1);
    if (cells > static_cast<double>(points_.size())) {  // looking at every point costs less
      for (int i = 0; i < static_cast<int>(points_.size()); ++i) offer(i);
      return;
    }
    for (std::int64_t a = low[0]; a <= high[0]; ++a)
      for (std::int64_t b = low[1]; b <= high[1]; ++b)
        for (std::int64_t c = low[2]; c <= high[2]; ++c)
          for (int i = head_[slot({a, b, c})]; i >= 0; i = next_[at(i)]) offer(i);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  using Offset = std::array<int, 3>;
  using Gaps = std::array<std::array<double, 3>, 3>;  ///< by axis: from the point to the cell below, its own, above
  static constexpr int kMostRings = 3;                // farther, looking at every point costs less

  struct Best {
    int index = -1;
    double squared = std::numeric_limits<double>::infinity();

    double reach() const { return squared * (1 + kTie); }
    template <class Accept>
    void offer(int i, double d, Accept&& accept) {
      if (d > reach() || !accept(i)) return;
      if (i < index || d < squared * (1 - kTie)) index = i;
      squared = std::min(squared, d);
    }
  };

  Cell cell_of(const Vec3d& x) const {
    constexpr double farthest = 1e15;
    Cell c{};
    for (int a = 0; a < 3; ++a)
      c[at(a)] = static_cast<std::int64_t>(std::clamp(std::floor(x[a] / cell_), -farthest, farthest));
    return c;
  }
  /// The 27 cells around, the middle one first, then those that share a face, an edge, a corner with it.
  static constexpr std::array<Offset, 27> kNearFirst = [] {
    std::array<Offset, 27> offsets{};
    std::size_t n = 0;
    for (int shared = 0; shared <= 3; ++shared)
      for (int k = 0; k < 27; ++k) {
        const Offset o{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        if (o[0] * o[0] + o[1] * o[1] + o[2] * o[2] == shared) offsets[n++] = o;
      }
    return offsets;
  }();
  Gaps gaps_around(const Cell& home, const Vec3d& x) const {
    Gaps gaps{};
    for (int a = 0; a < 3; ++a) {
      gaps[at(a)][0] = x[a] - static_cast<double>(home[at(a)]) * cell_;
      gaps[at(a)][2] = cell_ - gaps[at(a)][0];
    }
    return gaps;
  }
  static double squared_gap(const Gaps& gaps, const Offset& o) {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double gap = gaps[a][at(o[a] + 1)];
      sum += gap * gap;
    }
    return sum * (1 - 4 * kTie);  // rounding must not hide a point on the border
  }
  int first_in(const Cell& home, const Offset& o) const {
    return head_[slot({home[0] + o[0], home[1] + o[1], home[2] + o[2]})];
  }
  static std::uint64_t hash_part(std::size_t axis, std::int64_t c) {
    constexpr std::array<std::uint64_t, 3> kFactor{0x9E3779B97F4A7C15ULL, 0xC2B2AE3D27D4EB4FULL, 0x165667B19E3779F9ULL};
    return static_cast<std::uint64_t>(c) * kFactor[axis];
  }
  /// Upper bits of a sum of multiples spread neighbouring cells well.
  std::size_t slot(const Cell& c) const {
    return static_cast<std::size_t>((hash_part(0, c[0]) + hash_part(1, c[1]) + hash_part(2, c[2])) >> shift_);
  }
  void link(int i) {
    int& head = head_[slot(cell_of(points_[at(i)]))];
    next_[at(i)] = head;
    head = i;
  }
  void grow() {
    head_.assign(2 * head_.size(), -1);
    --shift_;
    for (std::size_t i = 0; i < points_.size(); ++i) link(static_cast<int>(i));
  }
  /// Points in the cells of the cube's shell `ring` cells around.
  template <class Visit>
  void visit_ring(const Cell& home, int ring, Visit&& visit) const {
    for (int a = -ring; a <= ring; ++a)
      for (int b = -ring; b <= ring; ++b) {
        const bool side = std::max(std::abs(a), std::abs(b)) == ring;
        for (int c = -ring; c <= ring; c += side ? 1 : 2 * ring)
          for (int i = first_in(home, {a, b, c}); i >= 0; i = next_[at(i)]) visit(i);
      }
  }

  double cell_;
  int shift_ = 58;  ///< keeps as many bits as the number of slots has
  std::vector<Vec3d> points_;
  std::vector<int> head_, next_;  ///< lists of the points in a slot
};

}  // namespace fascia
