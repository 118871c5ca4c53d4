#include "assembly/specification/readable.hpp"

#include "core/geometry/bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace fascia {
namespace {

struct Unit {
  double from = 0, size = 1;  ///< the least value that it is used for
  const char* name = "";
};

constexpr Unit kLengths[] = {{1000, 1000, "km"}, {1, 1, "m"},        {0.1, 0.01, "cm"},
                             {1e-3, 1e-3, "mm"}, {1e-6, 1e-6, "um"}, {0, 1e-9, "nm"}};
constexpr Unit kMasses[] = {{1000, 1000, "t"}, {1, 1, "kg"}, {1e-3, 1e-3, "g"}, {1e-6, 1e-6, "mg"}, {0, 1e-9, "ug"}};
constexpr Unit kVolumes[] = {
    {1, 1, "m3"}, {1e-3, 1e-3, "l"}, {1e-6, 1e-6, "cm3"}, {1e-12, 1e-9, "mm3"}, {0, 1e-18, "um3"}};
constexpr Unit kPressures[] = {{1e9, 1e9, "GPa"}, {1e6, 1e6, "MPa"}, {1e3, 1e3, "kPa"}, {1, 1, "Pa"}, {0, 1e-3, "mPa"}};
constexpr Unit kTimes[] = {{3600, 3600, "h"},  {120, 60, "min"},   {1, 1, "s"},
                           {1e-3, 1e-3, "ms"}, {1e-6, 1e-6, "us"}, {0, 1e-9, "ns"}};

const Unit& unit_for(std::span<const Unit> units, double value) {
  constexpr double kRounding = 5e-4;  // of three digits
  return *std::find_if(units.begin(), units.end() - 1,
                       [&](const Unit& u) { return std::abs(value) >= u.from * (1 - kRounding); });
}

std::string text(std::span<const Unit> units, double value) {
  const Unit& unit = unit_for(units, value);
  return fmt::format("{:.3g} {}", value / unit.size, unit.name);
}

}  // namespace

std::string length_text(double metres) { return text(kLengths, metres); }
std::string mass_text(double kilograms) { return text(kMasses, kilograms); }
std::string volume_text(double cubic_metres) { return text(kVolumes, cubic_metres); }
std::string pressure_text(double pascals) { return text(kPressures, pascals); }
std::string time_text(double seconds) { return text(kTimes, seconds); }

std::string body_text(const ModelBody& body) {
  Bounds bounds = bounds_of(body.surface().points);
  for (const BodyPoint& p : body.points()) bounds.include(p.X);  // of lines, which have no surface
  return fmt::format("{}, {}, {}", box_text(bounds.empty() ? Vec3d{} : bounds.extent()), volume_text(body.volume()),
                     mass_text(body.mass()));
}

std::string box_text(const Vec3d& metres) {
  const Unit& unit = unit_for(kLengths, std::max({metres[0], metres[1], metres[2]}));
  return fmt::format("{:.3g} x {:.3g} x {:.3g} {}", metres[0] / unit.size, metres[1] / unit.size, metres[2] / unit.size,
                     unit.name);
}

}  // namespace fascia
