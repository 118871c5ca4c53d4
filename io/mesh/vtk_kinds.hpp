#pragma once

#include "core/geometry/mesh.hpp"

#include <array>
#include <optional>

namespace fascia::io {

/// A kind of VTK cell: its corners' places in VTK's list of nodes, and what lies behind them.
struct VtkKind {
  /// What the nodes behind the corners are.
  enum class Between {
    none,
    dropped,           ///< nodes whose order is not used
    mid_sides,         ///< mid-side nodes in the order of CellBlock, then those of faces and centre, which are dropped
    mid_sides_if_size  ///< the same where there are `size` nodes; another order of the cell is dropped
  };

  CellType type = CellType::vertex;
  std::array<int, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
  Between between = Between::none;
  int size = 1;  ///< number of nodes; of kinds whose nodes between are dropped the least number
};

/// The kind of a VTK type; none where it is not supported. Strips, polylines and polygons are dealt with elsewhere.
std::optional<VtkKind> vtk_kind(int vtk_type);

}  // namespace fascia::io
