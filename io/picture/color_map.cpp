#include "io/picture/color_map.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace fascia::io {

vtkSmartPointer<vtkLookupTable> perceptual_colors(double low, double high) {
  constexpr std::array<std::array<double, 3>, 9> points{{{0.267, 0.005, 0.329},
                                                         {0.279, 0.175, 0.483},
                                                         {0.230, 0.322, 0.546},
                                                         {0.173, 0.449, 0.558},
                                                         {0.128, 0.567, 0.551},
                                                         {0.158, 0.684, 0.502},
                                                         {0.369, 0.789, 0.383},
                                                         {0.678, 0.864, 0.190},
                                                         {0.993, 0.906, 0.144}}};
  constexpr int colors = 256;
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(colors);
  for (int i = 0; i < colors; ++i) {
    const double place = static_cast<double>(i) / (colors - 1) * (points.size() - 1);
    const std::size_t k = std::min(static_cast<std::size_t>(place), points.size() - 2);
    const double s = place - static_cast<double>(k);
    const auto mix = [&](std::size_t c) { return (1 - s) * points[k][c] + s * points[k + 1][c]; };
    table->SetTableValue(i, mix(0), mix(1), mix(2), 1);
  }
  table->SetTableRange(low, high);
  table->Build();
  return table;
}

}  // namespace fascia::io
