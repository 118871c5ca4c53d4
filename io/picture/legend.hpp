#pragma once

#include "io/picture/canvas.hpp"

#include <vtkLookupTable.h>

#include <string>
#include <vector>

namespace fascia::io {

inline constexpr Color ink{0.13, 0.13, 0.15};

/// The values that colours stand for, in SI.
struct ColorScale {
  std::string words, unit;            ///< "von Mises stress", "Pa"
  double low = 0, high = 1;           ///< equal where there is one value
  bool below = false, above = false;  ///< there are values beyond, in the colours of the ends
};

/// A legend that is laid out: words with the unit over a bar, round numbers beside it, its ends named.
class Legend {
 public:
  /// @param font  size of its texts [pixels]
  /// @param height, width  that it may take [pixels]; units and numbers that need more width get it
  Legend(const ColorScale& scale, int font, double height, double width);
  double width() const { return width_; }
  /// @param low  its lower left corner
  void draw(Canvas& canvas, Pixel low, vtkLookupTable& colors) const;

 private:
  struct Tick {
    double part = 0;  ///< of the bar's height
    std::string text;
  };
  ColorScale scale_;
  int font_;
  double height_, width_ = 0, bar_ = 0;
  std::vector<std::string> title_;
  std::vector<Tick> ticks_;
};

}  // namespace fascia::io
