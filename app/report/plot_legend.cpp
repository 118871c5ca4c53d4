#include "app/report/plot_legend.hpp"

#include "app/report/markup.hpp"
#include "app/report/plot_labels.hpp"
#include "app/report/plot_marks.hpp"

#include <fmt/format.h>

namespace fascia::app {

Legend legend_of(const std::vector<LegendItem>& items, double width, double top, double text_size) {
  constexpr double row = 20, left = 14, sign = 34, gap = 18;
  if (items.empty()) return {};
  Legend legend;
  const auto most = static_cast<std::size_t>((width - left - sign) / text_width("x", text_size));
  double x = left, y = top + row / 2;
  for (const LegendItem& item : items) {
    const std::string text = shortened(item.text, most);
    const double shift = item.sign.empty() ? 0 : sign, length = shift + text_width(text, text_size);
    if (x > left && (item.sign.empty() || x + length > width)) {
      x = left;
      y += row;
    }
    legend.svg +=
        fmt::format("<g transform=\"translate({} {})\">{}<text x=\"{}\" y=\"4\" fill=\"#222222\">{}</text></g>\n",
                    coordinate(x), coordinate(y), item.sign, coordinate(shift), escaped(text));
    x += length + gap;
  }
  legend.height = y + row / 2 + 4 - top;
  return legend;
}

}  // namespace fascia::app
