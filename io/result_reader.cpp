#include "io/result_reader.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/mesh/text_numbers.hpp"
#include "io/vtk_errors.hpp"

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include <cmath>
#include <cstddef>
#include <limits>

namespace fascia::io {
namespace {

std::vector<double> numbers_of(vtkDataArray& array) {
  const int components = array.GetNumberOfComponents();
  std::vector<double> numbers;
  numbers.reserve(static_cast<std::size_t>(array.GetNumberOfValues()));
  for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i)
    for (int c = 0; c < components; ++c) numbers.push_back(array.GetComponent(i, c));
  return numbers;
}

void add_arrays(ResultArrays& arrays, vtkFieldData& data) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a)
    if (vtkDataArray* array = data.GetArray(a)) {
      const std::string name = array->GetName() != nullptr ? array->GetName() : "";
      std::vector<double>& values = arrays[name];  // of points, then of cells
      const std::vector<double> more = numbers_of(*array);
      values.insert(values.end(), more.begin(), more.end());
    }
}

std::string attribute(vtkXMLDataElement& element, const char* name) {
  const char* value = element.GetAttribute(name);
  return value == nullptr ? "" : value;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    parts.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// @throws InputError  where it is no .vtu
vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& vtu) {
  check_readable(vtu);
  const VtkErrors errors;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(vtu.c_str());
  reader->Update();
  vtkSmartPointer<vtkUnstructuredGrid> grid = reader->GetOutput();
  if (!errors.first().empty() || grid == nullptr || grid->GetPoints() == nullptr)
    throw InputError(fmt::format("{}: is no readable .vtu ({})", vtu.string(), errors.first()));
  return grid;
}

/// The block of volume cells that a cell of this VTK type joins: the last one where it fits, or a new one.
VisualCells& block_for(std::vector<VisualCells>& blocks, CellType type, bool quadratic) {
  if (blocks.empty() || blocks.back().type != type || blocks.back().quadratic != quadratic)
    blocks.push_back({type, quadratic, {}});
  return blocks.back();
}

/// @return false  for a kind that no result holds
bool add_cell(VisualMesh& mesh, int vtk_type, const std::vector<int>& n) {
  const auto add_volume = [&](CellType type, bool quadratic) {
    std::vector<int>& nodes = block_for(mesh.volumes, type, quadratic).nodes;
    nodes.insert(nodes.end(), n.begin(), n.end());
    return true;
  };
  if (vtk_type == VTK_TETRA && n.size() == 4) return add_volume(CellType::tetrahedron, false);
  if (vtk_type == VTK_QUADRATIC_TETRA && n.size() == 10) return add_volume(CellType::tetrahedron, true);
  if (vtk_type == VTK_HEXAHEDRON && n.size() == 8) return add_volume(CellType::hexahedron, false);
  if (vtk_type == VTK_QUADRATIC_HEXAHEDRON && n.size() == 20) return add_volume(CellType::hexahedron, true);
  if (vtk_type == VTK_TRIANGLE && n.size() == 3)
    mesh.triangles.push_back({n[0], n[1], n[2]});
  else if (vtk_type == VTK_LINE && n.size() == 2)
    mesh.lines.push_back({n[0], n[1]});
  else if (vtk_type == VTK_VERTEX && n.size() == 1)
    mesh.vertices.push_back(n[0]);
  else
    return false;
  return true;
}

}  // namespace

VisualMesh read_vtu(const std::filesystem::path& vtu) {
  const auto grid = read_grid(vtu);
  const auto fail = [&](const std::string& why) {
    throw InputError(fmt::format("{}: is damaged, or no result of this program: {}", vtu.string(), why));
  };
  VisualMesh mesh;
  const vtkIdType count = grid->GetNumberOfPoints();
  for (vtkIdType p = 0; p < count; ++p) grid->GetPoint(p, mesh.points.emplace_back().v);
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    grid->GetCellPoints(c, size, ids);
    std::vector<int> nodes;
    for (vtkIdType k = 0; k < size; ++k) {
      if (ids[k] < 0 || ids[k] >= count) fail(fmt::format("cell {} names a point that is not there", c));
      nodes.push_back(static_cast<int>(ids[k]));
    }
    if (!add_cell(mesh, grid->GetCellType(c), nodes)) fail(fmt::format("cell {} is of another kind", c));
  }
  vtkPointData& data = *grid->GetPointData();
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    vtkDataArray* array = data.GetArray(a);
    if (array == nullptr || array->GetName() == nullptr) continue;
    FieldArray& field = mesh.point_fields.emplace_back();
    field.name = array->GetName();
    field.components = array->GetNumberOfComponents();
    field.values = numbers_of(*array);
    if (field.components < 1 || array->GetNumberOfTuples() != count)
      fail(fmt::format("\"{}\" has not one value a point", field.name));
    for (const double value : field.values)
      if (!std::isfinite(value)) fail(fmt::format("\"{}\" holds a number that is not finite", field.name));
  }
  if (vtkDataArray* part = grid->GetCellData()->GetArray("part"))
    for (const double value : numbers_of(*part)) mesh.part.push_back(static_cast<int>(value));
  return mesh;
}

ResultArrays read_result_arrays(const std::filesystem::path& vtu) {
  const auto grid = read_grid(vtu);
  ResultArrays arrays{{"points", numbers_of(*grid->GetPoints()->GetData())}};
  add_arrays(arrays, *grid->GetPointData());
  add_arrays(arrays, *grid->GetCellData());
  return arrays;
}

std::vector<CollectionEntry> read_collection(const std::filesystem::path& pvd) {
  const VtkErrors errors;
  const std::string text = read_file(pvd);
  const vtkSmartPointer<vtkXMLDataElement> root =
      vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(text.c_str()));
  vtkXMLDataElement* list = root == nullptr ? nullptr : root->FindNestedElementWithName("Collection");
  if (list == nullptr) throw InputError(fmt::format("{}: is no .pvd of results", pvd.string()));
  std::vector<CollectionEntry> entries;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement& element = *list->GetNestedElement(i);
    const auto time = to_number(attribute(element, "timestep"));
    if (!time) throw InputError(fmt::format("{}: entry {} has no time", pvd.string(), i));
    entries.push_back({*time, attribute(element, "name"), attribute(element, "file")});
  }
  return entries;
}

NumberTable read_number_table(const std::filesystem::path& csv) {
  const std::string text = read_file(csv);
  NumberTable table;
  int line_number = 0;
  for (const std::string_view line : split(text, '\n')) {
    ++line_number;
    if (line.empty()) continue;
    const std::vector<std::string_view> cells = split(line, ',');
    if (table.columns.empty()) {
      table.columns.assign(cells.begin(), cells.end());
      continue;
    }
    std::vector<double>& row = table.rows.emplace_back();
    for (const std::string_view cell : cells) {
      const auto number = to_number(cell);
      if (!number && !cell.empty())
        throw InputError(fmt::format("{}:{}: \"{}\" is no number", csv.string(), line_number, cell));
      row.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (row.size() != table.columns.size())
      throw InputError(fmt::format("{}:{}: has {} cells where the head has {}", csv.string(), line_number, row.size(),
                                   table.columns.size()));
  }
  return table;
}

}  // namespace fascia::io
