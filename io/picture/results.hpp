#pragma once

#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::io {

/// Where the values shown belong.
enum class ShownOn { nothing, points, cells };

/// What a picture shows of one result file; each part may be empty.
struct PictureBody {
  std::string name;                      ///< the body's, from the name of the file
  int state = -1;                        ///< number of the state, from the name of the file; −1 where it has none
  vtkSmartPointer<vtkPolyData> surface;  ///< triangles and the outer faces of volume cells, with the array "shown"
  vtkSmartPointer<vtkPolyData> edges;    ///< edges of the cells there, each once
  vtkSmartPointer<vtkPolyData> lines;    ///< segments, with the array "shown" where it belongs to points
  vtkSmartPointer<vtkPolyData> frames;   ///< the points of part 1
  vtkSmartPointer<vtkPolyData> rest_surface;  ///< the surface at rest
  vtkSmartPointer<vtkPolyData> rest_lines;    ///< the segments at rest
  vtkSmartPointer<vtkPoints> now, rest;       ///< all points, and where they are at rest; null where that is not known
  ShownOn shown_on = ShownOn::nothing;        ///< nothing where it has no such field
  std::vector<std::string> fields;            ///< names of all that it has, of points, then of cells
};

/// Name of the array that holds what is shown: the field, or its magnitude.
inline constexpr const char* shown_array = "shown";

/// Reads a .vtu as write_vtu makes it: volume cells, triangles, lines, and vertices whose cell array "part" is 1 for
/// frames. Each face of a quadratic cell becomes flat triangles between its corners and mid-side nodes. The shape at
/// rest comes from the point array "rest_position".
///
/// @param field  point field, or a cell field where no point field has that name; of more than one component its
///               magnitude is shown; none where empty or absent
/// @throws FileError   where the file cannot be read
/// @throws InputError  where it is damaged
PictureBody read_picture_body(const std::filesystem::path& file, const std::string& field);

/// Bodies of one picture may differ in their fields: one must have the field that is shown, unless it is empty.
/// @throws InputError  names the fields that there are
void check_field(const std::vector<PictureBody>& bodies, const std::string& field);

}  // namespace fascia::io
