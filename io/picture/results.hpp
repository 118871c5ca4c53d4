#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace fascia::io {

/// What a picture shows of one result file; each part may be empty.
struct PictureBody {
  vtkSmartPointer<vtkPolyData> surface;  ///< triangles, with the point array "shown"
  vtkSmartPointer<vtkPolyData> lines;    ///< segments, with the same array
  vtkSmartPointer<vtkPolyData> frames;   ///< the points of part 1
};

/// Name of the array that holds what is shown: the field, or its magnitude.
inline constexpr const char* shown_array = "shown";

/// Reads a .vtu as write_vtu makes it: triangles, lines, and vertices whose cell array "part" is 1 for frames.
/// @param field  point field; of more than one component its magnitude is shown; none where empty
/// @throws FileError   where the file cannot be read
/// @throws InputError  where it has no such field (names those it has)
PictureBody read_picture_body(const std::filesystem::path& file, const std::string& field);

}  // namespace fascia::io
