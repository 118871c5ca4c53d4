#include "meshless/scattered/scatter_parts.hpp"

#include <cmath>

namespace fascia {
namespace {

constexpr int kRounds = 4;  // of relaxation

/// Mean spacing over least distance of a saturated random sample without boundary, by dimension.
constexpr std::array<double, 4> kSaturated{1, 1.338, 1.198, 1.109};

double wanted(double measure, int dimension, double spacing) {
  return measure > 0 ? std::max(1.0, rounded(measure / std::pow(spacing, dimension))) : 0;
}

std::vector<SamplePlace> throw_at(const Matter& matter, std::span<const Dart> darts, double least) {
  std::vector<SamplePlace> samples;
  PointGrid grid(least);
  const auto conflict = [&](const MatterPiece& piece, const Vec3d& x) {
    return grid.any_within(x, least, [&](int i, double) { return alike(samples[at(i)], piece); });
  };
  throw_darts(matter, darts, conflict, [&](const SamplePlace& place) {
    samples.push_back(place);
    grid.insert(place.x);
  });
  return samples;
}

/// Darts about as many as wanted: samples gather at the boundary, so the distance depends on the shape.
std::vector<SamplePlace> throw_about(const Matter& matter, std::span<const Dart> darts, int dimension, double spacing,
                                     double count) {
  constexpr int most_trials = 8;
  double least = spacing / kSaturated[at(dimension)];
  std::vector<SamplePlace> best;
  double best_error = INFINITY;
  for (int trial = 0; trial < most_trials && best_error > 0.01 * count; ++trial) {
    std::vector<SamplePlace> samples = throw_at(matter, darts, least);
    const double n = static_cast<double>(samples.size());
    least *= std::pow(n / count, 1.0 / dimension);
    if (std::abs(n - count) >= best_error) continue;
    best_error = std::abs(n - count);
    best = std::move(samples);
  }
  return best;
}

}  // namespace

double expected_points(const Matter& matter, double spacing) {
  const std::array<double, 4> measure = measures(matter);
  double count = wanted(measure[2], 2, spacing) + wanted(measure[3], 3, spacing);
  for (const FeatureChain& chain : matter.chains)
    if (chain.dimension == 1) count += interval_count(chain, spacing);
  return count;
}

std::vector<SamplePlace> point_places(const Matter& matter, double spacing, int seed) {
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  const std::array<double, 4> measure = measures(matter);
  std::vector<SamplePlace> all;
  for (const FeatureChain& chain : matter.chains) {
    if (chain.dimension != 1) continue;
    const int count = interval_count(chain, spacing);
    std::vector<double> fractions;
    fractions.reserve(at(count));
    for (int k = 0; k < count; ++k) fractions.push_back((k + 0.5) / count);
    const std::vector<SamplePlace> places = places_on(chain, fractions);
    all.insert(all.end(), places.begin(), places.end());
  }
  for (const int dimension : {2, 3}) {
    const std::vector<int> pieces =
        select_pieces(matter, [&](const MatterPiece& p) { return p.volume > 0 && p.dimension == dimension; });
    if (pieces.empty()) continue;
    const std::vector<Dart> darts = random_darts(matter, pieces, random);
    std::vector<SamplePlace> samples =
        throw_about(matter, darts, dimension, spacing, wanted(measure[at(dimension)], dimension, spacing));
    for (int round = 0; round < kRounds; ++round) {
      OwnerSearch search(matter, samples);
      std::vector<int> owner;
      owner.reserve(pieces.size());
      for (const int p : pieces) owner.push_back(search.owner(matter.pieces[at(p)]));
      move_to_middles(matter, pieces, owner, samples);
    }
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

}  // namespace fascia
