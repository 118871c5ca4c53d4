#include "meshless/scattered/block_search.hpp"

#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"
#include "core/geometry/bounds.hpp"
#include "core/math/batch.hpp"
#include "meshless/scattered/owned_pieces.hpp"
#include "meshless/scattered/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {

namespace {

/// Blocks of so many places cost least, but no wider than some spacings: larger ones have longer lists of points,
/// smaller ones more lists.
constexpr double kPlaces = 40, kNarrowest = 0.7, kWidest = 1.6;
constexpr int kGrain = 64;  // blocks

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Lanes smaller(const Lanes& a, const Lanes& b) { return Lanes::of(a.v < b.v ? a.v : b.v); }

/// Calls act(j, k) for the rows of cells in a box of them.
template <class Act>
void for_rows(const std::array<int, 3>& low, const std::array<int, 3>& high, const Act& act) {
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j) act(j, k);
}

}  // namespace

BlockSearch::Cells::Cells(const Vec3d& min, const Vec3d& max, double width, double most) : low(min), edge(width) {
  const auto along = [&](int a) { return 1 + std::floor((max[a] - min[a]) / edge); };
  while (along(0) * along(1) * along(2) > most) edge *= 1.1;
  for (int a = 0; a < 3; ++a) count[at(a)] = static_cast<int>(along(a));
}

BlockSearch::Cell BlockSearch::Cells::of(const Vec3d& x) const {
  Cell c{};
  for (int a = 0; a < 3; ++a)
    c[at(a)] = static_cast<int>(std::clamp((x[a] - low[a]) / edge, 0.0, static_cast<double>(count[at(a)] - 1)));
  return c;
}

std::size_t BlockSearch::Cells::number(const Cell& c) const {
  return at(c[0]) + at(count[0]) * (at(c[1]) + at(count[1]) * at(c[2]));
}

std::size_t BlockSearch::Cells::size() const { return at(count[0]) * at(count[1]) * at(count[2]); }

Vec3d BlockSearch::Cells::middle(std::size_t number) const {
  const std::size_t row = number / at(count[0]);
  const std::array<std::size_t, 3> c{number % at(count[0]), row % at(count[1]), row / at(count[1])};
  Vec3d x = low;
  for (int a = 0; a < 3; ++a) x[a] += (static_cast<double>(c[at(a)]) + 0.5) * edge;
  return x;
}

BlockSearch::BlockSearch(std::span<const Vec3d> places, double spacing, ThreadPool& pool, double asked)
    : blocks_({}, {}, 1, 1), spacing_(spacing), begin_(2, 0) {
  if (places.empty()) return;
  const Bounds bounds = bounds_of(places);
  const double most = std::max(1e6, 2.0 * static_cast<double>(places.size()));
  double volume = 1;  // of the box, in spacings; thin ones have places side by side
  for (int a = 0; a < 3; ++a) volume *= std::max(1.0, (bounds.high[a] - bounds.low[a]) / spacing);
  const double edge = std::cbrt(kPlaces * volume / (asked * static_cast<double>(places.size())));
  blocks_ = Cells(bounds.low, bounds.high, std::clamp(edge, kNarrowest, kWidest) * spacing, most);
  low_ = bounds.low;
  high_ = bounds.high;
  RawArray<int> block(places.size());
  constexpr int kSome = 4096;
  pool.for_ranges(static_cast<int>(places.size()), kSome, [&](int first, int last) {
    for (std::size_t p = at(first); p < at(last); ++p)
      block[p] = static_cast<int>(blocks_.number(blocks_.of(places[p])));
  });
  begin_.assign(blocks_.size() + 1, 0);
  for (const int b : block.span()) ++begin_[at(b) + 1];
  for (std::size_t b = 1; b < begin_.size(); ++b)
    begin_[b] = begin_[b - 1] + (begin_[b] + kLanes - 1) / kLanes * kLanes;
  for (RawArray<double>& x : x_) x = RawArray<double>(begin_.back());
  place_ = RawArray<int>(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  OwnedPieces(block.span(), blocks_.size()).for_each(pool, [&](std::size_t p, std::size_t own) {
    const std::size_t n = next[own]++;
    for (int a = 0; a < 3; ++a) x_[at(a)][n] = places[p][a];
    place_[n] = static_cast<int>(p);
  });
  for (std::size_t b = 0; b < next.size(); ++b)
    for (std::size_t n = next[b]; n < begin_[b + 1]; ++n) {
      for (RawArray<double>& x : x_) x[n] = 0;
      place_[n] = -1;
    }
}

BlockSearch::Sorted BlockSearch::sorted(std::span<const Vec3d> points) const {
  constexpr double kCells = 8, kFew = 1e4;
  const Cells cells(low_, high_, spacing_, std::max(kFew, kCells * static_cast<double>(points.size())));
  Sorted out{cells, std::vector<int>(cells.size() + 1, 0), std::vector<int>(points.size()),
             std::vector<Vec3d>(points.size())};
  for (const Vec3d& x : points) ++out.begin[cells.number(cells.of(x)) + 1];
  for (std::size_t c = 1; c < out.begin.size(); ++c) out.begin[c] += out.begin[c - 1];
  std::vector<int> next(out.begin.begin(), out.begin.end() - 1);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::size_t n = at(next[cells.number(cells.of(points[p]))]++);
    out.index[n] = static_cast<int>(p);
    out.x[n] = points[p];
  }
  return out;
}

