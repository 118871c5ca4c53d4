#pragma once

#include "assembly/specification/scene.hpp"
#include "core/geometry/mesh.hpp"

#include <string>
#include <vector>

namespace fascia {

/// The surface of a domain that a rigid body or a surface carries, placed in the world.
struct CarriedSurface {
  TriangleMesh mesh;
  bool closed = false;  ///< and outward
  std::vector<std::string> messages;
};

/// Solids give their skin; files their triangles, or the boundary of their volume cells. Closed parts of a rigid body's
/// surface that lie inside of others bound cavities.
/// @throws InputError, FileError
CarriedSurface carried_surface(const Body& body);

}  // namespace fascia
