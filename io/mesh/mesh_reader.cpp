#include "io/mesh/mesh_reader.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/gmsh/gmsh.hpp"
#include "io/mesh/vtk_reader.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace fascia::io {

Mesh read_mesh(const std::filesystem::path& path, MidNodes mid_nodes) {
  constexpr std::array<std::string_view, 7> vtk_endings{".vtk", ".vtu", ".vtp", ".stl", ".obj", ".off", ".ply"};
  std::string ending = path.extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".msh") return parse_gmsh(read_file(path), path.string(), mid_nodes);
  check_readable(path);
  if (std::find(vtk_endings.begin(), vtk_endings.end(), ending) == vtk_endings.end())
    throw InputError(path.string() + ": the ending \"" + ending +
                     "\" names no known mesh format; must be .msh, .vtk, .vtu, .vtp, .stl, .obj, .off or .ply");
  return read_vtk_mesh(path, ending, mid_nodes);
}

}  // namespace fascia::io
