#include "core/base/errors.hpp"
#include "core/geometry/surface.hpp"
#include "io/gmsh/gmsh.hpp"
#include "io/mesh/off_reader.hpp"
#include "io/mesh/ply_reader.hpp"
#include "io/mesh/vtk_cells.hpp"

#include <vtkDataSet.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace {

/// The formats of own parsing are told apart by their first byte.
fascia::Mesh parse(std::string_view text) {
  using namespace fascia::io;
  std::vector<std::string> messages;
  if (text.starts_with('p'))
    return mesh_of_vtk(*parse_ply(text, "fuzz.ply", messages), "fuzz.ply", 0, 0, fascia::MidNodes::drop);
  if (!text.starts_with('O')) return parse_gmsh(text, "fuzz.msh");
  return mesh_of_vtk(*parse_off(text, "fuzz.off", messages), "fuzz.off", 0, 0, fascia::MidNodes::drop);
}

}  // namespace

/// Any bytes at all are either a mesh or an InputError; a mesh either has a closed surface or an InputError says why
/// not.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    fascia::closed_surface(parse(text));
  } catch (const fascia::InputError&) {
  }
  return 0;
}
