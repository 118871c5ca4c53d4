#include "io/picture/layout.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::io {

int font_of(const std::array<int, 2>& size) {
  constexpr double part = 50, smallest = 9, largest = 80;
  const double mean = std::sqrt(static_cast<double>(size[0]) * size[1]);
  return static_cast<int>(std::clamp(mean / part, smallest, largest));
}

std::vector<Area> tiles_of(const Area& area, std::size_t count, double width, double height, double label) {
  std::size_t columns = 1;
  double largest = 0;
  for (std::size_t c = 1; c <= count; ++c) {
    const std::size_t lines = (count + c - 1) / c;
    const auto across = static_cast<double>(c), down = static_cast<double>(lines);
    const double scale = std::min(area.width() / across / width, (area.height() / down - label) / height);
    if (scale <= largest) continue;
    largest = scale;
    columns = c;
  }
  const std::size_t rows = (count + columns - 1) / columns;
  const double w = area.width() / static_cast<double>(columns), h = area.height() / static_cast<double>(rows);
  std::vector<Area> tiles;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const double x = area.low.x + w * static_cast<double>(column), y = area.high.y - h * static_cast<double>(row + 1);
    tiles.push_back({{x, y}, {x + w, y + h}});
  }
  return tiles;
}

}  // namespace fascia::io
