#pragma once

#include "core/math/vec3.hpp"

#include <vtkDataSet.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <vector>

namespace fascia::io {

/// The edges of cells that are faces, each once; of quadratic ones through the nodes on their middles.
vtkSmartPointer<vtkPolyData> edges_of(vtkDataSet& faces);

/// The faces of volume cells that no second cell shares, as cells of their own order.
vtkSmartPointer<vtkUnstructuredGrid> whole_faces(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells);

/// The lines by which a shape is recognised from one side: sharp and free edges, and those between faces that look
/// towards the eye and away from it. Sharp edges on the far side of a closed surface are left out.
/// @param view  from the shape towards the eye
vtkSmartPointer<vtkPolyData> outline_of(vtkPolyData& faces, const Vec3d& view);

}  // namespace fascia::io
