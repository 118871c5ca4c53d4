#pragma once

#include <cstddef>
#include <string>

namespace fascia::app {

/// How one series of a plot is drawn. Six colours, whose pairs keep a distance of at least 18 in CIELAB under simulated
/// protanopia, deuteranopia and tritanopia and 3 : 1 of contrast against white; seven shapes, so that the first 42
/// series differ, and each differs from its neighbours without colour. From the eighth on shapes are hollow.
struct SeriesStyle {
  std::string name;    ///< of its colour in a page's style: "s0" … "s5"
  std::string colour;  ///< "#0072b2"
  std::string dash;    ///< of its lines, as stroke-dasharray; empty: solid
  std::size_t shape = 0;
  bool hollow = false;
};

/// Of the series at this place in a plot.
SeriesStyle series_style(std::size_t index, bool dashed);

/// A shape around a point, as an element of SVG without its end: `<path d="…" fill="…" …`.
std::string shape_element(const SeriesStyle& style, double x, double y);

/// A coordinate in SVG: hundredths of a pixel, without zeros at the end.
std::string coordinate(double pixels);

}  // namespace fascia::app
