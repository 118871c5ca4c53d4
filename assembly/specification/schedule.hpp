#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

/// How loads, motions, fluids and gravity grow.
namespace fascia {

struct LinearProfile {};
struct SmoothProfile {};
struct TableProfile {
  std::vector<std::array<double, 2>> points{};
};  ///< (time [s], factor [-]), times ascending
struct SineProfile {
  double period = 1;
};

/// A factor over time: `over` [s] (0: at once) and `profile`.
struct Schedule {
  double over = 0;
  bool has_over = false;
  std::variant<LinearProfile, SmoothProfile, TableProfile, SineProfile> profile;
  std::string dial{};  ///< name of a number by which a program multiplies the factor (fascia/stepper.hpp); empty: none
};

/// Factor of a schedule at a time [s]; in statics at a load factor, which stands for time / `over`, or for time / the
/// last time of a table.
double schedule_factor(const Schedule& schedule, double time, bool statics);

/// Factor of a schedule in statics where the load factor is an unknown: below 0 and above 1 the profile goes on
/// straight.
double path_factor(const Schedule& schedule, double load_factor);

}  // namespace fascia
