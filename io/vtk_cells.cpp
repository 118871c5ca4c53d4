#include "io/vtk_cells.hpp"

#include "core/model/errors.hpp"
#include "io/mesh_edit.hpp"

#include <vtkCell.h>
#include <vtkCellType.h>
#include <vtkDataSet.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace fascia::io {
namespace {

/// A kind of VTK cell: the corners' places in VTK's list of nodes, and the least number of its nodes.
struct VtkKind {
  CellType type = CellType::vertex;
  std::array<int, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
  int least_nodes = 1;
  bool corners_only = true;  ///< it has no nodes between its corners
};

constexpr std::array<int, 8> usual{0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::array<int, 8> pixel_order{0, 1, 3, 2, 4, 5, 7, 6};  // of voxels, too
constexpr std::array<int, 8> wedge_order{0, 2, 1, 3, 5, 4, 6, 7};  // VTK's first triangle faces outward

constexpr VtkKind linear(CellType type, const std::array<int, 8>& order = usual) {
  return {type, order, node_count(type), true};
}
constexpr VtkKind curved(CellType type, const std::array<int, 8>& order = usual) {
  return {type, order, node_count(type), false};
}

/// False for a kind that is not supported; strips, polylines and polygons are dealt with elsewhere.
bool find_kind(int vtk_type, VtkKind& kind) {
  using enum CellType;
  switch (vtk_type) {
    case VTK_VERTEX:
      kind = linear(vertex);
      return true;
    case VTK_LINE:
      kind = linear(line);
      return true;
    case VTK_TRIANGLE:
      kind = linear(triangle);
      return true;
    case VTK_QUAD:
      kind = linear(quadrilateral);
      return true;
    case VTK_PIXEL:
      kind = linear(quadrilateral, pixel_order);
      return true;
    case VTK_TETRA:
      kind = linear(tetrahedron);
      return true;
    case VTK_HEXAHEDRON:
      kind = linear(hexahedron);
      return true;
    case VTK_VOXEL:
      kind = linear(hexahedron, pixel_order);
      return true;
    case VTK_WEDGE:
      kind = linear(wedge, wedge_order);
      return true;
    case VTK_PYRAMID:
      kind = linear(pyramid);
      return true;
    case VTK_QUADRATIC_EDGE:
    case VTK_CUBIC_LINE:
    case VTK_LAGRANGE_CURVE:
      kind = curved(line);
      return true;
    case VTK_QUADRATIC_TRIANGLE:
    case VTK_BIQUADRATIC_TRIANGLE:
    case VTK_LAGRANGE_TRIANGLE:
      kind = curved(triangle);
      return true;
    case VTK_QUADRATIC_QUAD:
    case VTK_BIQUADRATIC_QUAD:
    case VTK_QUADRATIC_LINEAR_QUAD:
    case VTK_LAGRANGE_QUADRILATERAL:
      kind = curved(quadrilateral);
      return true;
    case VTK_QUADRATIC_TETRA:
    case VTK_LAGRANGE_TETRAHEDRON:
      kind = curved(tetrahedron);
      return true;
    case VTK_QUADRATIC_HEXAHEDRON:
    case VTK_TRIQUADRATIC_HEXAHEDRON:
    case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
    case VTK_LAGRANGE_HEXAHEDRON:
      kind = curved(hexahedron);
      return true;
    case VTK_QUADRATIC_WEDGE:
    case VTK_QUADRATIC_LINEAR_WEDGE:
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
      kind = curved(wedge, wedge_order);
      return true;
    case VTK_QUADRATIC_PYRAMID:
      kind = curved(pyramid);
      return true;
    default:
      return false;
  }
}

class Converter {
 public:
  Converter(vtkDataSet& data, const std::string& name, int first_cell, int first_point)
      : data_(data), first_cell_(first_cell), first_point_(first_point) {
    mesh_.file = name;
  }

  Mesh convert() {
    if (data_.GetNumberOfCells() == 0)
      throw InputError(mesh_.file + ": the mesh has no cells; give a closed surface or a volume mesh");
    if (data_.GetNumberOfPoints() > std::numeric_limits<int>::max())
      throw InputError(mesh_.file + ": the mesh has more than 2147483647 points");
    read_points();
    for (vtkIdType c = 0; c < data_.GetNumberOfCells(); ++c) read_cell(c);
    drop_points_between();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(vtkIdType cell, const std::string& message) const {
    throw InputError(mesh_.file + ": cell " + std::to_string(cell + first_cell_) + " " + message);
  }

  void read_points() {
    const vtkIdType count = data_.GetNumberOfPoints();
    mesh_.points.resize(static_cast<std::size_t>(count));
    for (vtkIdType p = 0; p < count; ++p) {
      const auto i = static_cast<std::size_t>(p);
      mesh_.point_file_number.push_back(p + first_point_);
      data_.GetPoint(p, mesh_.points[i].v);
      for (const double x : mesh_.points[i].v)
        if (!std::isfinite(x))
          throw InputError(mesh_.file + ": node " + std::to_string(p + first_point_) +
                           " has a coordinate that is not finite; must be a finite number");
    }
    corner_.assign(mesh_.points.size(), false);
    between_.assign(mesh_.points.size(), false);
  }

  void read_cell(vtkIdType c) {
    data_.GetCellPoints(c, ids_);
    const vtkIdType size = ids_->GetNumberOfIds();
    for (vtkIdType n = 0; n < size; ++n)
      if (ids_->GetId(n) < 0 || ids_->GetId(n) >= data_.GetNumberOfPoints())
        fail(c, "uses node " + std::to_string(ids_->GetId(n) + first_point_) + ", but the mesh has " +
                    std::to_string(data_.GetNumberOfPoints()) + " nodes; add the node or remove the cell");
    const int type = data_.GetCellType(c);
    if (type == VTK_POLY_VERTEX || type == VTK_POLY_LINE) {
      read_chain(c, type == VTK_POLY_VERTEX ? 1 : 2);
    } else if (type == VTK_TRIANGLE_STRIP || type == VTK_POLYGON) {
      read_triangles(c, size);
    } else {
      VtkKind kind;
      if (!find_kind(type, kind))
        fail(c, "is of VTK's type " + std::to_string(type) + ", which is not supported; give triangles, " +
                    "quadrilaterals, tetrahedra, hexahedra, wedges or pyramids");
      if (size < kind.least_nodes || (kind.corners_only && size != kind.least_nodes))
        fail(c, "has " + std::to_string(size) + " nodes; must have " + std::to_string(kind.least_nodes));
      add(kind, c);
      for (vtkIdType n = kind.least_nodes; n < size; ++n) between_[static_cast<std::size_t>(ids_->GetId(n))] = true;
    }
  }

  void add(const VtkKind& kind, vtkIdType cell) {
    std::array<int, 8> nodes{};
    const auto size = static_cast<std::size_t>(node_count(kind.type));
    for (std::size_t n = 0; n < size; ++n) nodes[n] = static_cast<int>(ids_->GetId(kind.order[n]));
    append(kind.type, std::span(nodes).first(size), cell);
  }

  void append(CellType type, std::span<const int> nodes, vtkIdType cell) {
    CellBlock* block = nullptr;
    for (CellBlock& b : mesh_.blocks)
      if (b.type == type) block = &b;
    if (!block) block = &mesh_.blocks.emplace_back(CellBlock{type, {}, {}, {}});
    for (const int node : nodes) {
      block->nodes.push_back(node);
      corner_[static_cast<std::size_t>(node)] = true;
    }
    block->group.push_back(-1);
    block->file_number.push_back(cell + first_cell_);
  }

  /// Several vertices (length 1) or the lines of a polyline (length 2).
  void read_chain(vtkIdType cell, vtkIdType length) {
    for (vtkIdType n = 0; n + length <= ids_->GetNumberOfIds(); ++n) {
      const std::array<int, 2> nodes{static_cast<int>(ids_->GetId(n)), static_cast<int>(ids_->GetId(n + length - 1))};
      append(length == 1 ? CellType::vertex : CellType::line, std::span(nodes).first(static_cast<std::size_t>(length)),
             cell);
    }
  }

  void read_triangles(vtkIdType cell, vtkIdType size) {
    if (size < 3) fail(cell, "has " + std::to_string(size) + " nodes; must have at least 3");
    const bool done = data_.GetCell(cell)->Triangulate(0, ids_, points_) != 0;
    if (!done || ids_->GetNumberOfIds() == 0 || ids_->GetNumberOfIds() % 3 != 0)
      fail(cell, "is a polygon that crosses itself or is flat; give triangles");
    for (vtkIdType n = 0; n < ids_->GetNumberOfIds(); n += 3) {
      const std::array<int, 3> nodes{static_cast<int>(ids_->GetId(n)), static_cast<int>(ids_->GetId(n + 1)),
                                     static_cast<int>(ids_->GetId(n + 2))};
      append(CellType::triangle, nodes, cell);
    }
  }

  void drop_points_between() {
    std::vector<bool> keep(corner_.size());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = corner_[i] || !between_[i];
    keep_points(mesh_, keep);
  }

  vtkDataSet& data_;
  int first_cell_, first_point_;
  Mesh mesh_;
  vtkNew<vtkIdList> ids_;
  vtkNew<vtkPoints> points_;
  std::vector<bool> corner_, between_;  ///< uses of each point
};

}  // namespace

Mesh mesh_of_vtk(vtkDataSet& data, const std::string& name, int first_cell, int first_point) {
  return Converter(data, name, first_cell, first_point).convert();
}

}  // namespace fascia::io
