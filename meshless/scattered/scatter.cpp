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
  double best = boundless_spacing(matter, count), best_error = INFINITY;
  std::optional<FrameSampler> frames;
  if (with_features) frames.emplace(matter, seed, occupied, pool);
  const auto excess = [&](double s) {
    const double n = frames ? static_cast<double>(frames->places(s, false).size()) : expected_points(matter, s);
    if (std::abs(n - count) < best_error) {
      best_error = std::abs(n - count);
      best = s;
    }
    return n - count;
  };

  // A pair of spacings around the count, then bisection; the count falls with the spacing but for small steps.
  constexpr double step = 1.2;
  constexpr int most_steps = 60;
  double low = best, high = best;
  if (excess(best) > 0) {
    for (int k = 0; k < most_steps; ++k)
      if (excess(high *= step) <= 0) break;
    low = high / step;
  } else {
    const double least = 0.25 * matter.piece_size;
    for (int k = 0; k < most_steps && low > least; ++k)
      if (excess(low /= step) >= 0) break;
    high = low * step;
  }
  for (int k = 0; k < 16 && best_error > 0.004 * count; ++k) {
    const double middle = std::sqrt(low * high);
    (excess(middle) > 0 ? low : high) = middle;
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
