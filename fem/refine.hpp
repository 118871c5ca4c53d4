#pragma once

#include "fem/element_mesh.hpp"

namespace fascia {

/// The mesh with each element cut into eight of its kind: a hexahedron at the middles of its reference element, a
/// tetrahedron into four at its corners and four about the shortest diagonal of what is left. The children fill their
/// element exactly, also a curved quadratic one, of whose map they are parts; neighbours match. The nodes that there
/// were keep their indices. Children take the number and the groups of their element; groups of surfaces and lines
/// receive what lies on their cells.
ElementMesh refined(const ElementMesh& mesh);

}  // namespace fascia
