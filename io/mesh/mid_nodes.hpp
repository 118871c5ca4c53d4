#pragma once

namespace fascia::io {

/// What readers do with the mid-side nodes of quadratic cells.
enum class MidNodes {
  drop,  ///< every cell becomes linear; nodes that only lie between corners are left out
  keep   ///< quadratic lines, triangles, quadrilaterals, tetrahedra and hexahedra keep one node an edge (CellBlock)
};

}  // namespace fascia::io
