#include "core/base/errors.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

SamplePlace place_of(const MatterPiece& p) { return {p.x, p.feature, p.dimension, p.axes, p.extent}; }

std::array<double, 4> measures(const Matter& matter) {
  std::array<double, 4> sum{};
  for (const MatterPiece& p : matter.pieces)
    if (p.volume > 0) sum[at(p.dimension)] += p.measure;
  return sum;
}

bool inside(const Matter& matter, const Vec3d& x) {
  return std::any_of(matter.solids.begin(), matter.solids.end(), [&](const auto& contains) { return contains(x); });
}

std::vector<Dart> random_darts(const Matter& matter, std::vector<int> pieces, std::mt19937& random) {
  for (std::size_t n = pieces.size(); n > 1; --n) {
    const auto chosen = static_cast<std::size_t>((static_cast<std::uint64_t>(random()) * n) >> 32U);
    std::swap(pieces[n - 1], pieces[chosen]);
  }
  std::vector<Dart> darts;
  darts.reserve(pieces.size());
  for (const int p : pieces) {
    const MatterPiece& piece = matter.pieces[at(p)];
    Dart dart{piece.x, p};
    if (piece.feature == 3) {
      const double width = std::cbrt(piece.measure);
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
  int nearest = -1;  ///< piece next to the middle
  double squared = INFINITY;
  bool flat = true;  ///< its pieces have one normal
  Vec3d normal{};

  Vec3d middle() const { return sum * (1 / measure); }
};

/// Whether the middle of pieces is itself a point of their matter.
bool is_place(const Matter& matter, const Gathered& g) {
  const MatterPiece& nearest = matter.pieces[at(g.nearest)];
  if (nearest.feature == 3) return inside(matter, g.middle());
  // Inside of a flat part of a sheet.
  const double off = std::abs(dot(g.middle() - nearest.x, g.normal));
  return nearest.dimension == 2 && g.flat && g.squared <= matter.piece_size * matter.piece_size &&
         off <= 1e-10 * matter.piece_size;
}

}  // namespace

void move_to_middles(const Matter& matter, std::span<const int> pieces, std::span<const int> owner,
                     std::vector<SamplePlace>& samples) {
  std::vector<Gathered> gathered(samples.size());
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    if (owner[n] < 0) continue;
    const MatterPiece& p = matter.pieces[at(pieces[n])];
    Gathered& g = gathered[at(owner[n])];
    const Vec3d normal = p.axes.column(2);
    if (!(g.measure > 0)) g.normal = normal;
    g.flat = g.flat && dot(normal, g.normal) > 1 - 1e-12;
    g.sum += p.x * p.measure;
    g.measure += p.measure;
  }
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    if (owner[n] < 0) continue;
    Gathered& g = gathered[at(owner[n])];
    const double squared = squared_norm(matter.pieces[at(pieces[n])].x - g.middle());
    if (squared >= g.squared * (1 - kTie)) continue;
    g.squared = squared;
    g.nearest = pieces[n];
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Gathered& g = gathered[i];
    if (g.nearest < 0) continue;
    samples[i] = place_of(matter.pieces[at(g.nearest)]);
    if (is_place(matter, g)) samples[i].x = g.middle();
  }
}

}  // namespace fascia
