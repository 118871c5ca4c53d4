#include "io/picture/results.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/picture/outline.hpp"
#include "io/picture/surface.hpp"
#include "io/text_numbers.hpp"
#include "io/vtk_errors.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

namespace fascia::io {
namespace {

constexpr int frame_part = 1;

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& file) {
  check_readable(file);
  VtkErrors errors;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  if (!errors.first().empty() || reader->GetOutput()->GetNumberOfPoints() == 0)
    throw InputError(file.string() + ": is no readable .vtu result; give one that fascia wrote");
  return reader->GetOutput();
}

void add_names(std::string& names, vtkFieldData& data) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a)
    names += (names.empty() ? "" : ", ") + std::string(data.GetArrayName(a));
}

/// One value each: the array's own, or the magnitude of its components.
vtkSmartPointer<vtkDoubleArray> magnitudes(vtkDataArray& array) {
  auto values = vtkSmartPointer<vtkDoubleArray>::New();
  values->SetName(shown_array);
  const int components = array.GetNumberOfComponents();
  for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i) {
    double sum = 0;
    for (int c = 0; c < components; ++c) sum += array.GetComponent(i, c) * array.GetComponent(i, c);
    values->InsertNextValue(components == 1 ? array.GetComponent(i, 0) : std::sqrt(sum));
  }
  return values;
}

ShownValues shown_values(const std::filesystem::path& file, vtkUnstructuredGrid& grid, const std::string& field) {
  if (field.empty()) return {};
  if (vtkDataArray* array = grid.GetPointData()->GetArray(field.c_str())) return {magnitudes(*array), nullptr};
  if (vtkDataArray* array = grid.GetCellData()->GetArray(field.c_str())) return {nullptr, magnitudes(*array)};
  std::string names;
  add_names(names, *grid.GetPointData());
  add_names(names, *grid.GetCellData());
  throw InputError(file.string() + ": has no field \"" + field + "\"; it has " + (names.empty() ? "none" : names));
}

/// Cells of a result by what they are.
struct Cells {
  std::vector<vtkIdType> volumes, triangles, lines, frames;
};

Cells cells_of(vtkUnstructuredGrid& grid) {
  vtkDataArray* part = grid.GetCellData()->GetArray("part");
  Cells cells;
  for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
    switch (grid.GetCellType(c)) {
      case VTK_TETRA:
      case VTK_HEXAHEDRON:
      case VTK_QUADRATIC_TETRA:
      case VTK_QUADRATIC_HEXAHEDRON:
        cells.volumes.push_back(c);
        break;
      case VTK_TRIANGLE:
        cells.triangles.push_back(c);
        break;
      case VTK_LINE:
        cells.lines.push_back(c);
        break;
      case VTK_VERTEX:
        if (part && static_cast<int>(part->GetComponent(c, 0)) == frame_part) cells.frames.push_back(c);
        break;
      default:
        break;
    }
  }
  return cells;
}

/// The grid with its points where they are at rest; null where that is not known.
vtkSmartPointer<vtkUnstructuredGrid> at_rest(vtkUnstructuredGrid& grid) {
  vtkDataArray* positions = grid.GetPointData()->GetArray("rest_position");
  if (!positions || positions->GetNumberOfComponents() != 3) return nullptr;
  vtkNew<vtkPoints> points;
  points->SetData(positions);
  auto rest = vtkSmartPointer<vtkUnstructuredGrid>::New();
  rest->ShallowCopy(&grid);
  rest->SetPoints(points);
  return rest;
}

void add_rest(PictureBody& body, vtkUnstructuredGrid& grid, const Cells& cells) {
  body.now = grid.GetPoints();
  body.rest_surface = body.rest_lines = vtkSmartPointer<vtkPolyData>::New();
  const vtkSmartPointer<vtkUnstructuredGrid> rest = at_rest(grid);
  if (!rest) return;
  body.rest = rest->GetPoints();
  body.rest_surface = joined(extract(*rest, cells.triangles, {}), outer_faces(*rest, cells.volumes, {}));
  body.rest_lines = extract(*rest, cells.lines, {});
}

/// BODY_00012.vtu, with five digits or more.
void add_name(PictureBody& body, const std::filesystem::path& file) {
  body.name = file.stem().string();
  const std::size_t digits = body.name.find_last_not_of("0123456789") + 1;
  constexpr std::size_t fewest = 5;
  if (digits == 0 || body.name[digits - 1] != '_' || body.name.size() < digits + fewest) return;
  const auto number = to_integer(std::string_view(body.name).substr(digits));
  if (!number || *number > std::numeric_limits<int>::max()) return;
  body.state = static_cast<int>(*number);
  body.name.resize(digits - 1);
}

}  // namespace

PictureBody read_picture_body(const std::filesystem::path& file, const std::string& field) {
  const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(file);
  const ShownValues values = shown_values(file, *grid, field);
  const Cells cells = cells_of(*grid);
  const auto sheet = extract(*grid, cells.triangles, values);
  PictureBody body;
  add_name(body, file);
  body.surface = joined(sheet, outer_faces(*grid, cells.volumes, values));
  body.edges = joined(edges_of(*sheet), edges_of(*whole_faces(*grid, cells.volumes)));
  body.lines = extract(*grid, cells.lines, {values.points, nullptr});
  body.frames = extract(*grid, cells.frames, {});
  add_rest(body, *grid, cells);
  body.shown_on = values.points ? ShownOn::points : values.cells ? ShownOn::cells : ShownOn::nothing;
  return body;
}

}  // namespace fascia::io
