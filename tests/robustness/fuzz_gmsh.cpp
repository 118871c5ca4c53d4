#include "core/geometry/surface.hpp"
#include "core/model/errors.hpp"
#include "io/gmsh.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

/// Any bytes at all are either a mesh or an InputError; a mesh either has a closed surface or an InputError says why
/// not.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    fascia::closed_surface(fascia::io::parse_gmsh(text, "fuzz.msh"));
  } catch (const fascia::InputError&) {
  }
  return 0;
}
