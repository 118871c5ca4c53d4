#pragma once

#include "core/base/index.hpp"
#include "core/structure/point_set.hpp"

#include <compare>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace fascia {

/// Constants of a material, shared by many points.
struct TileMaterial {
  double lambda = 0, mu = 0;     ///< Lamé [Pa]
  double stabilization = 0;      ///< γ of drilling [Pa]
  double stiffness_damping = 0;  ///< β [s]
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 means what the compiler writes here
  friend auto operator<=>(const TileMaterial&, const TileMaterial&) = default;
};

/// Points of a meshless solid in the form that tiles compute with. Of frame i with rest position x_i an influence is
///   b = c w (X − x_i),   B = c ((X − x_i) gᵀ + w I),
/// with one blend factor c a point: 1 is the paper's rule, ½ the half blend. So w, g and X tell all.
struct TilePoints {
  std::vector<Vec3d> rest_position;  ///< of the frames, by node [m]

  std::vector<Vec3d> X;                 ///< [m]
  std::vector<double> volume;           ///< [m³]
  std::vector<double> blend;            ///< c [-]
  std::vector<int> material;            ///< index into `materials`
  std::vector<int> source;              ///< group × 8 + lane in the point set
  std::vector<std::size_t> begin{0};    ///< (points + 1): influences of a point
  std::vector<int> node;                ///< (influences)
  std::vector<double> w;                ///< (influences) [-]
  std::vector<Vec3d> g;                 ///< (influences) ∇w [1/m]
  std::vector<TileMaterial> materials;  ///< each once
  bool drilling = false;                ///< any point has it

  int node_count() const { return static_cast<int>(rest_position.size()); }
  int point_count() const { return static_cast<int>(X.size()); }
  int influence_count(int point) const { return static_cast<int>(begin[at(point) + 1] - begin[at(point)]); }
  int most_influences() const;
};

/// Points of a point set, or in one sentence why tiles cannot compute it.
struct TilePointsResult {
  TilePoints points;
  std::string refusal;  ///< empty: the points are complete
};

/// Why tiles cannot compute a set whatever its points are; empty where they may.
std::string not_for_tiles(const PointSet& set);

/// Reads the points of a set that holds nothing but St Venant-Kirchhoff solids on rigid frames (springs apart, which
/// act on single nodes). Positions and blend factors follow from the influences and are checked against all of them.
///
/// @param rest_position  of the nodes [m]
TilePointsResult tile_points(const PointSet& set, std::span<const Vec3d> rest_position);

}  // namespace fascia
