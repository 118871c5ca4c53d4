#pragma once

namespace fascia {

/// Treatment of the mid-side nodes of quadratic cells by readers.
enum class MidNodes {
  drop,  ///< every cell becomes linear; nodes that only lie between corners are left out
  keep   ///< quadratic lines, triangles, quadrilaterals, tetrahedra and hexahedra keep one node an edge (CellBlock)
};

}  // namespace fascia
