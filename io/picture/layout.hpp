#pragma once

#include "io/picture/canvas.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace fascia::io {

/// A part of the picture [pixels].
struct Area {
  Pixel low, high;
  double width() const { return high.x - low.x; }
  double height() const { return high.y - low.y; }
};

/// Height of the texts of a picture [pixels].
int font_of(const std::array<int, 2>& size);

/// Cuts an area into equal tiles, row by row from the top, so that what is `width` by `height` becomes as large as can
/// be in each.
/// @param label  height of what stands above each tile [pixels]
std::vector<Area> tiles_of(const Area& area, std::size_t count, double width, double height, double label);

}  // namespace fascia::io
