#include "io/picture/results.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/picture/surface.hpp"
#include "io/vtk_errors.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
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

}  // namespace

PictureBody read_picture_body(const std::filesystem::path& file, const std::string& field) {
  const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(file);
  const ShownValues values = shown_values(file, *grid, field);
  vtkDataArray* part = grid->GetCellData()->GetArray("part");
  std::vector<vtkIdType> volumes, linear_volumes, triangles, lines, frames;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    const int type = grid->GetCellType(c);
    const bool linear = type == VTK_TETRA || type == VTK_HEXAHEDRON;
    if (linear) linear_volumes.push_back(c);
    if (linear || type == VTK_QUADRATIC_TETRA || type == VTK_QUADRATIC_HEXAHEDRON) volumes.push_back(c);
    if (type == VTK_TRIANGLE) triangles.push_back(c);
    if (type == VTK_LINE) lines.push_back(c);
    if (type == VTK_VERTEX && part && static_cast<int>(part->GetComponent(c, 0)) == frame_part) frames.push_back(c);
  }
  const auto sheet = extract(*grid, triangles, values);
  PictureBody body;
  body.surface = joined(sheet, outer_faces(*grid, volumes, values));
  body.edges = linear_volumes.size() == volumes.size() ? body.surface
                                                       : joined(sheet, outer_faces(*grid, linear_volumes, values));
  body.lines = extract(*grid, lines, {values.points, nullptr});
  body.frames = extract(*grid, frames, {});
  body.shown_on = values.points ? ShownOn::points : values.cells ? ShownOn::cells : ShownOn::nothing;
  return body;
}

}  // namespace fascia::io
