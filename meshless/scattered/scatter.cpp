#include "meshless/scattered/scatter.hpp"

#include "core/base/errors.hpp"
#include "core/geometry/space_order.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <cmath>
#include <optional>

namespace fascia {
namespace {

void check_spacing(const Matter& matter, double spacing) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw InputError("the spacing of samples is not positive; give their mean distance in metres");
  if (matter.pieces.empty() && matter.voxels.size() == 0)
    throw InputError("there is no matter to sample; the body needs a domain with volume");
}

/// The spacing of `count` samples were there no boundary: Σ measure / spacing^dimension = count.
double boundless_spacing(const Matter& matter, int count) {
  const std::array<double, 4>& measure = matter.measure;
  double low = 0, high = 0;
  for (int d = 1; d <= 3; ++d) high = std::max(high, std::pow(3 * measure[at(d)] / count, 1.0 / d));
  for (int round = 0; round < 100; ++round) {
    const double s = 0.5 * (low + high);
    double n = 0;
    for (int d = 1; d <= 3; ++d) n += measure[at(d)] / std::pow(s, d);
    (n > count ? low : high) = s;
  }
  return high;
}

}  // namespace

namespace {

/// Puts neighbours near each other, as products with the matrix and searches like them.
std::vector<SamplePlace> in_order(const std::vector<SamplePlace>& places) {
  std::vector<Vec3d> x;
  x.reserve(places.size());
  for (const SamplePlace& p : places) x.push_back(p.x);
  std::vector<SamplePlace> sorted;
  sorted.reserve(places.size());
  constexpr double kCells = 1000.618;  // features lie at halves and thirds
  for (const std::size_t i : order_in_space(x, kCells)) sorted.push_back(places[i]);
  return sorted;
}

}  // namespace

std::vector<SamplePlace> poisson_disk(const Matter& matter, double spacing, int seed, bool with_features,
                                      ThreadPool& pool, std::span<const Vec3d> occupied) {
  check_spacing(matter, spacing);
  return in_order(with_features ? FrameSampler(matter, seed, occupied, pool).places(spacing, true)
                                : point_places(matter, spacing, seed, pool));
}

double spacing_for_count(const Matter& matter, int count, int seed, bool with_features, ThreadPool& pool,
                         std::span<const Vec3d> occupied) {
  if (count < 1) throw InputError("the number of samples is not positive; at least 1 is needed");
  check_spacing(matter, 1);
  std::optional<FrameSampler> frames;
  if (with_features) frames.emplace(matter, seed, occupied, pool);
  const auto number = [&](double spacing) {
    return frames ? static_cast<double>(frames->places(spacing, false).size()) : expected_points(matter, spacing);
  };

  // The number falls with the spacing but for small steps: a pair of spacings around it, then spacings between them.
  constexpr int most_trials = 60;
  constexpr double kExponent = 2.5, kBeyond = 1.05, kNarrow = 1e-9;
  constexpr double kLeast = 0.2, kMost = 0.8;  // of the way from one spacing to the other
  const double close_enough = frames ? 0.004 * count : 0.5, least = 0.25 * matter.piece_size;
  double spacing = boundless_spacing(matter, count), best = spacing, best_error = INFINITY;
  double low = 0, high = INFINITY, above = 0, below = 0;  // logarithms of how far the numbers there are off
  for (int trial = 0; trial < most_trials && best_error > close_enough; ++trial) {
    const double n = number(spacing), off = std::log(std::max(n, 0.5) / count);
    if (std::abs(n - count) < best_error) {
      best_error = std::abs(n - count);
      best = spacing;
    }
    if (n > count) {
      low = spacing;
      above = off;
    } else {
      high = spacing;
      below = -off;
    }
    if (high <= least || high - low <= kNarrow * low) break;
    if (low > 0 && high < INFINITY)
      spacing = low * std::pow(high / low, std::clamp(above / (above + below), kLeast, kMost));
    else
      spacing *= std::exp(off / kExponent) * (n > count ? kBeyond : 1 / kBeyond);
  }
  return best;
}

std::vector<SamplePlace> places_at(const Matter& matter, std::span<const Vec3d> positions) {
  PointGrid grid(2 * matter.piece_size);
  const int voxels = static_cast<int>(matter.voxels.size());
  const std::vector<int> thin = select_pieces(matter, [](const MatterPiece& p) { return p.volume > 0; });
  if (voxels == 0 && thin.empty())
    throw InputError("there is no matter to sample; the body needs a domain with volume");
  for (const Vec3d& x : matter.voxels.x) grid.insert(x);
  for (const int p : thin) grid.insert(matter.pieces[at(p)].x);
  std::vector<SamplePlace> places;
  for (const Vec3d& x : positions) {
    const int nearest = grid.nearest(x, INFINITY, [](int) { return true; });
    places.push_back(nearest < voxels ? voxel_place({}) : place_of(matter.pieces[at(thin[at(nearest - voxels)])]));
    places.back().x = x;
  }
  return places;
}

}  // namespace fascia
