#include "io/picture/results.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/mesh/text_numbers.hpp"
#include "io/picture/outline.hpp"
#include "io/picture/surface.hpp"
#include "io/vtk_errors.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <string_view>
#include <vector>

namespace fascia::io {
namespace {

constexpr int frame_part = 1;

/// Each cell of a type that is shown has so many nodes; 0 stands for other types.
vtkIdType nodes_per_cell(int type) {
  switch (type) {
    case VTK_VERTEX:
      return 1;
    case VTK_LINE:
      return 2;
    case VTK_TRIANGLE:
      return 3;
    case VTK_TETRA:
      return 4;
    case VTK_HEXAHEDRON:
      return 8;
    case VTK_QUADRATIC_TETRA:
      return 10;
    case VTK_QUADRATIC_HEXAHEDRON:
      return 20;
    default:
      return 0;
  }
}

/// VTK's reader takes what the file says: a damaged one names points that are not there.
bool has_sound_cells(vtkUnstructuredGrid& grid) {
  if (grid.GetNumberOfCells() == 0) return true;
  vtkCellArray* cells = grid.GetCells();
  vtkUnsignedCharArray* types = grid.GetCellTypesArray();
  if (!cells->IsValid() || !types || types->GetNumberOfValues() != grid.GetNumberOfCells()) return false;
  double ids[2];
  cells->GetConnectivityArray()->GetRange(ids);
  if (ids[0] < 0 || ids[1] >= static_cast<double>(grid.GetNumberOfPoints())) return false;
  for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
    const vtkIdType nodes = nodes_per_cell(grid.GetCellType(c));
    if (nodes > 0 && cells->GetCellSize(c) != nodes) return false;
  }
  return true;
}

/// Each array has as many values as there are points, or cells.
bool has_sound_arrays(vtkFieldData& data, vtkIdType count) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a)
    if (vtkAbstractArray* array = data.GetAbstractArray(a); array && array->GetNumberOfTuples() != count) return false;
  return true;
}

bool is_sound(vtkUnstructuredGrid& grid) {
  return grid.GetNumberOfPoints() > 0 && has_sound_cells(grid) &&
         has_sound_arrays(*grid.GetPointData(), grid.GetNumberOfPoints()) &&
         has_sound_arrays(*grid.GetCellData(), grid.GetNumberOfCells());
}

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& file) {
  check_readable(file);
  VtkErrors errors;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  if (!errors.first().empty() || !is_sound(*reader->GetOutput()))
    throw InputError(file.string() + ": is no readable .vtu result; give one that fascia wrote");
  return reader->GetOutput();
}

std::vector<std::string> fields_of(vtkUnstructuredGrid& grid) {
  std::vector<std::string> names;
  for (vtkFieldData* data : std::array<vtkFieldData*, 2>{grid.GetPointData(), grid.GetCellData()})
    for (int a = 0; a < data->GetNumberOfArrays(); ++a)
      if (const char* name = data->GetArrayName(a)) names.emplace_back(name);
  return names;
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

ShownValues shown_values(vtkUnstructuredGrid& grid, const std::string& field) {
  if (field.empty()) return {};
  if (vtkDataArray* array = grid.GetPointData()->GetArray(field.c_str())) return {magnitudes(*array), nullptr};
  if (vtkDataArray* array = grid.GetCellData()->GetArray(field.c_str())) return {nullptr, magnitudes(*array)};
  return {};
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
  const ShownValues values = shown_values(*grid, field);
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
  body.fields = fields_of(*grid);
  return body;
}

void check_field(const std::vector<PictureBody>& bodies, const std::string& field) {
  const auto shows = [](const PictureBody& body) { return body.shown_on != ShownOn::nothing; };
  if (field.empty() || std::any_of(bodies.begin(), bodies.end(), shows)) return;
  std::set<std::string> told;
  std::string names;
  for (const PictureBody& body : bodies)
    for (const std::string& name : body.fields)
      if (told.insert(name).second) names += (names.empty() ? "" : ", ") + name;
  throw InputError("the results have no field \"" + field + "\"; they have " + (names.empty() ? "none" : names));
}

}  // namespace fascia::io
