#pragma once

#include "shells/shell_mesh.hpp"

#include <vector>

/// For generate*.cpp only.
namespace fascia::shell_parts {

/// Closes a circle of nodes by a disk of rings about its centre, with as many rings and nodes on each as keep the edges
/// about as long as the rim's.
/// @param rim  nodes of the mesh, evenly around and counter-clockwise seen from outside
void add_cap(ShellMesh& mesh, const std::vector<int>& rim);

}  // namespace fascia::shell_parts
