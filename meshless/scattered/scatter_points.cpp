#include "meshless/scattered/block_search.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <cmath>
#include <optional>

namespace fascia {
namespace {

constexpr int kRounds = 4;  // of relaxation

/// Mean spacing over least distance of a saturated random sample without boundary, by dimension.
constexpr std::array<double, 4> kSaturated{1, 1.338, 1.198, 1.109};

double wanted(double measure, int dimension, double spacing) {
  return measure > 0 ? std::max(1.0, rounded(measure / std::pow(spacing, dimension))) : 0;
}

std::vector<SamplePlace> throw_at(const Matter& matter, const PieceList& pieces, const Darts& darts, double least,
                                  ThreadPool& pool) {
  std::vector<SamplePlace> samples;
  PointGrid grid(least * (1 + kTie));  // what meets but for rounding is in the cells around
  const auto meets = [&](std::size_t n, int i, double) {
    return pieces.solid() || alike(samples[at(i)], pieces.thin(n));
  };
  throw_darts(matter, pieces, darts, pool, grid, least, meets, [&](const SamplePlace& place) {
    samples.push_back(place);
    grid.insert(place.x);
  });
  return samples;
}

/// Darts about as many as wanted: samples gather at the boundary, so the distance depends on the shape.
std::vector<SamplePlace> throw_about(const Matter& matter, const PieceList& pieces, const Darts& darts, double spacing,
                                     double count, ThreadPool& pool) {
  constexpr int most_trials = 8;
  const int dimension = pieces.solid() ? 3 : 2;
  double least = spacing / kSaturated[at(dimension)];
  std::vector<SamplePlace> best;
  double best_error = INFINITY;
  for (int trial = 0; trial < most_trials && best_error > 0.01 * count; ++trial) {
    std::vector<SamplePlace> samples = throw_at(matter, pieces, darts, least, pool);
    const double n = static_cast<double>(samples.size());
    least *= std::pow(n / count, 1.0 / dimension);
    if (std::abs(n - count) >= best_error) continue;
    best_error = std::abs(n - count);
    best = std::move(samples);
  }
  return best;
}

/// Evens out the distances between samples of some pieces.
void relax(const Matter& matter, const PieceList& pieces, std::vector<SamplePlace>& samples, ThreadPool& pool) {
  std::optional<BlockSearch> in_solid;
  if (pieces.solid()) in_solid.emplace(matter.voxels.x, spacing_in_solids(matter, samples.size()), pool);
  RawArray<int> owner(pieces.size());
  for (int round = 0; round < kRounds; ++round) {
    if (in_solid) {
      in_solid->nearest(positions_of(samples), owner.span(), pool);
    } else {
      const OwnerSearch search(matter, samples);
      for (std::size_t n = 0; n < pieces.size(); ++n) owner[n] = search.owner(pieces.thin(n));
    }
    move_to_middles(matter, pieces, owner.span(), samples, pool);
  }
}

}  // namespace

double expected_points(const Matter& matter, double spacing) {
  double count = wanted(matter.measure[2], 2, spacing) + wanted(matter.measure[3], 3, spacing);
  for (const FeatureChain& chain : matter.chains)
    if (chain.dimension == 1) count += interval_count(chain, spacing);
  return count;
}

std::vector<SamplePlace> point_places(const Matter& matter, double spacing, int seed, ThreadPool& pool) {
  std::mt19937 random(static_cast<std::uint32_t>(seed));
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
  const auto in_sheets = [](const MatterPiece& p) { return p.volume > 0 && p.dimension == 2; };
  for (const PieceList& pieces :
       {PieceList::of_thin(matter, select_pieces(matter, in_sheets)), PieceList::of_solids(matter)}) {
    if (pieces.size() == 0) continue;
    const Darts darts = random_darts(pieces, random, pool);
    const int dimension = pieces.solid() ? 3 : 2;
    const double count = wanted(matter.measure[at(dimension)], dimension, spacing);
    std::vector<SamplePlace> samples = throw_about(matter, pieces, darts, spacing, count, pool);
    relax(matter, pieces, samples, pool);
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

}  // namespace fascia
