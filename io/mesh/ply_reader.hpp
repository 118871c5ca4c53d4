#pragma once

#include <vtkSmartPointer.h>

#include <string>
#include <string_view>
#include <vector>

class vtkDataSet;

namespace fascia::io {

/// Vertices (x, y, z) and faces (vertex_indices or vertex_index) of a PLY file, of text or binary, in its numbering
/// from 0. Other properties and elements are left out. In text each element has a line of its own, as the format wants
/// it.
///
/// @param name      the file's name, for messages
/// @param messages  receives what was mended
/// @throws InputError  "NAME:LINE: what is wrong; remedy"; behind a binary header without a line
vtkSmartPointer<vtkDataSet> parse_ply(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages);

}  // namespace fascia::io
