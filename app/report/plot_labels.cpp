#include "app/report/plot_labels.hpp"

#include "app/report/markup.hpp"

#include <algorithm>

namespace fascia::app {

double text_width(const std::string& text, double size) {
  constexpr double mean = 0.56;  // of the font's size, a character
  return mean * size * static_cast<double>(characters(text));
}

std::optional<PlotLabels::Place> PlotLabels::first_free(const std::vector<PlotBox>& boxes, double size) {
  for (const PlotBox& box : boxes) {
    const bool within = box.left >= inside_.left && box.right <= inside_.right && box.top >= inside_.top &&
                        box.bottom <= inside_.bottom;
    if (!within || std::any_of(taken_.begin(), taken_.end(), [&](const PlotBox& b) { return b.meets(box); })) continue;
    taken_.push_back(box);
    return Place{box.left, box.bottom - 0.2 * size};
  }
  return std::nullopt;
}

std::optional<PlotLabels::Place> PlotLabels::beside_point(const std::string& text, double size, double x, double y) {
  constexpr double gap = 8;
  const double width = text_width(text, size);
  const auto box = [&](double left, double top) { return PlotBox{left, top, left + width, top + size}; };
  const double right = x + gap, left = x - gap - width, above = y - gap - size, below = y + gap;
  return first_free({box(right, y - size / 2), box(left, y - size / 2), box(x - width / 2, above),
                     box(x - width / 2, below), box(right - gap / 2, above), box(right - gap / 2, below),
                     box(left + gap / 2, above), box(left + gap / 2, below)},
                    size);
}

std::optional<PlotLabels::Place> PlotLabels::above_line(const std::string& text, double size, double y) {
  constexpr double gap = 3;
  const double width = text_width(text, size), left = inside_.left + 6, right = inside_.right - 6;
  const double above = y - gap - size, below = y + gap;
  return first_free({{right - width, above, right, above + size},
                     {right - width, below, right, below + size},
                     {left, above, left + width, above + size},
                     {left, below, left + width, below + size}},
                    size);
}

std::optional<PlotLabels::Place> PlotLabels::beside_line(const std::string& text, double size, double x) {
  constexpr double gap = 5;
  const double width = text_width(text, size), top = inside_.top + 4, bottom = inside_.bottom - 4;
  const double right = x + gap, left = x - gap - width;
  return first_free({{right, top, right + width, top + size},
                     {left, top, left + width, top + size},
                     {right, bottom - size, right + width, bottom},
                     {left, bottom - size, left + width, bottom}},
                    size);
}

}  // namespace fascia::app
