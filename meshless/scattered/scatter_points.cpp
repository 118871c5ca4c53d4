#include "meshless/scattered/block_search.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <cmath>
#include <optional>

namespace fascia {
namespace {

constexpr int kRounds = 4;  // of relaxation

/// Mean spacing over least distance of a saturated random sample without boundary, by dimension.
constexpr std::array<double, 4> kSaturated{1, 1.338, 1.198, 1.109};
/// How many of the samples of a saturated one so many darts for each give, and some to spare: fitted to solids. A count
/// that is missed by it is met by another throw.
double part_that_fits(double darts) { return 0.96 * (1 - 0.7 * std::pow(std::max(darts, 1.0), -0.43)); }

double wanted(double measure, int dimension, double spacing) {
  return measure > 0 ? std::max(1.0, rounded(measure / std::pow(spacing, dimension))) : 0;
}

struct Throw {
  std::vector<SamplePlace> samples;
  double darts = 0;  ///< that were thrown
};

/// Random places at least so far from one another, until there are enough or no more fit.
Throw throw_at(const Matter& matter, const PieceList& pieces, const Darts& darts, double least, std::size_t enough,
               ThreadPool& pool) {
  Throw thrown;
  PointGrid grid(least * (1 + kTie));  // what meets but for rounding is in the cells around
  const auto meets = [&](std::size_t n, int i, double) {
    return pieces.solid() || alike(thrown.samples[at(i)], pieces.thin(n));
  };
  thrown.darts =
      static_cast<double>(throw_darts(matter, pieces, darts, pool, grid, least, meets, [&](const SamplePlace& place) {
        thrown.samples.push_back(place);
        grid.insert(place.x);
        return thrown.samples.size() < enough;
      }));
  return thrown;
}

/// Throws as many places as wanted where they fit. More than the spacing says fit where matter is thin, since samples
/// gather at the boundary: few darts are needed then, and places are uneven, so they are thrown at a larger distance.
/// Where fewer fit they may come nearer to one another.
std::vector<SamplePlace> throw_count(const Matter& matter, const PieceList& pieces, const Darts& darts, double spacing,
                                     std::size_t count, ThreadPool& pool) {
  constexpr double kNearer = 0.98, kFarther = 1.1, kMuchFarther = 1.4;
  constexpr double kEarly = 0.25, kVeryEarly = 3;  // of all darts; darts a sample
  constexpr int kMostTrials = 12;
  const int dimension = pieces.solid() ? 3 : 2;
  const double all = static_cast<double>(darts.size()), each = all / static_cast<double>(count);
  double least = spacing / kSaturated[at(dimension)] * std::pow(part_that_fits(each), 1.0 / dimension);
  std::vector<SamplePlace> samples;
  bool short_of = false;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    Throw thrown = throw_at(matter, pieces, darts, least, count, pool);
    const double found = static_cast<double>(thrown.samples.size());
    if (thrown.samples.size() >= samples.size()) samples = std::move(thrown.samples);
    if (found >= static_cast<double>(count)) {
      if (short_of || thrown.darts > kEarly * all) break;
      least *= thrown.darts < kVeryEarly * found ? kMuchFarther : kFarther;
    } else {
      short_of = true;
      least *= kNearer * std::pow(found / static_cast<double>(count), 1.0 / dimension);
    }
  }
  return samples;
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
    const auto count = static_cast<std::size_t>(wanted(matter.measure[at(dimension)], dimension, spacing));
    std::vector<SamplePlace> samples = throw_count(matter, pieces, darts, spacing, count, pool);
    relax(matter, pieces, samples, pool);
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

}  // namespace fascia
