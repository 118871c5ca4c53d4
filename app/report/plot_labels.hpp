#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct PlotBox {
  double left = 0, top = 0, right = 0, bottom = 0;  ///< [px]
  bool meets(const PlotBox& b) const { return left < b.right && b.left < right && top < b.bottom && b.top < bottom; }
};

/// About the width of a text in a sans-serif font [px].
double text_width(const std::string& text, double size);

/// Finds places for texts beside points, where they cover neither points nor one another.
class PlotLabels {
 public:
  explicit PlotLabels(const PlotBox& inside) : inside_(inside) {}
  /// A point or a bar.
  void take(const PlotBox& box) { taken_.push_back(box); }

  /// Left end and base line of a text; its place is taken from then on.
  struct Place {
    double x = 0, y = 0;
  };
  /// Next to a point of this radius; none where there is no room. @param covers  points where it must, never texts
  std::optional<Place> beside_point(const std::string& text, double size, double x, double y, double radius,
                                    bool covers);
  /// Along a line across the plot at this height, or at this x. It covers points where nothing is free.
  Place above_line(const std::string& text, double size, double y);
  Place beside_line(const std::string& text, double size, double x);

 private:
  std::optional<Place> first_free(const std::vector<PlotBox>& boxes, double size, bool covers);

  PlotBox inside_;
  std::vector<PlotBox> taken_, texts_;
};

}  // namespace fascia::app
