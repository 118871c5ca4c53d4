#pragma once

#include "core/base/aligned.hpp"
#include "core/base/thread_pool.hpp"
#include "meshless/scattered/point_grid.hpp"
#include "meshless/scattered/raw_array.hpp"
#include "meshless/scattered/scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <utility>
#include <vector>

/// Steps shared by the sampling of frames and of integration points.
namespace fascia {

SamplePlace place_of(const MatterPiece& piece);
/// A place in a solid.
inline SamplePlace voxel_place(const Vec3d& x) { return {x, 3, 3, Mat3d::identity(), 0}; }

/// Whether two places can share matter: of one dimension; normals of sheets, tangents of lines within 60°.
template <class A, class B>
bool alike(const A& a, const B& b) {
  if (a.dimension != b.dimension) return false;
  if (a.dimension == 3) return true;
  constexpr double least = 0.5 - kTie;
  if (a.dimension == 2) return dot(a.axes.column(2), b.axes.column(2)) >= least;
  return std::abs(dot(a.axes.column(0), b.axes.column(0))) >= least;
}

/// To the nearest whole number, halves upward whatever their last digits are.
inline double rounded(double positive) { return std::round(positive * (1 + kTie)); }

/// Whether a point lies in some solid.
bool inside(const Matter& matter, const Vec3d& x);

/// The pieces that `take` accepts.
template <class Take>
std::vector<int> select_pieces(const Matter& matter, Take&& take) {
  std::vector<int> chosen;
  for (std::size_t p = 0; p < matter.pieces.size(); ++p)
    if (take(matter.pieces[p])) chosen.push_back(static_cast<int>(p));
  return chosen;
}

/// Pieces to sample, of one feature: the voxels of a matter, or some of its other pieces.
class PieceList {
 public:
  static PieceList of_solids(const Matter& matter) { return {matter, {}, true}; }
  static PieceList of_thin(const Matter& matter, std::vector<int> pieces) { return {matter, std::move(pieces), false}; }

  bool solid() const { return solid_; }
  std::size_t size() const { return solid_ ? matter_->voxels.size() : index_.size(); }
  const Vec3d& x(std::size_t n) const { return solid_ ? matter_->voxels.x[n] : thin(n).x; }
  const double& measure(std::size_t n) const { return solid_ ? matter_->voxels.volume[n] : thin(n).measure; }
  /// A piece of a sheet, a line or a boundary.
  const MatterPiece& thin(std::size_t n) const { return matter_->pieces[at(index_[n])]; }
  SamplePlace place(std::size_t n) const { return solid_ ? voxel_place(x(n)) : place_of(thin(n)); }

 private:
  PieceList(const Matter& matter, std::vector<int> index, bool solid)
      : matter_(&matter), index_(std::move(index)), solid_(solid) {}

  const Matter* matter_;
  std::vector<int> index_;  ///< into Matter::pieces
  bool solid_;
};

/// Places to try, one for each piece.
struct Darts {
  AlignedVector<Vec3d> x;  ///< by piece
  RawArray<int> order;     ///< pieces, as their darts are thrown
  RawArray<int> turn;      ///< of each piece in that order

