#pragma once

#include <array>
#include <variant>
#include <vector>

/// How loads, motions, fluids and gravity grow.
namespace fascia::app {

struct LinearProfile {};
struct SmoothProfile {};
struct TableProfile {
  std::vector<std::array<double, 2>> points;
};  ///< (time [s], factor [-]), times ascending
struct SineProfile {
  double period = 1;
};

/// A factor over time: `over` [s] (0: at once) and `profile`.
struct Schedule {
  double over = 0;
  bool has_over = false;
  std::variant<LinearProfile, SmoothProfile, TableProfile, SineProfile> profile;
};

}  // namespace fascia::app
