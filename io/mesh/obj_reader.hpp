#pragma once

#include <vtkSmartPointer.h>

#include <string>
#include <string_view>
#include <vector>

class vtkDataSet;

namespace fascia::io {

/// Vertices and faces of a Wavefront OBJ file, in the file's numbering. (VTK's own reader leaves out faces that mix
/// notations and numbers the vertices anew where texture coordinates differ.)
///
/// @param name      the file's name, for messages
/// @param messages  receives what was mended
/// @throws InputError  "NAME:LINE: what is wrong; remedy"
vtkSmartPointer<vtkDataSet> parse_obj(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages);

}  // namespace fascia::io