/// No place in the block is farther than this from the point nearest to it: the distance of the farthest corner from a
/// point near the block.
double BlockSearch::reach_of(const Vec3d& middle, double half, const Sorted& points) const {
  const Cell home = points.cells.of(middle);
  double squared = kInfinity;
  const int most = *std::max_element(points.cells.count.begin(), points.cells.count.end());
  for (int ring = 1; ring <= most && squared == kInfinity; ++ring) {
    Cell low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(0, home[a] - ring);
      high[a] = std::min(points.cells.count[a] - 1, home[a] + ring);
    }
    for_rows(low, high, [&](int j, int k) {
      const int end = points.begin[points.cells.number({high[0], j, k}) + 1];
      for (int n = points.begin[points.cells.number({low[0], j, k})]; n < end; ++n) {
        double sum = 0;
        for (int a = 0; a < 3; ++a) {
          const double farthest = std::abs(points.x[at(n)][a] - middle[a]) + half;
          sum += farthest * farthest;
        }
        squared = std::min(squared, sum);
      }
    });
  }
  return std::sqrt(squared);
}

void BlockSearch::list(const Vec3d& middle, double half, const Sorted& points, Candidates& out) const {
  // Rounding, and equals that are so but for kTie, must not hide a point.
  const double reach = reach_of(middle, half, points) * (1 + 10 * kTie);
  half *= 1 + 10 * kTie;
  const Vec3d around{{reach + half, reach + half, reach + half}};
  const Cell low = points.cells.of(middle - around), high = points.cells.of(middle + around);
  out.count = 0;
  for_rows(low, high, [&](int j, int k) {
    const int begin = points.begin[points.cells.number({low[0], j, k})],
              end = points.begin[points.cells.number({high[0], j, k}) + 1];
    out.make_room(at(end - begin));
    for (int n = begin; n < end; ++n) {  // without branches that nobody can foresee
      const Vec3d& x = points.x[at(n)];
      double squared = 0;  // from the block
      for (int a = 0; a < 3; ++a) {
        const double outside = std::max(0.0, std::abs(x[a] - middle[a]) - half);
        squared += outside * outside;
      }
      for (int a = 0; a < 3; ++a) out.x[at(a)][out.count] = x[a];
      out.index[out.count] = points.index[at(n)];
      out.count += squared <= reach * reach ? 1 : 0;
    }
  });
}

void BlockSearch::search(std::size_t first, std::size_t last, const Candidates& among, std::span<const Vec3d> around,
                         std::span<int> nearest) const {
  const std::size_t count = among.count;
  const Lanes infinity(kInfinity);
  for (std::size_t n = first; n < last; n += at(kBatchWidth)) {
    for (std::size_t o = 0; o < around.size(); ++o) {
      const Vec3d& off = around[o];
      const Lanes x = Lanes::load(&x_[0][n]) + Lanes(off[0]), y = Lanes::load(&x_[1][n]) + Lanes(off[1]),
                  z = Lanes::load(&x_[2][n]) + Lanes(off[2]);
      const auto squared = [&](std::size_t c) {
        const Lanes dx = x - among.x[0][c], dy = y - among.x[1][c], dz = z - among.x[2][c];
        return dx * dx + dy * dy + dz * dz;
      };
      Lanes least = infinity;
      for (std::size_t c = 0; c < count; ++c) least = smaller(least, squared(c));
      least *= 1 + kTie;
      Lanes index = infinity;
      for (std::size_t c = 0; c < count; ++c)
        index = smaller(index, where_positive(squared(c) - least, infinity, Lanes(among.index[c])));
      for (int lane = 0; lane < kBatchWidth; ++lane)
        if (const int place = place_[n + at(lane)]; place >= 0)
          nearest[at(place) * around.size() + o] = static_cast<int>(index.v[lane]);
    }
  }
}

void BlockSearch::nearest(std::span<const Vec3d> points, std::span<int> nearest, ThreadPool& pool,
                          std::span<const Vec3d> around) const {
  if (points.empty()) {
    std::fill(nearest.begin(), nearest.end(), -1);
    return;
  }
  double half = 0.5 * blocks_.edge, farthest = 0;
  for (const Vec3d& off : around)
    for (int a = 0; a < 3; ++a) farthest = std::max(farthest, std::abs(off[a]));
  half += farthest;
  const Sorted by_cell = sorted(points);
  for_throwing_ranges(pool, static_cast<int>(blocks_.size()), kGrain, [&](int begin, int end) {
    Candidates among;
    for (std::size_t b = at(begin); b < at(end); ++b) {
      if (begin_[b] == begin_[b + 1]) continue;
      list(blocks_.middle(b), half, by_cell, among);
      search(begin_[b], begin_[b + 1], among, around, nearest);
    }
  });
}

}  // namespace fascia
