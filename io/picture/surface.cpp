#include "io/picture/surface.hpp"

#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataSetSurfaceFilter.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <cstddef>

namespace fascia::io {
namespace {

vtkSmartPointer<vtkDoubleArray> chosen(vtkDoubleArray* values, const std::vector<vtkIdType>& places) {
  if (!values) return nullptr;
  auto result = vtkSmartPointer<vtkDoubleArray>::New();
  result->SetName(values->GetName());
  for (const vtkIdType place : places) result->InsertNextValue(values->GetValue(place));
  return result;
}

}  // namespace

vtkSmartPointer<vtkPolyData> extract(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells,
                                     const ShownValues& values) {
  std::vector<vtkIdType> number(static_cast<std::size_t>(grid.GetNumberOfPoints()), -1), used;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices, lines, polygons;
  vtkNew<vtkIdList> ids;
  for (const vtkIdType c : cells) {
    grid.GetCellPoints(c, ids);
    for (vtkIdType n = 0; n < ids->GetNumberOfIds(); ++n) {
      const vtkIdType p = ids->GetId(n);
      vtkIdType& target = number[static_cast<std::size_t>(p)];
      if (target < 0) {
        target = points->InsertNextPoint(grid.GetPoint(p));
        used.push_back(p);
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
  data->GetPointData()->SetScalars(chosen(values.points, used));
  data->GetCellData()->SetScalars(chosen(values.cells, cells));
  return data;
}

vtkSmartPointer<vtkPolyData> outer_faces(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells,
                                         const ShownValues& values) {
  vtkNew<vtkUnstructuredGrid> volumes;
  volumes->SetPoints(grid.GetPoints());
  vtkNew<vtkIdList> ids;
  for (const vtkIdType c : cells) {
    grid.GetCellPoints(c, ids);
    volumes->InsertNextCell(grid.GetCellType(c), ids);
  }
  volumes->GetPointData()->SetScalars(values.points);
  volumes->GetCellData()->SetScalars(chosen(values.cells, cells));
  vtkNew<vtkDataSetSurfaceFilter> filter;
  filter->SetInputData(volumes);
  filter->SetNonlinearSubdivisionLevel(1);
  filter->Update();
  return filter->GetOutput();
}

vtkSmartPointer<vtkPolyData> joined(vtkPolyData* a, vtkPolyData* b) {
  if (a->GetNumberOfCells() == 0) return b;
  if (b->GetNumberOfCells() == 0) return a;
  vtkNew<vtkAppendPolyData> both;
  both->AddInputData(a);
  both->AddInputData(b);
  both->Update();
  return both->GetOutput();
}

}  // namespace fascia::io
