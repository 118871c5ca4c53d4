#pragma once

#include "core/geometry/surface.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// The steps of closed_surface(), mesh_parts() and, in shells, shell_mesh(); for their files only.
namespace fascia::surface_parts {

/// A cell whose points are numbered in the welded, compact numbering.
struct Cell {
  CellType type = CellType::triangle;
  std::array<int, 8> nodes{};
  std::int64_t file_number = 0;
  int group = -1;
};

/// A triangle and the cell of the file that it came from.
struct Triangle {
  std::array<int, 3> nodes{};
  std::int64_t file_number = 0;
  int cell = -1;  ///< index of that cell, where it is known
};

/// Role of a surface's triangles: of a solid they are the boundary, of a sheet the matter.
enum class Surface { of_solid, of_sheet };

/// Cells that bound or fill a solid, or make up a sheet or lines, on welded points.
struct Solid {
  std::string file;
  std::vector<Vec3d> points;
  std::vector<std::int64_t> point_file_number;
  std::vector<Cell> cells;
  double diagonal = 0;  ///< of the box around the cells [m]
};

bool is_volume(CellType type);
bool is_surface(CellType type);
std::size_t count_cells(const Mesh& mesh, bool (*wanted)(CellType));

/// @throws InputError  a coordinate that is NaN, infinite or above 1e60 m
void check_points(const Mesh& mesh);

/// Adds a message where the mesh has points that no cell uses.
void report_unused(const Mesh& mesh, std::vector<std::string>& messages);

/// The wanted cells on the points that they use, welded within 1e-9 of the diagonal.
/// @throws InputError  all points coincide
Solid make_solid(const Mesh& mesh, bool (*wanted)(CellType), std::vector<std::string>& messages);

/// A solid on the points of another, with other cells.
Solid with_cells(const Solid& solid, std::vector<Cell> cells);

/// "FILE: " + message
[[noreturn]] void fail(const Solid& solid, const std::string& message);

/// The cells' faces that no other cell has, outward. Turns the solid over where all cells are inverted.
/// Copies of cells are left out, with a message. Triangles know their cells.
/// @throws InputError  flat cells, a mixture of orientations, overlapping cells
std::vector<Triangle> boundary_of_cells(const Solid& solid, std::vector<std::string>& messages);

/// For each cell the first that has the same nodes in any order; itself where none before it has them.
std::vector<int> first_copies(const std::vector<Cell>& cells);

/// Triangles of a surface mesh, without_repeats(). Quadrilaterals are split at the node of the lowest index, or across
/// it where the surface would fold back on itself there: a concave one has one diagonal inside.
/// @throws InputError  flat triangles
std::vector<Triangle> triangles_of_cells(const Solid& solid, Surface surface, std::vector<std::string>& messages);

/// Leaves out triangles that have the nodes of others, with a message. Where the boundary of a solid would branch, but
/// closes without both of two that lie back to back, both go; where it closes only with a triangle twice, because it
/// lies on itself, both stay.
std::vector<Triangle> without_repeats(const Solid& solid, Surface surface, std::vector<Triangle> triangles,
                                      std::vector<std::string>& messages);

/// The surface cells that are no face of a volume cell. A quadrilateral is one in whole or as two triangles, and a
/// triangle is one as half of a quadrilateral too.
std::vector<Cell> cells_off_volumes(const Solid& solid);

/// An edge of more than two triangles must have as many in one direction as in the other: there the surface touches
/// itself, which a message says.
/// @throws InputError  open, branching or inconsistently oriented edges
void check_closed(const Solid& solid, const std::vector<Triangle>& triangles, std::vector<std::string>& messages);

/// Turns a surface outward: every component outward, or inward where it bounds a cavity.
/// @throws InputError  some components the right way, some not; several that overlap by much
void orient_outward(const Solid& solid, std::vector<Triangle>& triangles, std::vector<std::string>& messages);

/// Turns those of closed components inward that lie inside of an odd number of others: they bound cavities.
/// @param triangles  of components that face outward
/// @throws InputError  several components that overlap by much, where that is refused
void turn_cavities(const Solid& solid, OfOverlap overlap, std::vector<Triangle>& triangles,
                   std::vector<std::string>& messages);

/// Makes neighbours of a sheet agree, by as few turns as possible in each part that hangs together; then closed parts
/// face outward.
/// @throws InputError  a part with one side only
void orient_sheet(const Solid& sheet, std::vector<Triangle>& triangles, std::vector<std::string>& messages);

/// Volume by the divergence theorem, about the mean of the points [m³].
double enclosed_volume(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles);

/// The triangles on their own points, in the order of the solid's.
TriangleMesh compact(const Solid& solid, const std::vector<Triangle>& triangles);

/// A closed outward surface with its volume, without messages.
/// @throws InputError  a volume below 1e-12 of the diagonal cubed
ClosedSurface enclose(const Solid& solid, const std::vector<Triangle>& triangles);

}  // namespace fascia::surface_parts
