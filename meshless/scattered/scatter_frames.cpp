#include "meshless/scattered/block_search.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <cmath>
#include <optional>

namespace fascia {
namespace {

// Least distances, over the mean spacing. A saturated random sample of least distance r has mean spacings of 1.109 r in
// a solid and 1.198 r on a face; the values allow for what the samples of lower features keep free.
constexpr double kInside = 1 / 1.1;
constexpr double kFace = 0.82;
constexpr double kLower = 0.77;  // between samples of different features
constexpr double kEdge = 0.4;    // between corners, and edges that come near one another
constexpr int kRounds = 3;       // of relaxation
constexpr int kOccupied = -1;    // a feature below all others
constexpr int kGrain = 4096;     // pieces

/// Frames placed so far.
class FrameSet {
 public:
  FrameSet(const Matter& matter, double spacing, std::span<const Vec3d> occupied)
      : matter_(matter), spacing_(spacing), grid_(spacing), occupied_(occupied.size()) {
    for (const Vec3d& x : occupied) {
      SamplePlace place;
      place.x = x;
      place.feature = kOccupied;
      add(place);
    }
  }

  void add_corners() {
    for (const MatterPiece& p : matter_.pieces)
      if (p.feature == 0 && !crowded(p.x)) add(place_of(p));
  }

  void add_chains() {
    for (const FeatureChain& chain : matter_.chains) {
      const int count = interval_count(chain, spacing_);
      std::vector<double> fractions;
      for (int k = chain.closed ? 0 : 1; k < count; ++k) fractions.push_back(static_cast<double>(k) / count);
      for (const SamplePlace& place : places_on(chain, fractions))
        if (!crowded(place.x)) add(place);
    }
  }

  /// Random places on pieces of a feature until no more fit.
  void add_darts(const PieceList& pieces, const Darts& darts, double least, ThreadPool& pool) {
    const double same = least * spacing_, lower = kLower * spacing_;
    const int feature = pieces.solid() ? 3 : 2;
    const auto meets = [&](std::size_t, int i, double squared) {
      const double r = samples_[at(i)].feature == feature ? same : lower;
      return squared < r * r * (1 - kTie);
    };
    throw_darts(matter_, pieces, darts, pool, grid_, std::max(same, lower), meets, [&](const SamplePlace& place) {
      add(place);
      return true;
    });
  }

  /// Evens out the samples of a feature among all of it and lower ones.
  void relax(const PieceList& pieces, ThreadPool& pool) {
    const int feature = pieces.solid() ? 3 : 2;
    std::optional<BlockSearch> in_solid;
    if (pieces.solid()) in_solid.emplace(matter_.voxels.x, spacing_, pool);
    RawArray<int> owner(pieces.size());
    for (int round = 0; round < kRounds; ++round) {
      if (in_solid)
        in_solid->nearest(positions_of(samples_), owner.span(), pool);
      else
        find_nearest_samples(pieces, owner.span(), pool);
      pool.for_ranges(static_cast<int>(pieces.size()), kGrain, [&](int first, int last) {
        for (std::size_t n = at(first); n < at(last); ++n) {
          const SamplePlace& sample = samples_[at(owner[n])];
          const bool own = sample.feature == feature && (pieces.solid() || alike(sample, pieces.thin(n)));
          if (!own) owner[n] = -1;
        }
      });
      move_to_middles(matter_, pieces, owner.span(), samples_, pool);
      grid_ = PointGrid(spacing_);
      for (const SamplePlace& s : samples_) grid_.insert(s.x);
    }
  }

  std::vector<SamplePlace> take() {
    samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(occupied_));
    return std::move(samples_);
  }

 private:
  bool crowded(const Vec3d& x) const {
    return grid_.any_within(x, kEdge * spacing_, [](int, double) { return true; });
  }
  void add(const SamplePlace& place) {
    samples_.push_back(place);
    grid_.insert(place.x);
  }
  void find_nearest_samples(const PieceList& pieces, std::span<int> nearest, ThreadPool& pool) const {
    pool.for_ranges(static_cast<int>(pieces.size()), kGrain, [&](int first, int last) {
      for (std::size_t n = at(first); n < at(last); ++n)
        nearest[n] = grid_.nearest(pieces.x(n), INFINITY, [](int) { return true; });
    });
  }

  const Matter& matter_;
  double spacing_;
  PointGrid grid_;
  std::size_t occupied_;  ///< first samples, which are places of others
  std::vector<SamplePlace> samples_;
};

}  // namespace

FrameSampler::FrameSampler(const Matter& matter, int seed, std::span<const Vec3d> occupied, ThreadPool& pool)
    : matter_(matter),
      occupied_(occupied),
      pool_(pool),
      faces_(PieceList::of_thin(matter, select_pieces(matter, [](const MatterPiece& p) { return p.feature == 2; }))),
      insides_(PieceList::of_solids(matter)) {
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  face_darts_ = random_darts(faces_, random, pool_);
  inside_darts_ = random_darts(insides_, random, pool_);
}

std::vector<SamplePlace> FrameSampler::places(double spacing, bool relaxed) const {
  FrameSet frames(matter_, spacing, occupied_);
  frames.add_corners();
  frames.add_chains();
  frames.add_darts(faces_, face_darts_, kFace, pool_);
  frames.add_darts(insides_, inside_darts_, kInside, pool_);
  if (relaxed) {
    frames.relax(faces_, pool_);
    frames.relax(insides_, pool_);
  }
  return frames.take();
}

}  // namespace fascia
