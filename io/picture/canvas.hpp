#pragma once

#include <vtkRenderer.h>

#include <array>
#include <string>
#include <vector>

namespace fascia::io {

/// A place in the picture [pixels], from its lower left corner.
struct Pixel {
  double x = 0, y = 0;
};

using Color = std::array<double, 3>;  ///< red, green, blue from 0 to 1

/// Where a text stands from its place.
enum class Anchor { left, center, right };

struct TextStyle {
  int size = 12;  ///< [pixels]
  bool bold = false;
  Anchor across = Anchor::left;  ///< up and down it is centred on its place
};

/// Width and height of a text [pixels].
Pixel measure(const std::string& text, const TextStyle& style);

/// What stands in front of a picture, in pixels: filled shapes, strokes, texts.
class Canvas {
 public:
  void triangle(Pixel a, Pixel b, Pixel c, const Color& color);
  void rectangle(Pixel low, Pixel high, const Color& color);
  void stroke(Pixel a, Pixel b, double width, const Color& color);
  void text(Pixel at, const std::string& text, const TextStyle& style, const Color& color);
  /// @param renderer  covers the whole picture
  void add_to(vtkRenderer& renderer) const;

 private:
  struct Shape {
    std::array<Pixel, 3> corners;
    Color color;
  };
  struct Label {
    Pixel at;
    std::string text;
    TextStyle style;
    Color color;
  };
  std::vector<Shape> shapes_;
  std::vector<Label> labels_;
};

}  // namespace fascia::io
