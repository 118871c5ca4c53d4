#include "meshless/scattered/neighbours.hpp"

#include "core/base/index.hpp"
#include "meshless/scattered/point_grid.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <nanoflann.hpp>

namespace fascia {
namespace {

/// (squared distance, index): the order of results.
using Found = std::pair<double, int>;

/// Bounds of branches are sums that round otherwise than distances: so much more is searched.
constexpr double kSlack = 1 + 1e-12;

// NOLINTBEGIN(readability-identifier-naming): names that nanoflann asks for.

/// Keeps the k first in order.
class Nearest {
 public:
  using DistanceType = double;
  explicit Nearest(std::size_t k) : k_(k) { found_.reserve(k); }
  bool full() const { return found_.size() == k_; }
  double worstDist() const { return full() ? found_.front().first * kSlack : std::numeric_limits<double>::max(); }
  bool addPoint(double squared_distance, std::size_t index) {
    const Found candidate(squared_distance, static_cast<int>(index));
    if (full()) {
      if (!(candidate < found_.front())) return true;
      std::pop_heap(found_.begin(), found_.end());
      found_.pop_back();
    }
    found_.push_back(candidate);
    std::push_heap(found_.begin(), found_.end());
    return true;
  }
  std::vector<Found> take() { return std::move(found_); }

 private:
  std::size_t k_;
  std::vector<Found> found_;  // a heap, the last in order in front
};

/// Keeps all up to a distance.
class Within {
 public:
  using DistanceType = double;
  explicit Within(double squared_radius) : limit_(squared_radius) {}
  bool full() const { return true; }
  double worstDist() const { return limit_ * kSlack + std::numeric_limits<double>::min(); }
  bool addPoint(double squared_distance, std::size_t index) {
    if (squared_distance <= limit_) found_.emplace_back(squared_distance, static_cast<int>(index));
    return true;
  }
  std::vector<Found> take() { return std::move(found_); }

 private:
  double limit_;
  std::vector<Found> found_;
};

// NOLINTEND(readability-identifier-naming)

/// By distance, of equals by index.
void sort_found(std::vector<Found>& found) {
  std::sort(found.begin(), found.end());
  const auto by_index = [](const Found& a, const Found& b) { return a.second < b.second; };
  for (auto first = found.begin(), end = first; first != found.end(); first = end) {
    while (end != found.end() && end->first <= first->first * (1 + kTie)) ++end;
    std::sort(first, end, by_index);
  }
}

std::vector<int> indices_of(std::span<const Found> found) {
  std::vector<int> indices;
  indices.reserve(found.size());
  for (const Found& f : found) indices.push_back(f.second);
  return indices;
}

}  // namespace

struct FrameSearch::Tree {
  // The interface that nanoflann asks for.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i].v[axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 3>;

  explicit Tree(std::span<const Vec3d> positions) : points(positions.begin(), positions.end()), index(3, *this) {}

  template <class Results>
  std::vector<Found> find(const Vec3d& x, Results results) const {
    index.findNeighbors(results, x.v, nanoflann::SearchParams());
    std::vector<Found> found = results.take();
    sort_found(found);
    return found;
  }

  std::vector<Vec3d> points;
  Index index;
};

FrameSearch::FrameSearch(std::span<const Vec3d> positions) : tree_(std::make_unique<Tree>(positions)) {}
FrameSearch::~FrameSearch() = default;
FrameSearch::FrameSearch(FrameSearch&&) noexcept = default;
FrameSearch& FrameSearch::operator=(FrameSearch&&) noexcept = default;

std::vector<int> FrameSearch::nearest(const Vec3d& x, int k) const {
  const std::size_t count = std::min(k > 0 ? at(k) : 0, tree_->points.size());
  if (count == 0) return {};
  std::vector<Found> found = tree_->find(x, Nearest(count + 1));
  const double last = found[count - 1].first, beyond = last * (1 + kTie);
  if (found.size() > count && found[count].first <= beyond) found = tree_->find(x, Within(beyond));
  return indices_of(std::span(found).first(count));
}

std::vector<int> FrameSearch::within(const Vec3d& x, double radius) const {
  if (tree_->points.empty() || !(radius >= 0)) return {};
  return indices_of(tree_->find(x, Within(radius * radius)));
}

namespace {

void clamp_to_median(std::span<double> spacing) {
  if (spacing.empty()) return;
  std::vector<double> sorted(spacing.begin(), spacing.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (double& s : spacing) s = std::clamp(s, 0.5 * *middle, 2 * *middle);
}

}  // namespace

std::vector<double> local_spacing(std::span<const Vec3d> positions, std::span<const int> dimension, std::size_t first) {
  assert(dimension.size() == positions.size());
  std::vector<double> spacing(positions.size(), 0.0);
  if (positions.size() < 2) return spacing;
  const FrameSearch search(positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    int count = 0;
    for (const int j : search.nearest(positions[i], 2 * dimension[i] + 1)) {
      if (j == static_cast<int>(i) || count == 2 * dimension[i]) continue;
      spacing[i] += norm(positions[at(j)] - positions[i]);
      ++count;
    }
    spacing[i] /= count;
  }
  clamp_to_median(std::span(spacing).first(first));
  clamp_to_median(std::span(spacing).subspan(first));
  return spacing;
}

std::vector<std::pair<int, int>> coincident(std::span<const Vec3d> positions, double tolerance) {
  const FrameSearch search(positions);
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (const int j : search.within(positions[i], tolerance))
      if (j > static_cast<int>(i)) pairs.emplace_back(static_cast<int>(i), j);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace fascia
