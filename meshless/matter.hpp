#pragma once

#include "core/base/aligned.hpp"
#include "core/base/thread_pool.hpp"
#include "core/geometry/mesh.hpp"
#include "core/math/mat3.hpp"
#include "meshless/domain.hpp"

#include <array>
#include <functional>
#include <vector>

namespace fascia {

/// A small piece of a sheet or line, or a place on a boundary without volume of its own.
struct MatterPiece {
  Vec3d x{};           ///< rest position [m]; of a sheet or line: on its middle
  double volume = 0;   ///< [m³]; 0 on corners and on the faces of a solid
  double measure = 0;  ///< length or area of the piece in its feature [m, m²]; 0 on corners
  int dimension = 3;   ///< of the matter here: 3 solid, 2 sheet, 1 line
  int feature = 2;     ///< dimension of the finest feature it lies on: 0 corner, 1 line, 2 face or inside of a sheet
  Mat3d axes = Mat3d::identity();  ///< columns: tangents first, then normals; of a solid the identity
  double extent = 0;               ///< thickness of a sheet, radius of a line [m]
};

/// A polyline from corner to corner, or a closed one without any: an edge of a solid or of a sheet, or a line.
struct FeatureChain {
  std::vector<Vec3d> points;   ///< [m]; of a closed chain the last is the first
  std::vector<Mat3d> axes;     ///< of the matter along each segment
  std::vector<double> extent;  ///< of the matter along each segment [m]
  int dimension = 3;           ///< of the matter: 1 where the chain itself is matter
  bool closed = false;
};

/// Pieces of the insides of solids, by the million: a place and a volume each.
struct VoxelPieces {
  AlignedVector<Vec3d> x;        ///< rest positions [m]
  AlignedVector<double> volume;  ///< [m³]

  std::size_t size() const { return x.size(); }
};

/// Matter of any dimension, and of several, as a cloud of pieces.
struct Matter {
  VoxelPieces voxels;  ///< of a solid, whole ones first
  std::size_t whole_voxels = 0;
  Vec3d voxel_edges{};              ///< [m]
  VoxelPieces surface_parts;        ///< eighths of the voxels that are not whole; for points only
  std::vector<MatterPiece> pieces;  ///< of sheets and lines; of solids corners and faces
  std::array<double, 4> measure{};  ///< by dimension: length, area and volume of what has a volume [m, m², m³]
  std::vector<FeatureChain> chains;
  std::vector<std::function<bool(const Vec3d&)>> solids;  ///< whether a point lies inside, one a solid
  double volume = 0;                                      ///< sum over the pieces [m³]
  double piece_size = 0;                                  ///< the widest asked for [m]
};

/// A surface with a thickness. Triangles that meet share points; it may be open, curved, branched.
struct SheetPart {
  TriangleMesh surface;
  std::vector<double> thickness;  ///< one a triangle [m]
};

/// Segments with a round section. Those that meet share points.
struct LinePart {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 2>> segments;
  double radius = 0;  ///< [m]
};

/// Tells what pieces of a solid are for: to place frames, on its faces, edges and corners too, or to place points and
/// to tell what matter belongs to each of them.
enum class PieceUse { frames, points };

/// Cuts the solid of a matter into voxels, those at its surface by their fraction inside; their volumes add up to the
/// domain's. For frames pieces on faces, corners and sharp edges (more than 40° between the normals) come from its
/// surface.
///
/// @param piece_size  width of the pieces [m]; about a third of the spacing of the samples wanted
/// @throws InputError  a size that is not positive, above 5·10⁷ pieces, a domain in which no piece falls
void add_solid(Matter& matter, const SolidDomain& domain, double piece_size, PieceUse use, ThreadPool& pool);

/// Cuts a sheet's triangles; volumes are area × thickness. Normals vary smoothly except across sharp edges.
/// Edges are open, sharp or branched ones.
void add_sheet(Matter& matter, const SheetPart& sheet, double piece_size);

/// Cuts lines; volumes are length × πr². Ends, junctions and bends above 40° are corners.
void add_line(Matter& matter, const LinePart& line, double piece_size);

}  // namespace fascia