  std::size_t size() const { return order.size(); }
};

/// The pieces in random order; inside of solids each dart at a random place of its voxel, which leaves no trace of the
/// voxels in the distances.
Darts random_darts(const PieceList& pieces, std::mt19937& random, ThreadPool& pool);

/// Tries darts in turn, first as they are, then, where that is outside of the solid, at their pieces.
///
/// Whether a dart meets a sample that is there already is asked by all threads, for many darts at once, in the order of
/// their pieces: near darts often meet the same sample. What is left is tried in turn.
/// @param grid     of the samples so far, by their numbers; `add` puts them there
/// @param radius   the largest distance at which samples may meet, below a cell of the grid by kTie [m]
/// @param meets    whether a dart of a piece meets a sample: meets(piece of the list, sample, squared distance); all
///                 threads ask, and it does not throw
/// @param add      takes a place, and tells whether more are wanted
/// @returns        how many darts were thrown
template <class Meets, class Add>
std::size_t throw_darts(const Matter& matter, const PieceList& pieces, const Darts& darts, ThreadPool& pool,
                        const PointGrid& grid, double radius, const Meets& meets, Add&& add) {
  constexpr std::size_t kFirst = 2048;
  constexpr int kGrain = 4096;
  constexpr std::size_t kFew = 32;  // all pieces are looked through where at least one in so many has its turn
  // A sample that a dart meets: `last`, or another; −1: none.
  const auto met = [&](std::size_t piece, const Vec3d& x, int last) {
    if (last >= 0 && grid.is_within(last, x, radius) && meets(piece, last, grid.squared_distance(last, x))) return last;
    int found = -1;
    grid.any_within(x, radius, [&](int i, double squared) {
      if (meets(piece, i, squared)) found = i;
      return found >= 0;
    });
    return found;
  };
  std::vector<char> free;  // by turn
  for (std::size_t begin = 0, end = 0; begin < darts.size(); begin = end) {
    end = std::min(darts.size(), std::max(kFirst, 2 * begin));  // samples grow slower than darts are thrown
    free.assign(end - begin, 0);
    const auto ask = [&](std::size_t piece, std::size_t turn, int& last) {
      const int sample = met(piece, darts.x[piece], last);
      if (sample >= 0)
        last = sample;
      else
        free[turn - begin] = 1;
    };
    if (kFew * (end - begin) >= darts.size()) {
      pool.for_ranges(static_cast<int>(darts.size()), kGrain, [&](int first, int after) {
        int last = -1;
        for (std::size_t piece = at(first); piece < at(after); ++piece)
          if (const std::size_t turn = at(darts.turn[piece]); turn >= begin && turn < end) ask(piece, turn, last);
      });
    } else {
      pool.for_ranges(static_cast<int>(end - begin), kGrain, [&](int first, int after) {
        int last = -1;
        for (std::size_t turn = begin + at(first); turn < begin + at(after); ++turn)
          ask(at(darts.order[turn]), turn, last);
      });
    }
    std::vector<int> left;
    for (std::size_t turn = begin; turn < end; ++turn)
      if (free[turn - begin] != 0) left.push_back(darts.order[turn]);
    constexpr std::size_t kAhead = 16;
    for (std::size_t n = 0; n < left.size(); ++n) {
      if (n + kAhead < left.size()) __builtin_prefetch(&darts.x[at(left[n + kAhead])]);
      if (n + kAhead / 2 < left.size()) grid.prefetch(darts.x[at(left[n + kAhead / 2])]);
      const std::size_t piece = at(left[n]);
      const Vec3d& x = darts.x[piece];
      if (met(piece, x, -1) >= 0) continue;
      SamplePlace place = pieces.place(piece);
      if (inside(matter, x))
        place.x = x;
      else if (place.x != x && met(piece, place.x, -1) >= 0)
        continue;
      if (!add(place)) return at(darts.turn[piece]) + 1;
    }
  }
  return darts.size();
}

/// Into how many equal intervals a chain is divided: at least one, three of a closed one.
int interval_count(const FeatureChain& chain, double spacing);
double chain_length(const FeatureChain& chain);
/// The place at fractions of a chain's length, ascending in [0, 1].
std::vector<SamplePlace> places_on(const FeatureChain& chain, std::span<const double> fractions);

/// One of Lloyd's rounds: moves each owner of pieces to their centroid, or where that lies outside or off a curved
/// surface to the piece nearest to it.
///
/// @param owner  the sample of each piece, −1: none
void move_to_middles(const Matter& matter, const PieceList& pieces, std::span<const int> owner,
                     std::vector<SamplePlace>& samples, ThreadPool& pool);

/// The sample to which a piece of a sheet or a line belongs.
class OwnerSearch {
 public:
  OwnerSearch(const Matter& matter, std::span<const SamplePlace> samples);
  /// Of the piece's dimension, with like directions unless those are more than two spacings away; −1: none.
  int owner(const MatterPiece& piece) const { return owner(piece, piece.x); }
  /// The same for another point of the piece.
  int owner(const MatterPiece& piece, const Vec3d& x) const;

 private:
  struct OneDimension {
    double spacing = 0;
    std::vector<int> sample;  ///< by point of the grid
    PointGrid grid{1};
  };
  std::span<const SamplePlace> samples_;
  std::array<OneDimension, 3> dimension_;  ///< of lines and faces
};

/// About the distance between so many samples in solids [m].
double spacing_in_solids(const Matter& matter, std::size_t count);
std::vector<Vec3d> positions_of(std::span<const SamplePlace> samples);

/// Frames of a body at any spacing, from the same darts.
class FrameSampler {
 public:
  /// @param occupied  as of poisson_disk()
  FrameSampler(const Matter& matter, int seed, std::span<const Vec3d> occupied, ThreadPool& pool);
  /// @param relaxed  evens the distances out; the number stays
  std::vector<SamplePlace> places(double spacing, bool relaxed) const;

 private:
  const Matter& matter_;
  std::span<const Vec3d> occupied_;
  ThreadPool& pool_;
  PieceList faces_, insides_;
  Darts face_darts_, inside_darts_;
};

std::vector<SamplePlace> point_places(const Matter& matter, double spacing, int seed, ThreadPool& pool);
/// How many point_places aims at.
double expected_points(const Matter& matter, double spacing);

}  // namespace fascia
