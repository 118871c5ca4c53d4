#pragma once

#include <string>
#include <vector>

namespace fascia::app {

struct LegendItem {
  std::string sign;  ///< elements of SVG around (14, 0) within 28 x 14 pixels; empty: a remark with a row of its own
  std::string text;
};

/// Elements of SVG with rows of signs and texts.
struct Legend {
  std::string svg;
  double height = 0;  ///< [px]; 0 without items
};

/// @param width, top  of the place for it [px]
Legend legend_of(const std::vector<LegendItem>& items, double width, double top, double text_size);

}  // namespace fascia::app
