#include "app/report/plot_labels.hpp"

#include "app/report/markup.hpp"

#include <algorithm>

namespace fascia::app {

double text_width(const std::string& text, double size) {
  constexpr double mean = 0.56;  // of the font's size, a character
  return mean * size * static_cast<double>(characters(text));
}

std::optional<PlotLabels::Place> PlotLabels::first_free(const std::vector<PlotBox>& boxes, double size, bool covers) {
  const auto meets_any = [](const std::vector<PlotBox>& others, const PlotBox& box) {
    return std::any_of(others.begin(), others.end(), [&](const PlotBox& other) { return other.meets(box); });
  };
  for (const bool over_points : {false, true}) {
    if (over_points && !covers) break;
    for (const PlotBox& box : boxes) {
      const bool within = box.left >= inside_.left && box.right <= inside_.right && box.top >= inside_.top &&
                          box.bottom <= inside_.bottom;
      if (!within || meets_any(texts_, box) || (!over_points && meets_any(taken_, box))) continue;
      texts_.push_back(box);
      return Place{box.left, box.bottom - 0.2 * size};
    }
  }
  return std::nullopt;
}

std::optional<PlotLabels::Place> PlotLabels::beside_point(const std::string& text, double size, double x, double y,
                                                          double radius, bool covers) {
  const double gap = radius + 3;
  const double width = text_width(text, size);
  const auto box = [&](double left, double top) { return PlotBox{left, top, left + width, top + size}; };
  const double right = x + gap, left = x - gap - width, above = y - gap - size, below = y + gap;
  const double beside = y - size / 2, middle = x - width / 2;
  // Lines and bars pass through points from side to side.
  return first_free(
      {box(right - gap / 2, above + 3), box(right - gap / 2, below - 3), box(middle, above), box(middle, below),
       box(left + gap / 2, above + 3), box(left + gap / 2, below - 3), box(right, beside), box(left, beside)},
      size, covers);
}

PlotLabels::Place PlotLabels::above_line(const std::string& text, double size, double y) {
  constexpr double gap = 3;
  const double width = text_width(text, size), left = inside_.left + 6, right = inside_.right - 6;
  const double above = y - gap - size, below = y + gap;
  const auto free = first_free({{right - width, above, right, above + size},
                                {right - width, below, right, below + size},
                                {left, above, left + width, above + size},
                                {left, below, left + width, below + size}},
                               size, true);
  return free.value_or(Place{right - width, above + 0.8 * size});
}

PlotLabels::Place PlotLabels::beside_line(const std::string& text, double size, double x) {
  constexpr double gap = 5;
  const double width = text_width(text, size), top = inside_.top + 4, bottom = inside_.bottom - 4;
  const double right = x + gap, left = x - gap - width;
  const auto free = first_free({{right, top, right + width, top + size},
                                {left, top, left + width, top + size},
                                {right, bottom - size, right + width, bottom},
                                {left, bottom - size, left + width, bottom}},
                               size, true);
  return free.value_or(Place{right, top + 0.8 * size});
}

}  // namespace fascia::app
