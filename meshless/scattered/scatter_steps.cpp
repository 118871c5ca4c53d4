#include "core/base/errors.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fascia {

SamplePlace place_of(const MatterPiece& p) { return {p.x, p.feature, p.dimension, p.axes, p.extent}; }

bool inside(const Matter& matter, const Vec3d& x) {
  return std::any_of(matter.solids.begin(), matter.solids.end(), [&](const auto& contains) { return contains(x); });
}

std::vector<Dart> random_darts(const PieceList& pieces, std::mt19937& random) {
  std::vector<int> order(pieces.size());
  std::iota(order.begin(), order.end(), 0);
  constexpr std::size_t kAhead = 32;  // what is far apart in memory is fetched while other darts are made
  std::array<std::size_t, kAhead> chosen{};
  for (std::size_t n = order.size(), count = 0; n > 1; n -= count) {
    count = std::min(kAhead, n - 1);
    for (std::size_t k = 0; k < count; ++k) {
      chosen[k] = static_cast<std::size_t>((static_cast<std::uint64_t>(random()) * (n - k)) >> 32U);
      __builtin_prefetch(&order[chosen[k]]);
    }
    for (std::size_t k = 0; k < count; ++k) std::swap(order[n - 1 - k], order[chosen[k]]);
  }
  std::vector<Dart> darts;
  darts.reserve(order.size());
  double measure = 0, width = 0;  // of the last voxel: most are alike
  for (std::size_t n = 0; n < order.size(); ++n) {
    if (n + kAhead < order.size()) __builtin_prefetch(&pieces.x(at(order[n + kAhead])));
    const int p = order[n];
    Dart dart{pieces.x(at(p)), p};
    if (pieces.solid()) {
      if (pieces.measure(at(p)) != measure) width = std::cbrt(measure = pieces.measure(at(p)));
      for (int a = 0; a < 3; ++a) dart.x[a] += width * (static_cast<double>(random()) * 0x1p-32 - 0.5);
    }
    darts.push_back(dart);
  }
  return darts;
}

double chain_length(const FeatureChain& chain) {
  double length = 0;
  for (std::size_t s = 0; s + 1 < chain.points.size(); ++s) length += norm(chain.points[s + 1] - chain.points[s]);
  return length;
}

int interval_count(const FeatureChain& chain, double spacing) {
  const double count = rounded(chain_length(chain) / spacing);
  constexpr double most = 5e7;
  if (!(count <= most)) throw InputError("the edges take more than 5e7 samples; use a larger spacing");
  return std::max(chain.closed ? 3 : 1, static_cast<int>(count));
}

std::vector<SamplePlace> places_on(const FeatureChain& chain, std::span<const double> fractions) {
  const double length = chain_length(chain);
  std::vector<SamplePlace> places;
  std::size_t segment = 0;
  double before = 0, here = norm(chain.points[1] - chain.points[0]);
  for (const double fraction : fractions) {
    const double target = fraction * length;
    while (target > before + here && segment + 2 < chain.points.size()) {
      before += here;
      ++segment;
      here = norm(chain.points[segment + 1] - chain.points[segment]);
    }
    const double u = std::clamp((target - before) / here, 0.0, 1.0);
    const Vec3d &a = chain.points[segment], &b = chain.points[segment + 1];
    places.push_back({a + (b - a) * u, 1, chain.dimension, chain.axes[segment], chain.extent[segment]});
  }
  return places;
}

namespace {

/// A sample's pieces, summed up.
struct Gathered {
  Vec3d sum{};
  double measure = 0;
  std::size_t nearest = 0;  ///< piece next to the middle
  double squared = INFINITY;
  bool flat = true;  ///< its pieces have one normal
  Vec3d normal{};

  Vec3d middle() const { return sum * (1 / measure); }
};

/// Whether the middle of pieces is itself a point of their matter.
bool is_place(const Matter& matter, const PieceList& pieces, const Gathered& g) {
  if (pieces.solid()) return inside(matter, g.middle());
  // Inside of a flat part of a sheet.
  const MatterPiece& nearest = pieces.thin(g.nearest);
  const double off = std::abs(dot(g.middle() - nearest.x, g.normal));
  return nearest.dimension == 2 && g.flat && g.squared <= matter.piece_size * matter.piece_size &&
         off <= 1e-10 * matter.piece_size;
}

}  // namespace

void move_to_middles(const Matter& matter, const PieceList& pieces, std::span<const int> owner,
                     std::vector<SamplePlace>& samples) {
  std::vector<Gathered> gathered(samples.size());
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    if (owner[n] < 0) continue;
    Gathered& g = gathered[at(owner[n])];
    if (!pieces.solid()) {
      const Vec3d normal = pieces.thin(n).axes.column(2);
      if (!(g.measure > 0)) g.normal = normal;
      g.flat = g.flat && dot(normal, g.normal) > 1 - 1e-12;
    }
    g.sum += pieces.x(n) * pieces.measure(n);
    g.measure += pieces.measure(n);
  }
  std::vector<Vec3d> middle;
  middle.reserve(samples.size());
  for (const Gathered& g : gathered) middle.push_back(g.middle());
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    if (owner[n] < 0) continue;
    Gathered& g = gathered[at(owner[n])];
    const double squared = squared_norm(pieces.x(n) - middle[at(owner[n])]);
    if (squared >= g.squared * (1 - kTie)) continue;
    g.squared = squared;
    g.nearest = n;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Gathered& g = gathered[i];
    if (g.squared == INFINITY) continue;
    samples[i] = pieces.place(g.nearest);
    if (is_place(matter, pieces, g)) samples[i].x = g.middle();
  }
}

}  // namespace fascia
