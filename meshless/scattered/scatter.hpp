#pragma once

#include "meshless/matter.hpp"

#include <span>
#include <vector>

/// Random samples with even distances (Poisson disk, then Lloyd's relaxation), for frames and integration points.
///
/// The spacing is the mean one, (volume / count)^(1/3) inside a solid, (area / count)^(1/2) on a sheet, length / count
/// on a line: a regular grid of that spacing has about as many samples.
namespace fascia {

/// Where a sample stands and what the matter is like there.
struct SamplePlace {
  Vec3d x{};                       ///< [m]
  int feature = 3;                 ///< as of MatterPiece
  int dimension = 3;               ///< of the matter
  Mat3d axes = Mat3d::identity();  ///< columns: tangents first
  double extent = 0;               ///< thickness of a sheet, radius of a line [m]
};

/// Places for samples; the same for the same seed, whatever the number of threads.
///
/// With features (frames): corners first, then edges and lines at even intervals, faces and sheets, insides. Samples of
/// lower features keep others off, whatever the matter's dimension; so two parts that touch share them.
/// Without (integration points): matter only, each point near the middle of its share; lines in equal intervals.
///
/// @param spacing   mean distance [m], well above the pieces' size
/// @param occupied  places that keep frames off as samples of lower features do [m]
/// @throws InputError  a spacing that is not positive, or matter without pieces
std::vector<SamplePlace> poisson_disk(const Matter& matter, double spacing, int seed, bool with_features,
                                      ThreadPool& pool, std::span<const Vec3d> occupied = {});

/// The spacing at which poisson_disk places about `count` samples.
///
/// @throws InputError  a count that is not positive
double spacing_for_count(const Matter& matter, int count, int seed, bool with_features, ThreadPool& pool,
                         std::span<const Vec3d> occupied = {});

/// Positions that a user gave, with the dimension and axes of the matter nearest to each.
std::vector<SamplePlace> places_at(const Matter& matter, std::span<const Vec3d> positions);

/// What belongs to a sample.
struct Share {
  Vec3d centroid{};   ///< [m]; of an empty share the sample itself
  double volume = 0;  ///< [m³]
};

/// The matter nearest to each sample (Voronoi cells). Volumes add up to the matter's. Shares hold matter of one
/// dimension, the sample's; opposite walls of a sheet, normals more than 60° apart, stay apart where both have samples.
/// A sample to which nothing is nearest has volume 0.
///
/// @throws InputError  matter of a dimension that no sample has
std::vector<Share> voronoi_shares(const Matter& matter, std::span<const SamplePlace> samples, ThreadPool& pool);

}  // namespace fascia
