#pragma once

#include <string>
#include <vector>

namespace fascia::app {

struct PlotPoint {
  double x = 0, y = 0;
  double x_low = 0, x_high = 0;  ///< spread of x; drawn where x_low < x_high
  std::string label;             ///< in its tooltip, and beside it where there is room, of marked points or few (60)
  std::string detail;            ///< lines for its tooltip
  bool marked = false;           ///< has a ring, stands in front, and its label is placed first
};

struct PlotSeries {
  std::string name;  ///< in the legend; empty: not in it
  std::vector<PlotPoint> points;
  bool joined = false;  ///< by a line, in this order
  bool dashed = false;  ///< so is the line
  std::string note;     ///< "order 1.98": beside the middle of the series, and in the legend
};

/// A line across the whole plot.
struct PlotLine {
  double value = 0;
  bool vertical = false;  ///< at a value of x
  std::string text;
};

/// Points of two numbers, in series that differ by shape and colour.
struct Plot {
  std::string title, x_title, y_title;  ///< the axes' with their units
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series;
  std::vector<PlotLine> lines;
  std::string ring_name;  ///< what marked points are, for the legend
};

/// The plot as an SVG element: a file of its own, or a part of a page, whose style may give other colours. The same
/// plot gives the same bytes.
///
/// What an axis cannot show (zero and less on a logarithmic one, infinite values) stands at its end with an arrow; a
/// point of which a coordinate is no number is left out. The plot says both.
///
/// @param width, height  of title, axes and their texts [px], at least 240 and 180; the legend's rows come below
std::string svg_of(const Plot& plot, int width, int height);

}  // namespace fascia::app
