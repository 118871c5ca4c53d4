#include "core/base/errors.hpp"
#include "meshless/scattered/owned_pieces.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fascia {

SamplePlace place_of(const MatterPiece& p) { return {p.x, p.feature, p.dimension, p.axes, p.extent}; }

bool inside(const Matter& matter, const Vec3d& x) {
  return std::any_of(matter.solids.begin(), matter.solids.end(), [&](const auto& contains) { return contains(x); });
}

namespace {

constexpr std::size_t kAhead = 32;  // what is far apart in memory is fetched while other darts are made

RawArray<int> random_order(std::size_t size, std::mt19937& random) {
  RawArray<int> order(size);
  std::iota(order.span().begin(), order.span().end(), 0);
  std::array<std::size_t, kAhead> chosen{};
  for (std::size_t n = size, count = 0; n > 1; n -= count) {
    count = std::min(kAhead, n - 1);
    for (std::size_t k = 0; k < count; ++k) {
      chosen[k] = static_cast<std::size_t>((static_cast<std::uint64_t>(random()) * (n - k)) >> 32U);
      __builtin_prefetch(&order[chosen[k]]);
    }
    for (std::size_t k = 0; k < count; ++k) std::swap(order[n - 1 - k], order[chosen[k]]);
  }
  return order;
}

}  // namespace

Darts random_darts(const PieceList& pieces, std::mt19937& random, ThreadPool& pool) {
  const std::size_t size = pieces.size();
  Darts darts{AlignedVector<Vec3d>(size), random_order(size, random), RawArray<int>(size)};
  // Numbers come one after the other, for some darts at once; these are made by all threads.
  constexpr std::size_t kSome = 1 << 17;
  constexpr int kGrain = 4096;
  std::vector<std::uint32_t> numbers;
  for (std::size_t begin = 0; begin < size; begin += kSome) {
    const std::size_t count = std::min(kSome, size - begin);
    if (pieces.solid()) {
      numbers.resize(3 * count);
      for (std::uint32_t& n : numbers) n = static_cast<std::uint32_t>(random());
    }
    pool.for_ranges(static_cast<int>(count), kGrain, [&](int first, int last) {
      double measure = 0, width = 0;  // of the last voxel: most are alike
      for (std::size_t n = at(first); n < at(last); ++n) {
        if (const std::size_t next = begin + n + kAhead; next < size) {
          const std::size_t p = at(darts.order[next]);
          __builtin_prefetch(&pieces.x(p));
          if (pieces.solid()) __builtin_prefetch(&pieces.measure(p));
          __builtin_prefetch(&darts.x[p], 1);
          __builtin_prefetch(&darts.turn[p], 1);
        }
        const std::size_t p = at(darts.order[begin + n]);
        darts.turn[p] = static_cast<int>(begin + n);
        Vec3d x = pieces.x(p);
        if (pieces.solid()) {
          if (pieces.measure(p) != measure) width = std::cbrt(measure = pieces.measure(p));
          for (int a = 0; a < 3; ++a) x[a] += width * (static_cast<double>(numbers[3 * n + at(a)]) * 0x1p-32 - 0.5);
        }
        darts.x[p] = x;
      }
    });
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
  void add(const Vec3d& x, double of_piece) {
    sum += x * of_piece;
    measure += of_piece;
  }
};

/// Whether the middle of pieces of a sheet or line is itself a point of their matter: inside of a flat part of a sheet.
bool is_place(const Matter& matter, const PieceList& pieces, const Gathered& g) {
  const MatterPiece& nearest = pieces.thin(g.nearest);
  const double off = std::abs(dot(g.middle() - nearest.x, g.normal));
  return nearest.dimension == 2 && g.flat && g.squared <= matter.piece_size * matter.piece_size &&
         off <= 1e-10 * matter.piece_size;
}

/// Finds the piece next to the middle of each owner that wants one: wanted(owner).
template <class Wanted>
void find_nearest(const PieceList& pieces, const OwnedPieces& owned, const Wanted& wanted, ThreadPool& pool,
                  std::vector<Gathered>& gathered) {
  std::vector<Vec3d> middle;
  middle.reserve(gathered.size());
  for (const Gathered& g : gathered) middle.push_back(g.middle());
  owned.for_each(pool, [&](std::size_t n, std::size_t own) {
    if (!wanted(own)) return;
    Gathered& g = gathered[own];
    const double squared = squared_norm(pieces.x(n) - middle[own]);
    if (squared >= g.squared * (1 - kTie)) return;
    g.squared = squared;
    g.nearest = n;
  });
}

void move_thin(const Matter& matter, const PieceList& pieces, const OwnedPieces& owned,
               std::vector<SamplePlace>& samples, ThreadPool& pool) {
  std::vector<Gathered> gathered(samples.size());
  owned.for_each(pool, [&](std::size_t n, std::size_t own) {
    Gathered& g = gathered[own];
    const Vec3d normal = pieces.thin(n).axes.column(2);
    if (!(g.measure > 0)) g.normal = normal;
    g.flat = g.flat && dot(normal, g.normal) > 1 - 1e-12;
    g.add(pieces.x(n), pieces.measure(n));
  });
  find_nearest(
      pieces, owned, [](std::size_t) { return true; }, pool, gathered);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Gathered& g = gathered[i];
    if (g.squared == INFINITY) continue;
    samples[i] = pieces.place(g.nearest);
    if (is_place(matter, pieces, g)) samples[i].x = g.middle();
  }
}

/// Few middles lie outside of the matter, in most bodies none: only these want their nearest piece.
void move_solid(const Matter& matter, const PieceList& pieces, const OwnedPieces& owned,
                std::vector<SamplePlace>& samples, ThreadPool& pool) {
  std::vector<Gathered> gathered(samples.size());
  owned.for_each(pool, [&](std::size_t n, std::size_t own) { gathered[own].add(pieces.x(n), pieces.measure(n)); });
  constexpr int kGrain = 256;
  std::vector<char> outside(samples.size());
  pool.for_ranges(static_cast<int>(samples.size()), kGrain, [&](int first, int last) {
    for (std::size_t i = at(first); i < at(last); ++i)
      outside[i] = gathered[i].measure > 0 && !inside(matter, gathered[i].middle()) ? 1 : 0;
  });
  if (std::find(outside.begin(), outside.end(), 1) != outside.end())
    find_nearest(
        pieces, owned, [&](std::size_t own) { return outside[own] != 0; }, pool, gathered);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Gathered& g = gathered[i];
    if (g.measure > 0) samples[i] = outside[i] != 0 ? pieces.place(g.nearest) : voxel_place(g.middle());
  }
}

}  // namespace

void move_to_middles(const Matter& matter, const PieceList& pieces, std::span<const int> owner,
                     std::vector<SamplePlace>& samples, ThreadPool& pool) {
  const OwnedPieces owned(owner, samples.size());
  if (pieces.solid())
    move_solid(matter, pieces, owned, samples, pool);
  else
    move_thin(matter, pieces, owned, samples, pool);
}

}  // namespace fascia
