#include "gpu/tiles/tile_cut.hpp"

#include <algorithm>
#include <numeric>

namespace fascia {

namespace {

/// Points that neighbouring lanes hold share their frames down to this size.
constexpr std::size_t kFinest = 8;

class Cutter {
 public:
  Cutter(const TilePoints& points, std::size_t tile_size, std::size_t most_frames, TileCut& out)
      : points_(points), tile_size_(tile_size), most_frames_(most_frames), out_(out) {}

  void cut(TileRange range) {
    const std::size_t n = range.end - range.begin;
    if (n > tile_size_) {
      const std::size_t tiles = (n + tile_size_ - 1) / tile_size_;
      const std::size_t middle = range.begin + tiles / 2 * even_share(n, tiles);
      bisect(range, middle);
      cut({range.begin, middle});
      cut({middle, range.end});
    } else if (n > 1 && frame_count(range) > most_frames_) {
      const std::size_t middle = range.begin + n / 2;
      bisect(range, middle);
      cut({range.begin, middle});
      cut({middle, range.end});
    } else if (n > 0) {
      refine(range);
      out_.ranges.push_back(range);
    }
  }

 private:
  /// Whole tiles; of few tiles, equal ones.
  std::size_t even_share(std::size_t n, std::size_t tiles) const {
    constexpr std::size_t few = 256;
    return tiles > few ? tile_size_ : (n + tiles - 1) / tiles;
  }

  void refine(TileRange range) {
    const std::size_t n = range.end - range.begin;
    if (n <= kFinest) return;
    const std::size_t middle = range.begin + (n / 2 + kFinest - 1) / kFinest * kFinest;
    bisect(range, middle);
    refine({range.begin, middle});
    refine({middle, range.end});
  }

  void bisect(TileRange range, std::size_t middle) {
    Vec3d low = points_.X[at(out_.order[range.begin])], high = low;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const Vec3d& x = points_.X[at(out_.order[i])];
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], x[a]);
        high[a] = std::max(high[a], x[a]);
      }
    }
    int axis = 0;
    for (int a = 1; a < 3; ++a)
      if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    const auto first = out_.order.begin();
    std::nth_element(first + static_cast<std::ptrdiff_t>(range.begin), first + static_cast<std::ptrdiff_t>(middle),
                     first + static_cast<std::ptrdiff_t>(range.end), [&](int a, int b) {
                       const double xa = points_.X[at(a)][axis], xb = points_.X[at(b)][axis];
                       return xa < xb || (xa == xb && a < b);
                     });
  }

  std::size_t frame_count(TileRange range) {
    seen_.clear();
    for (std::size_t i = range.begin; i < range.end; ++i)
      for (std::size_t k = points_.begin[at(out_.order[i])]; k < points_.begin[at(out_.order[i]) + 1]; ++k)
        seen_.push_back(points_.node[k]);
    std::sort(seen_.begin(), seen_.end());
    return static_cast<std::size_t>(std::unique(seen_.begin(), seen_.end()) - seen_.begin());
  }

  const TilePoints& points_;
  std::size_t tile_size_, most_frames_;
  TileCut& out_;
  std::vector<int> seen_;
};

}  // namespace

TileCut cut_points(const TilePoints& points, int tile_size, int most_frames) {
  TileCut cut;
  cut.order.resize(at(points.point_count()));
  std::iota(cut.order.begin(), cut.order.end(), 0);
  std::stable_sort(cut.order.begin(), cut.order.end(),
                   [&](int a, int b) { return points.blend[at(a)] < points.blend[at(b)]; });
  Cutter cutter(points, at(tile_size), at(most_frames), cut);
  for (std::size_t begin = 0; begin < cut.order.size();) {
    std::size_t end = begin;
    const double blend = points.blend[at(cut.order[begin])];
    while (end < cut.order.size() && points.blend[at(cut.order[end])] == blend) ++end;
    cutter.cut({begin, end});
    begin = end;
  }
  return cut;
}

}  // namespace fascia
