#pragma once

#include "meshless/matter.hpp"

#include <span>

/// Steps shared by the cutting of solids, sheets and lines.
namespace fascia {

/// Above 40° an edge is sharp and a bend is a corner.
inline constexpr double kSharpCosine = 0.76604444311897801;

/// @throws InputError  a piece size that is not positive, or more pieces in all than memory should hold
void check_pieces(const Matter& matter, double piece_size, double more);

/// An edge of a surface at which samples stand.
struct SurfaceEdge {
  std::array<int, 2> vertices{};
  int triangle = 0;  ///< one that it belongs to
  Vec3d normal{};    ///< unit, mean of its triangles'
};

struct SurfaceFeatures {
  std::vector<Vec3d> triangle_normal;  ///< length twice the area [m²]; zero: a triangle without area
  std::vector<SurfaceEdge> edges;      ///< sharp, open or branched
  std::vector<char> smooth;            ///< one a point: normals around it may be averaged
};

SurfaceFeatures find_features(const TriangleMesh& surface);

/// A path along edges, by index; of a closed one the last vertex is the first.
struct EdgePath {
  std::vector<int> vertices, edges;
  bool closed = false;
};

struct EdgePaths {
  std::vector<int> corners;  ///< vertices: ends, junctions, bends above 40°; ascending
  std::vector<int> edge;     ///< of each corner: one of its edges
  std::vector<EdgePath> paths;
};

/// Joins edges to paths from corner to corner and to closed ones. Edges have length.
EdgePaths trace_paths(std::span<const Vec3d> points, std::span<const std::array<int, 2>> edges);

/// What the matter is like along an edge.
struct EdgeMatter {
  Mat3d axes = Mat3d::identity();
  double extent = 0;
};

/// Appends corners and chains of edges.
void add_edges(Matter& matter, std::span<const Vec3d> points, std::span<const std::array<int, 2>> edges,
               std::span<const EdgeMatter> edge_matter, int dimension);

/// A part of a triangle.
struct TrianglePart {
  Vec3d x{};  ///< centroid [m]
  Vec3d normal{};
  double area = 0;
};

/// Halves a triangle at its longest edge until none is longer than 1.2 × size; appends the parts.
///
/// @param normals  at the corners; interpolated
void cut_triangle(const std::array<Vec3d, 3>& corners, const std::array<Vec3d, 3>& normals, double area, double size,
                  std::vector<TrianglePart>& parts);

/// How many parts cut_triangle makes of a surface, at most [about].
double expected_parts(const TriangleMesh& surface, double size);

}  // namespace fascia
