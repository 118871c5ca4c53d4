#pragma once

#include <vtkSmartPointer.h>

#include <string>
#include <string_view>
#include <vector>

class vtkDataSet;

namespace fascia::io {

/// Triangles of an STL file, ASCII or binary, of all its solids; each has corners of its own, for closed_surface() to
/// weld. Coordinates of text keep double precision. (VTK's reader comes with its rendering libraries.)
///
/// @param name      the file's name, for messages
/// @param messages  receives what was mended
/// @throws InputError  "NAME:LINE: what is wrong; remedy"; of a binary file with the number of the triangle
vtkSmartPointer<vtkDataSet> parse_stl(std::string_view bytes, const std::string& name,
                                      std::vector<std::string>& messages);

}  // namespace fascia::io
