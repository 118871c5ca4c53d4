#pragma once

#include "shells/shell_mesh.hpp"

#include <array>
#include <numbers>

/// Triangulations of simple surfaces. A cell is cut into two triangles. Edges are groups of nodes, faces that meet in
/// a crease groups of triangles.
namespace fascia {

/// Which diagonal cuts a cell, seen with its first direction to the right, its second up and the normal to the viewer.
enum class Diagonal {
  right,       ///< from the lower left corner to the upper right
  left,        ///< from the lower right corner to the upper left
  alternating  ///< right and left in turn, as on a chessboard
};

/// A range of angles [rad] about an axis, counter-clockwise seen against it. Angle 0 points along the coordinate axis
/// that follows the one nearest to the axis (x → y → z → x; of equally near ones the first), made normal to the axis:
/// along x about z, along y about x, along z about y.
struct Turn {
  double from = 0, to = 2 * std::numbers::pi;
  bool closed = true;  ///< a whole turn whose two ends are one; otherwise they have nodes of their own
};

/// Direction of angle 0 about an axis: of length one, normal to the axis.
Vec3d angle_origin(const Vec3d& axis);

/// The parallelogram origin + u edge_u + v edge_v. Nodes run u first; normal along edge_u × edge_v.
/// Groups: "u0", "u1", "v0", "v1", the edges where u or v is 0 or 1.
/// @param cells  along both edges
/// @throws InputError  edges that are parallel or vanish; cells below 1 or more than 10 million
ShellMesh rectangle(const Vec3d& origin, const Vec3d& edge_u, const Vec3d& edge_v, const std::array<int, 2>& cells,
                    Diagonal diagonal);

/// A flat ring or a sector of it. Nodes run outward first, then around; normal along `normal`.
/// Groups: "inner", "outer" and, where it is not closed, "start" and "end" of the turn.
/// @param cells  outward, around (at least 3 where closed)
/// @throws InputError  radii that are not 0 < inner < outer, no normal, no angle, wrong cells
ShellMesh annulus(const Vec3d& center, const Vec3d& normal, double inner, double outer, const Turn& turn,
                  const std::array<int, 2>& cells, Diagonal diagonal);

/// The skin of a cylinder or a sector of it. Nodes run around first, then along; normal outward.
/// Groups: the edges "from", "to" and, where it is not closed, "start" and "end"; with caps the faces "side",
/// "cap_from" and "cap_to".
/// @param caps   closes both ends by flat disks that share the nodes of the rims; needs a closed turn
/// @param cells  along, around (at least 3 where closed)
/// @throws InputError  no length or radius, no angle, wrong cells
ShellMesh cylinder_skin(const Vec3d& from, const Vec3d& to, double radius, const Turn& turn, bool caps,
                        const std::array<int, 2>& cells, Diagonal diagonal);

/// The skin of an ellipsoid: an octahedron whose edges are cut into around/4, on the surface; normal outward.
/// @param around  edges along each of the three ellipses in the planes of the axes, a multiple of 4
/// @throws InputError  radii that are not above 0, wrong cells
ShellMesh ellipsoid_skin(const Vec3d& center, const Vec3d& radii, int around);

}  // namespace fascia
