#include "io/picture/results.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/vtk_errors.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
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

vtkSmartPointer<vtkDoubleArray> shown_values(const std::filesystem::path& file, vtkUnstructuredGrid& grid,
                                             const std::string& field) {
  vtkDataArray* array = grid.GetPointData()->GetArray(field.c_str());
  if (!array) {
    std::string names;
    for (int a = 0; a < grid.GetPointData()->GetNumberOfArrays(); ++a)
      names += (a ? ", " : "") + std::string(grid.GetPointData()->GetArrayName(a));
    throw InputError(file.string() + ": has no point field \"" + field + "\"; it has " +
                     (names.empty() ? "none" : names));
  }
  auto values = vtkSmartPointer<vtkDoubleArray>::New();
  values->SetName(shown_array);
  const int components = array->GetNumberOfComponents();
  for (vtkIdType p = 0; p < array->GetNumberOfTuples(); ++p) {
    double sum = 0;
    for (int c = 0; c < components; ++c) sum += array->GetComponent(p, c) * array->GetComponent(p, c);
    values->InsertNextValue(components == 1 ? array->GetComponent(p, 0) : std::sqrt(sum));
  }
  return values;
}

/// The points that the cells use, and the cells.
vtkSmartPointer<vtkPolyData> extract(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells,
                                     vtkDoubleArray* values) {
  std::vector<vtkIdType> number(static_cast<std::size_t>(grid.GetNumberOfPoints()), -1);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> vertices, lines, polygons;
  vtkNew<vtkDoubleArray> shown;
  vtkNew<vtkIdList> ids;
  shown->SetName(shown_array);
  for (const vtkIdType c : cells) {
    grid.GetCellPoints(c, ids);
    for (vtkIdType n = 0; n < ids->GetNumberOfIds(); ++n) {
      const vtkIdType p = ids->GetId(n);
      vtkIdType& target = number[static_cast<std::size_t>(p)];
      if (target < 0) {
        target = points->InsertNextPoint(grid.GetPoint(p));
        if (values) shown->InsertNextValue(values->GetValue(p));
      }
      ids->SetId(n, target);
    }
    const vtkIdType size = ids->GetNumberOfIds();
    (size == 1 ? vertices : size == 2 ? lines : polygons)->InsertNextCell(ids);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(polygons);
  data->SetLines(lines);
  data->SetVerts(vertices);
  if (values) data->GetPointData()->SetScalars(shown);
  return data;
}

}  // namespace

PictureBody read_picture_body(const std::filesystem::path& file, const std::string& field) {
  const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(file);
  const vtkSmartPointer<vtkDoubleArray> values = field.empty() ? nullptr : shown_values(file, *grid, field);
  vtkDataArray* part = grid->GetCellData()->GetArray("part");
  std::vector<vtkIdType> triangles, lines, frames;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    if (grid->GetCellType(c) == VTK_TRIANGLE) triangles.push_back(c);
    if (grid->GetCellType(c) == VTK_LINE) lines.push_back(c);
    if (grid->GetCellType(c) == VTK_VERTEX && part && static_cast<int>(part->GetComponent(c, 0)) == frame_part)
      frames.push_back(c);
  }
  return {extract(*grid, triangles, values), extract(*grid, lines, values), extract(*grid, frames, nullptr)};
}

}  // namespace fascia::io
