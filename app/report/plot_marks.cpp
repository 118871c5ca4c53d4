#include "app/report/plot_marks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

namespace fascia::app {
namespace {

constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#222222", "#8a2be2", "#2fa36b", "#7a3b1a"};
constexpr const char* kDashes[] = {"7 4", "2 3", "9 3 2 3"};
constexpr std::size_t kShapes = 7;

using Corners = std::vector<std::pair<double, double>>;

/// Of the shapes of about equal area within ± 5 pixels; the first is a disc, the last a cross of two strokes.
Corners corners_of(std::size_t shape) {
  switch (shape) {
    case 1:
      return {{-4, -4}, {4, -4}, {4, 4}, {-4, 4}};
    case 2:
      return {{0, -5.5}, {5, 3.5}, {-5, 3.5}};
    case 3:
      return {{0, -5.5}, {5.5, 0}, {0, 5.5}, {-5.5, 0}};
    case 4:
      return {{0, 5.5}, {5, -3.5}, {-5, -3.5}};
    default: {  // a plus
      constexpr double a = 1.6, b = 5;
      return {{-a, -b}, {a, -b}, {a, -a}, {b, -a}, {b, a},   {a, a},
              {a, b},   {-a, b}, {-a, a}, {-b, a}, {-b, -a}, {-a, -a}};
    }
  }
}

std::string path_of(std::size_t shape, double x, double y) {
  if (shape == 0)
    return fmt::format("M{} {}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z", coordinate(x - 4.5), coordinate(y));
  std::string path;
  const bool turned = shape == 6;
  for (const auto& [dx, dy] : corners_of(shape)) {
    const double u = turned ? (dx - dy) * M_SQRT1_2 : dx, v = turned ? (dx + dy) * M_SQRT1_2 : dy;
    path += fmt::format("{}{} {}", path.empty() ? "M" : "L", coordinate(x + u), coordinate(y + v));
  }
  return path + "Z";
}

}  // namespace

std::string coordinate(double pixels) {
  const double hundredths = std::round(pixels * 100);
  return fmt::format("{}", hundredths == 0 ? 0.0 : hundredths / 100);
}

SeriesStyle series_style(std::size_t index, bool dashed) {
  const std::size_t colour = index % std::size(kColours);
  const char* dash = dashed ? kDashes[index % std::size(kDashes)] : "";
  return {fmt::format("s{}", colour), kColours[colour], dash, index % kShapes, index / kShapes % 2 == 1};
}

std::string shape_element(const SeriesStyle& style, double x, double y) {
  return fmt::format(R"(<path class="{} {}" d="{}" fill="{}" stroke="{}" stroke-width="1.5")", style.name,
                     style.hollow ? "hollow" : "full", path_of(style.shape, x, y),
                     style.hollow ? "#ffffff" : style.colour, style.colour);
}

}  // namespace fascia::app
