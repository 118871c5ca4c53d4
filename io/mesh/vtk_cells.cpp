#include "io/mesh/vtk_cells.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "io/mesh/mesh_edit.hpp"
#include "io/mesh/vtk_groups.hpp"
#include "io/mesh/vtk_kinds.hpp"

#include <vtkCell.h>
#include <vtkCellType.h>
#include <vtkDataSet.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

namespace fascia::io {
namespace {

class Converter {
 public:
  Converter(vtkDataSet& data, const std::string& name, int first_cell, int first_point, MidNodes mid_nodes)
      : data_(data), first_cell_(first_cell), first_point_(first_point), mid_nodes_(mid_nodes) {
    mesh_.file = name;
  }

  Mesh convert() {
    if (data_.GetNumberOfCells() == 0)
      throw InputError(mesh_.file + ": the mesh has no cells; give a closed surface or a volume mesh");
    if (data_.GetNumberOfPoints() > std::numeric_limits<int>::max())
      throw InputError(mesh_.file + ": the mesh has more than 2147483647 points");
    read_points();
    groups_ = VtkGroups(data_, mesh_.file, first_cell_);
    for (vtkIdType c = 0; c < data_.GetNumberOfCells(); ++c) read_cell(c);
    drop_points_between();
    mesh_.groups = groups_.take();
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
    kept_.assign(mesh_.points.size(), false);
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
      const std::optional<VtkKind> kind = vtk_kind(type);
      if (!kind)
        fail(c, "is of VTK's type " + std::to_string(type) + ", which is not supported; give triangles, " +
                    "quadrilaterals, tetrahedra, hexahedra, wedges or pyramids");
      read_plain(*kind, c);
    }
  }

  /// A cell whose first nodes are its corners.
  void read_plain(const VtkKind& kind, vtkIdType cell) {
    using enum VtkKind::Between;
    const auto size = static_cast<int>(ids_->GetNumberOfIds());
    const bool keep = mid_nodes_ == MidNodes::keep;
    const bool exact = kind.between == none || (kind.between == mid_sides && keep);
    const int least = exact ? kind.size : node_count(kind.type);
    if (size < least || (exact && size != least))
      fail(cell, "has " + std::to_string(size) + " nodes; must have " + std::to_string(least));

    const bool quadratic =
        keep && (kind.between == mid_sides || (kind.between == mid_sides_if_size && size == kind.size));
    std::array<int, 8> corners{};
    std::array<int, 12> mid_nodes{};
    const int n_corners = node_count(kind.type), n_mid_nodes = quadratic ? mid_node_count(kind.type) : 0;
    for (int n = 0; n < n_corners; ++n) corners[at(n)] = static_cast<int>(ids_->GetId(kind.order[at(n)]));
    for (int n = 0; n < n_mid_nodes; ++n) mid_nodes[at(n)] = static_cast<int>(ids_->GetId(n_corners + n));
    append(kind.type, std::span(corners).first(at(n_corners)), cell, std::span(mid_nodes).first(at(n_mid_nodes)));
    for (int n = n_corners + n_mid_nodes; n < size; ++n) between_[static_cast<std::size_t>(ids_->GetId(n))] = true;
  }

  CellBlock& block(CellType type, int mid_nodes_per_cell) {
    for (CellBlock& block : mesh_.blocks)
      if (block.type == type && block.mid_nodes_per_cell == mid_nodes_per_cell) return block;
    return mesh_.blocks.emplace_back(CellBlock{type, {}, {}, {}, mid_nodes_per_cell, {}});
  }

  void append(CellType type, std::span<const int> corners, vtkIdType cell, std::span<const int> mid_nodes = {}) {
    CellBlock& cells = block(type, static_cast<int>(mid_nodes.size()));
    cells.nodes.insert(cells.nodes.end(), corners.begin(), corners.end());
    cells.mid_nodes.insert(cells.mid_nodes.end(), mid_nodes.begin(), mid_nodes.end());
    for (const auto& nodes : {corners, mid_nodes})
      for (const int node : nodes) kept_[at(node)] = true;
    cells.group.push_back(groups_.of(cell, dimension_of(type)));
    cells.file_number.push_back(cell + first_cell_);
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
    std::vector<bool> keep(kept_.size());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = kept_[i] || !between_[i];
    keep_points(mesh_, keep);
  }

  vtkDataSet& data_;
  int first_cell_, first_point_;
  MidNodes mid_nodes_;
  Mesh mesh_;
  VtkGroups groups_;
  vtkNew<vtkIdList> ids_;
  vtkNew<vtkPoints> points_;
  std::vector<bool> kept_, between_;  ///< uses of each point: as a node of the mesh, as one that is dropped
};

}  // namespace

Mesh mesh_of_vtk(vtkDataSet& data, const std::string& name, int first_cell, int first_point, MidNodes mid_nodes) {
  return Converter(data, name, first_cell, first_point, mid_nodes).convert();
}

}  // namespace fascia::io
