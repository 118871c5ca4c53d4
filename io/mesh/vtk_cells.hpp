#pragma once

#include "core/geometry/mesh.hpp"
#include "core/geometry/mid_nodes.hpp"

#include <string>

class vtkDataSet;

namespace fascia::io {

/// Points and cells of a VTK data set: pixels and voxels in the usual order of nodes, strips and polygons as triangles,
/// cells of higher order by their corners, quadratic ones with their mid-side nodes where these are asked for (the
/// other points between are left out). An array of cells may number groups (read_mesh says which).
///
/// @param name       the file's name, for messages
/// @param first_cell, first_point  the file's own number of its first cell and point
/// @param mid_nodes  of quadratic cells
/// @throws InputError  no cells, a cell of another kind, an index that is out of range, a coordinate that is not finite
Mesh mesh_of_vtk(vtkDataSet& data, const std::string& name, int first_cell, int first_point, MidNodes mid_nodes);

}  // namespace fascia::io
