#include "meshless/scattered/scatter_parts.hpp"

#include <cmath>

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
  void add_darts(const std::vector<Dart>& darts, double least) {
    const double same = least * spacing_, lower = kLower * spacing_;
    const auto conflict = [&](const MatterPiece& piece, const Vec3d& x) {
      return grid_.any_within(x, std::max(same, lower), [&](int i, double squared) {
        const double r = samples_[at(i)].feature == piece.feature ? same : lower;
        return squared < r * r * (1 - kTie);
      });
    };
    throw_darts(matter_, darts, conflict, [&](const SamplePlace& place) { add(place); });
  }

  /// Evens out the samples of a feature among all of it and lower ones.
  void relax(const std::vector<int>& pieces, int feature) {
    for (int round = 0; round < kRounds; ++round) {
      std::vector<int> owner;
      owner.reserve(pieces.size());
      for (const int p : pieces) {
        const MatterPiece& piece = matter_.pieces[at(p)];
        const int i = grid_.nearest(piece.x, INFINITY, [](int) { return true; });
        const bool own = samples_[at(i)].feature == feature && alike(samples_[at(i)], piece);
        owner.push_back(own ? i : -1);
      }
      move_to_middles(matter_, pieces, owner, samples_);
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

  const Matter& matter_;
  double spacing_;
  PointGrid grid_;
  std::size_t occupied_;  ///< first samples, which are places of others
  std::vector<SamplePlace> samples_;
};

}  // namespace

FrameSampler::FrameSampler(const Matter& matter, int seed, std::span<const Vec3d> occupied)
    : matter_(matter), occupied_(occupied) {
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  for (const int feature : {2, 3}) {
    std::vector<int>& pieces = pieces_[at(feature - 2)];
    pieces = select_pieces(matter, [&](const MatterPiece& p) { return p.feature == feature; });
    darts_[at(feature - 2)] = random_darts(matter, pieces, random);
  }
}

std::vector<SamplePlace> FrameSampler::places(double spacing, bool relaxed) const {
  FrameSet frames(matter_, spacing, occupied_);
  frames.add_corners();
  frames.add_chains();
  frames.add_darts(darts_[0], kFace);
  frames.add_darts(darts_[1], kInside);
  if (relaxed) {
    frames.relax(pieces_[0], 2);
    frames.relax(pieces_[1], 3);
  }
  return frames.take();
}

}  // namespace fascia
