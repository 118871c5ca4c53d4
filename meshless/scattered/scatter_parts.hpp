#pragma once

#include "meshless/scattered/block_search.hpp"
#include "meshless/scattered/point_grid.hpp"
#include "meshless/scattered/scatter.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <vector>

/// Steps shared by the sampling of frames and of integration points.
namespace fascia {

SamplePlace place_of(const MatterPiece& piece);

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

/// Length, area and volume of the matter, by dimension [m, m², m³].
std::array<double, 4> measures(const Matter& matter);

/// The pieces that `take` accepts.
template <class Take>
std::vector<int> select_pieces(const Matter& matter, Take&& take) {
  std::vector<int> chosen;
  for (std::size_t p = 0; p < matter.pieces.size(); ++p)
    if (take(matter.pieces[p])) chosen.push_back(static_cast<int>(p));
  return chosen;
}

/// A place to try.
struct Dart {
  Vec3d x{};
  int piece = 0;
};

/// The pieces in random order; inside of solids each at a random place of its voxel, which leaves no trace of the
/// voxels in the distances.
std::vector<Dart> random_darts(const Matter& matter, std::vector<int> pieces, std::mt19937& random);

/// Tries darts in turn, first as they are, then, where that is outside of the solid, at their pieces.
///
/// @param conflict  whether a place is too near to others: conflict(place)
/// @param add       takes a place
template <class Conflict, class Add>
void throw_darts(const Matter& matter, std::span<const Dart> darts, Conflict&& conflict, Add&& add) {
  for (const Dart& dart : darts) {
    if (conflict(matter.pieces[at(dart.piece)], dart.x)) continue;
    SamplePlace place = place_of(matter.pieces[at(dart.piece)]);
    if (inside(matter, dart.x))
      place.x = dart.x;
    else if (place.x != dart.x && conflict(matter.pieces[at(dart.piece)], place.x))
      continue;
    add(place);
  }
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
void move_to_middles(const Matter& matter, std::span<const int> pieces, std::span<const int> owner,
                     std::vector<SamplePlace>& samples);

/// The sample to which a piece belongs.
class OwnerSearch {
 public:
  OwnerSearch(const Matter& matter, std::span<const SamplePlace> samples);
  /// Of the piece's dimension, with like directions unless those are more than two spacings away; −1: none.
  int owner(const MatterPiece& piece) { return owner(piece, piece.x); }
  /// The same for another point of the piece.
  int owner(const MatterPiece& piece, const Vec3d& x);

 private:
  struct OneDimension {
    double spacing = 0;
    std::vector<int> sample;  ///< by point of the grid
    PointGrid grid{1};
  };
  std::span<const SamplePlace> samples_;
  std::array<OneDimension, 3> dimension_;  ///< of lines and faces
  std::vector<int> solid_sample_;          ///< by point of the search
  std::vector<Vec3d> solid_place_;
  std::optional<BlockSearch> solid_;
};

/// Frames of a body at any spacing, from the same darts.
class FrameSampler {
 public:
  /// @param occupied  as of poisson_disk()
  FrameSampler(const Matter& matter, int seed, std::span<const Vec3d> occupied);
  /// @param relaxed  evens the distances out; the number stays
  std::vector<SamplePlace> places(double spacing, bool relaxed) const;

 private:
  const Matter& matter_;
  std::span<const Vec3d> occupied_;
  std::array<std::vector<int>, 2> pieces_;  ///< of faces, insides
  std::array<std::vector<Dart>, 2> darts_;
};

std::vector<SamplePlace> point_places(const Matter& matter, double spacing, int seed);
/// How many point_places aims at.
double expected_points(const Matter& matter, double spacing);

}  // namespace fascia
