#include "io/mesh/vtk_kinds.hpp"

#include <vtkCellType.h>

namespace fascia::io {
namespace {

using Between = VtkKind::Between;

constexpr std::array<int, 8> usual{0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::array<int, 8> pixel_order{0, 1, 3, 2, 4, 5, 7, 6};  // of voxels, too
constexpr std::array<int, 8> wedge_order{0, 2, 1, 3, 5, 4, 6, 7};  // VTK's first triangle faces outward

constexpr VtkKind linear(CellType type, const std::array<int, 8>& order = usual) {
  return {type, order, Between::none, node_count(type)};
}
constexpr VtkKind corners_of(CellType type, const std::array<int, 8>& order = usual) {
  return {type, order, Between::dropped, node_count(type)};
}
/// @param inner  number of nodes of faces and centre
constexpr VtkKind quadratic(CellType type, int inner = 0) {
  return {type, usual, Between::mid_sides, node_count(type) + mid_node_count(type) + inner};
}
/// Any order; the number of nodes tells the quadratic one.
constexpr VtkKind lagrange(CellType type, int inner = 0) {
  return {type, usual, Between::mid_sides_if_size, node_count(type) + mid_node_count(type) + inner};
}

}  // namespace

std::optional<VtkKind> vtk_kind(int vtk_type) {
  using enum CellType;
  switch (vtk_type) {
    case VTK_VERTEX:
      return linear(vertex);
    case VTK_LINE:
      return linear(line);
    case VTK_TRIANGLE:
      return linear(triangle);
    case VTK_QUAD:
      return linear(quadrilateral);
    case VTK_PIXEL:
      return linear(quadrilateral, pixel_order);
    case VTK_TETRA:
      return linear(tetrahedron);
    case VTK_HEXAHEDRON:
      return linear(hexahedron);
    case VTK_VOXEL:
      return linear(hexahedron, pixel_order);
    case VTK_WEDGE:
      return linear(wedge, wedge_order);
    case VTK_PYRAMID:
      return linear(pyramid);

    case VTK_QUADRATIC_EDGE:
      return quadratic(line);
    case VTK_QUADRATIC_TRIANGLE:
      return quadratic(triangle);
    case VTK_BIQUADRATIC_TRIANGLE:
      return quadratic(triangle, 1);
    case VTK_QUADRATIC_QUAD:
      return quadratic(quadrilateral);
    case VTK_BIQUADRATIC_QUAD:
      return quadratic(quadrilateral, 1);
    case VTK_QUADRATIC_TETRA:
      return quadratic(tetrahedron);
    case VTK_QUADRATIC_HEXAHEDRON:
      return quadratic(hexahedron);
    case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
      return quadratic(hexahedron, 4);
    case VTK_TRIQUADRATIC_HEXAHEDRON:
      return quadratic(hexahedron, 7);

    case VTK_LAGRANGE_CURVE:
      return lagrange(line);
    case VTK_LAGRANGE_TRIANGLE:
      return lagrange(triangle);
    case VTK_LAGRANGE_QUADRILATERAL:
      return lagrange(quadrilateral, 1);
    case VTK_LAGRANGE_TETRAHEDRON:
      return lagrange(tetrahedron);

    case VTK_CUBIC_LINE:
      return corners_of(line);
    case VTK_QUADRATIC_LINEAR_QUAD:
      return corners_of(quadrilateral);
    case VTK_LAGRANGE_HEXAHEDRON:
      return corners_of(hexahedron);
    case VTK_QUADRATIC_WEDGE:
    case VTK_QUADRATIC_LINEAR_WEDGE:
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
      return corners_of(wedge, wedge_order);
    case VTK_QUADRATIC_PYRAMID:
      return corners_of(pyramid);
    default:
      return std::nullopt;
  }
}

}  // namespace fascia::io
