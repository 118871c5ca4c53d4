#pragma once

#include <vtkSmartPointer.h>

#include <string>
#include <string_view>
#include <vector>

class vtkDataSet;

namespace fascia::io {

/// Vertices and faces of an OFF file (ASCII, three coordinates), in the file's numbering from 0. Normals, colours and
/// texture coordinates of vertices (NOFF, COFF, STOFF) and colours of faces are left out; the word OFF may be missing.
///
/// @param name      the file's name, for messages
/// @param messages  receives what was mended
/// @throws InputError  "NAME:LINE: what is wrong; remedy"
vtkSmartPointer<vtkDataSet> parse_off(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages);

}  // namespace fascia::io
