#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace fascia::io {

/// Where the values shown belong.
enum class ShownOn { nothing, points, cells };

/// What a picture shows of one result file; each part may be empty.
struct PictureBody {
  vtkSmartPointer<vtkPolyData> surface;  ///< triangles and the outer faces of volume cells, with the array "shown"
  vtkSmartPointer<vtkPolyData> edges;    ///< the faces whose edges are drawn: those of linear cells and triangles
  vtkSmartPointer<vtkPolyData> lines;    ///< segments, with the array "shown" where it belongs to points
  vtkSmartPointer<vtkPolyData> frames;   ///< the points of part 1
  ShownOn shown_on = ShownOn::nothing;
};

/// Name of the array that holds what is shown: the field, or its magnitude.
inline constexpr const char* shown_array = "shown";

/// Reads a .vtu as write_vtu makes it: volume cells, triangles, lines, and vertices whose cell array "part" is 1 for
/// frames. Each face of a quadratic cell becomes flat triangles between its corners and mid-side nodes.
///
/// @param field  point field, or a cell field where no point field has that name; of more than one component its
///               magnitude is shown; none where empty
/// @throws FileError   where the file cannot be read
/// @throws InputError  where it has no such field (names those it has)
PictureBody read_picture_body(const std::filesystem::path& file, const std::string& field);

}  // namespace fascia::io
