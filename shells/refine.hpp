#pragma once

#include "shells/shell_mesh.hpp"

namespace fascia {

/// The mesh with each triangle cut into four by the middles of its edges. The nodes that there were keep their indices;
/// children take the number and the groups of their triangle; groups of lines receive the middles of their edges.
ShellMesh refined(const ShellMesh& mesh);

}  // namespace fascia
