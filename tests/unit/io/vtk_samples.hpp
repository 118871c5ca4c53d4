#pragma once

#include <array>
#include <string>

/// The corner tetrahedron of the unit cube, as a surface or a cell, in each text format that VTK reads.
namespace fascia::samples {

struct VtkSample {
  const char* file;
  const char* text;
};

inline constexpr std::array<VtkSample, 7> vtk_samples{{
    {"surface.vtk",
     "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET POLYDATA\n"
     "POINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
     "POLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"},
    {"volume.vtk",
     "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET UNSTRUCTURED_GRID\n"
     "POINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
     "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"},
    {"volume.vtu",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
     "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n"
     "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 "
     "1</DataArray></Points>\n"
     "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\n"
     "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>\n"
     "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells>\n"
     "</Piece></UnstructuredGrid></VTKFile>\n"},
    {"surface.vtp",
     "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
     "<PolyData><Piece NumberOfPoints=\"4\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
     "NumberOfPolys=\"4\">\n"
     "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 "
     "1</DataArray></Points>\n"
     "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 1 2 3 0 3 2</DataArray>\n"
     "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray></Polys>\n"
     "</Piece></PolyData></VTKFile>\n"},
    {"surface.stl",
     "solid sample\n"
     "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
     "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
     "facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
     "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
     "endsolid sample\n"},
    {"surface.obj",
     "# sample\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\n"
     "f 1/1/1 3/1/1 2/1/1\nf 1 2 4\nf 2 3 4\nf 1//1 4//1 3//1\n"},
    {"surface.ply",
     "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
     "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
     "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"},
}};

}  // namespace fascia::samples
