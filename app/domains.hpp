#pragma once

#include "app/scene/scene.hpp"
#include "meshless/cloud_build.hpp"

#include <array>
#include <string>
#include <vector>

namespace fascia::app {

/// What a body fills: scaled, with the placement that its frames and points still take.
/// @throws FileError, InputError  a mesh that cannot be used
MatterParts make_domain(const Body& body, std::vector<std::string>& messages);

/// The same of matter that stands in the world already: the inside of a closed surface, a sheet, strands.
MatterParts solid_parts(TriangleMesh closed, double volume);
MatterParts sheet_parts(const Body& body, TriangleMesh surface);
MatterParts strand_parts(double radius, std::vector<Vec3d> points, std::vector<std::array<int, 2>> segments);

/// Thickness of a surface body at a rest position [m]. @throws SceneError  where none is given
double thickness_at(const Body& body, const Vec3d& X);

}  // namespace fascia::app
