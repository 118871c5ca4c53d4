#include "meshless/scattered/block_search.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

/// Blocks of this many spacings cost least: larger ones have longer lists, smaller ones more of them.
constexpr double kEdge = 0.7;

}  // namespace

BlockSearch::BlockSearch(std::span<const Vec3d> points, double spacing)
    : points_(points), grid_(spacing), edge_(kEdge * spacing) {
  for (const Vec3d& x : points) grid_.insert(x);
}

BlockSearch::Block BlockSearch::list(const Cell& cell) {
  Vec3d center{};
  for (int a = 0; a < 3; ++a) center[a] = (static_cast<double>(cell[at(a)]) + 0.5) * edge_;
  const int nearest = grid_.nearest(center, INFINITY, [](int) { return true; });
  // No place in the block is farther from the centre than half its diagonal.
  const double radius = norm(points_[at(nearest)] - center) + std::sqrt(3.0) * edge_;
  std::vector<int> near;
  grid_.visit_within(center, radius * (1 + 10 * kTie), [&](int i) { near.push_back(i); });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  const std::size_t begin = point_.size();
  for (const int i : near) add(i, points_[at(i)]);
  while (point_.size() % kLanes > 0) add(-1, {{INFINITY, INFINITY, INFINITY}});
  return {begin, point_.size()};
}

void BlockSearch::add(int point, const Vec3d& x) {
  for (int a = 0; a < 3; ++a) place_[at(a)].push_back(x[a]);
  point_.push_back(point);
}

int BlockSearch::nearest(const Vec3d& x) {
  if (points_.empty()) return -1;
  constexpr double farthest = 1e15;
  Cell cell{};
  for (int a = 0; a < 3; ++a)
    cell[at(a)] = static_cast<std::int64_t>(std::clamp(std::floor(x[a] / edge_), -farthest, farthest));
  if (cell != last_cell_ || last_.begin == last_.end) {
    const auto [known, added] = blocks_.try_emplace(cell);
    if (added) known->second = list(cell);
    last_cell_ = cell;
    last_ = known->second;
  }
  const auto squared = [&](std::size_t k) {
    const double dx = place_[0][k] - x[0], dy = place_[1][k] - x[1], dz = place_[2][k] - x[2];
    return dx * dx + dy * dy + dz * dz;
  };
  std::array<double, kLanes> least;
  least.fill(INFINITY);
  for (std::size_t k = last_.begin; k < last_.end; k += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double d = squared(k + lane);
      least[lane] = d < least[lane] ? d : least[lane];
    }
  const double most = *std::min_element(least.begin(), least.end()) * (1 + kTie);
  std::size_t k = last_.begin;
  while (squared(k) > most) ++k;
  return point_[k];
}

}  // namespace fascia
