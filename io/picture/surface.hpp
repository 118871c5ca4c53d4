#pragma once

#include <vtkDoubleArray.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <vector>

namespace fascia::io {

/// Values shown: one a point, one a cell, or none (null).
struct ShownValues {
  vtkSmartPointer<vtkDoubleArray> points, cells;
};

/// The cells (vertices, lines or polygons) with the points that they use; their values become the active scalars.
vtkSmartPointer<vtkPolyData> extract(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells,
                                     const ShownValues& values);

/// The faces of volume cells that no second cell shares, with their values; quadratic faces as triangles.
vtkSmartPointer<vtkPolyData> outer_faces(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells,
                                         const ShownValues& values);

/// Both as one; the active scalars of both must belong to the same.
vtkSmartPointer<vtkPolyData> joined(vtkPolyData* a, vtkPolyData* b);

}  // namespace fascia::io
