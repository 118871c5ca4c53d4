#pragma once

#include "assembly/specification/scene.hpp"
#include "meshless/cloud_build.hpp"

#include <array>
#include <string>
#include <vector>

namespace fascia {

/// @param size  of the body, with its transform [m]
/// @throws SceneError  one whose volume or moments of inertia leave the range of double numbers
void check_size(const Body& body, double size);

/// @param cells     of the mesh that a file holds
/// @param children  of a cell that is cut
/// @throws SceneError  a refinement that makes too many cells
void check_refinement(const FileDomain& file, std::size_t cells, int children);

/// The same body with the places of its domain near the origin and a translation that brings it back, if it is far
/// away: so it is sampled as one at the origin is, with all digits of its size. A mesh follows when it is read.
Body near_origin(const Body& body);

/// What a body fills: scaled, with the placement that its frames and points still take.
/// @throws FileError, InputError  a mesh that cannot be used
MatterParts make_domain(const Body& body, std::vector<std::string>& messages);

/// The same of matter that stands in the world already: the inside of a closed surface, a sheet, strands.
MatterParts solid_parts(TriangleMesh closed, double volume);
MatterParts sheet_parts(const Body& body, TriangleMesh surface);
MatterParts strand_parts(double radius, std::vector<Vec3d> points, std::vector<std::array<int, 2>> segments);

/// Thickness of a surface body at a rest position [m].
/// @param size  of the body [m]
/// @throws SceneError  where none is given
double thickness_at(const Body& body, const Vec3d& X, double size);

}  // namespace fascia
