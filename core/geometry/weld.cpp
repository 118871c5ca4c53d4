#include "core/geometry/weld.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace fascia {
namespace {

struct GridCell {
  std::int64_t i = 0, j = 0, k = 0;
  bool operator==(const GridCell&) const = default;
};

struct GridCellHash {
  std::size_t operator()(const GridCell& c) const {
    std::uint64_t h = 0x9E3779B97F4A7C15ull;
    for (const std::int64_t v : {c.i, c.j, c.k}) {
      h ^= static_cast<std::uint64_t>(v);
      h *= 0xBF58476D1CE4E5B9ull;
      h ^= h >> 29;
    }
    return static_cast<std::size_t>(h);
  }
};

/// Representatives found so far, in a hash grid whose cells are wide against the tolerance: most points touch one cell.
class Representatives {
 public:
  Representatives(const std::vector<Vec3d>& points, double tolerance)
      : points_(points), tolerance_(tolerance), width_(10 * tolerance), next_(points.size(), -1) {
    first_.reserve(points.size());
    if (!points.empty()) origin_ = points.front();
  }

  /// The lowest representative within the tolerance of `point`, or −1.
  int find(int point) const {
    const Vec3d& x = points_[static_cast<std::size_t>(point)];
    const GridCell low = cell_of(x, -tolerance_), high = cell_of(x, tolerance_);
    int best = -1;
    for (std::int64_t i = low.i; i <= high.i; ++i)
      for (std::int64_t j = low.j; j <= high.j; ++j)
        for (std::int64_t k = low.k; k <= high.k; ++k) best = lower(best, find_in({i, j, k}, x));
    return best;
  }

  void add(int point) {
    const auto [place, fresh] = first_.try_emplace(cell_of(points_[static_cast<std::size_t>(point)], 0), point);
    if (fresh) return;
    next_[static_cast<std::size_t>(point)] = place->second;
    place->second = point;
  }

 private:
  static int lower(int a, int b) { return a < 0 || (b >= 0 && b < a) ? b : a; }

  GridCell cell_of(const Vec3d& x, double shift) const {
    const auto index = [&](int c) {
      return static_cast<std::int64_t>(std::floor((x[c] - origin_[c] + shift) / width_));
    };
    return {index(0), index(1), index(2)};
  }

  int find_in(const GridCell& cell, const Vec3d& x) const {
    const auto place = first_.find(cell);
    int best = -1;
    for (int p = place == first_.end() ? -1 : place->second; p >= 0; p = next_[static_cast<std::size_t>(p)])
      if (squared_norm(points_[static_cast<std::size_t>(p)] - x) <= tolerance_ * tolerance_) best = lower(best, p);
    return best;
  }

  const std::vector<Vec3d>& points_;
  double tolerance_, width_;
  Vec3d origin_{};
  std::unordered_map<GridCell, int, GridCellHash> first_;
  std::vector<int> next_;
};

}  // namespace

std::vector<int> weld_points(const std::vector<Vec3d>& points, double tolerance) {
  Representatives representatives(points, tolerance);
  std::vector<int> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int point = static_cast<int>(i);
    const int found = representatives.find(point);
    result[i] = found < 0 ? point : found;
    if (found < 0) representatives.add(point);
  }
  return result;
}

}  // namespace fascia
