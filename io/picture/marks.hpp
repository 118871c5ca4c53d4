#pragma once

#include "io/picture/results.hpp"
#include "io/picture_description.hpp"

#include <array>
#include <vector>

namespace fascia::io {

/// Supports and springs of a state at their places [m].
struct Marks {
  std::vector<Vec3d> held, held_in_part;
  std::vector<std::array<Vec3d, 2>> springs;  ///< from the body to the anchor
};

/// Finds the places: a material point goes with the nearest point at rest of its body. Marks of bodies that are not
/// shown, or whose rest is not known, are left out.
Marks find_marks(const PictureDescription& description, const std::vector<PictureBody>& bodies);

/// Some of the places, so that there is about one in each cube of this size [m].
std::vector<Vec3d> thinned(const std::vector<Vec3d>& places, double size);

}  // namespace fascia::io
