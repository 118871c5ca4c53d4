#pragma once

#include "app/scene/scene.hpp"
#include "meshless/cloud_build.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// What a body fills: scaled, with the placement that its frames and points still take.
/// @throws FileError, InputError  a mesh that cannot be used
MatterParts make_domain(const Body& body, std::vector<std::string>& messages);

/// Thickness of a surface body at a rest position [m]. @throws SceneError  where none is given
double thickness_at(const Body& body, const Vec3d& X);

}  // namespace fascia::app
