#include "io/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fascia::io {
namespace {

struct KnownField {
  const char *name, *words, *unit;
  bool of_motion;
};

constexpr std::array<KnownField, 14> known_fields{{
    {"displacement", "displacement", "m", true},
    {"rotation", "rotation", "rad", true},
    {"strain", "Green-Lagrange strain, norm", "1", true},
    {"stress", "Cauchy stress, norm", "Pa", true},
    {"von_mises", "von Mises stress", "Pa", true},
    {"energy_density", "energy density", "J/m3", true},
    {"director", "director, length", "1", false},
    {"to_outer_face", "half thickness", "m", false},
    {"thickness", "thickness", "m", false},
    {"membrane_force", "membrane force, norm", "N/m", true},
    {"bending_moment", "bending moment, norm", "N", true},
    {"stress_outer", "stress of the outer face, norm", "Pa", true},
    {"stress_inner", "stress of the inner face, norm", "Pa", true},
    {"rest_position", "distance at rest from the origin", "m", false},
}};

/// Powers of 1000 from −5 to 4.
constexpr std::array<const char*, 10> prefixes{"f", "p", "n", "µ", "m", "", "k", "M", "G", "T"};
constexpr int smallest_power = -5, largest_power = 4;

constexpr double rounding = 1e-9;  // relative; what is less apart is the same number

/// The number is from 1 to 10 times this power of 10.
int power_of_ten(double value) { return static_cast<int>(std::floor(std::log10(value * (1 + rounding)))); }

/// Of a number from 1 to 1000 times this power of 1000.
int power_of_thousand(double value) { return static_cast<int>(std::floor(std::log10(value * (1 + rounding)) / 3)); }

double thousand_to(int power) { return std::pow(1000.0, power); }

/// "J/m3" as people write it.
std::string printed(std::string unit) {
  const std::size_t cube = unit.find("m3");
  if (cube != std::string::npos) unit.replace(cube, 2, "m³");
  return unit;
}

}  // namespace

FieldName name_of_field(const std::string& field) {
  for (const KnownField& known : known_fields)
    if (field == known.name) return {known.words, known.unit, known.of_motion};
  std::string words = field;
  std::replace(words.begin(), words.end(), '_', ' ');
  return {words, ""};
}

ReadableUnit readable_unit(double largest, const std::string& unit) {
  if (!(largest > 0)) return {1, unit == "1" ? "" : printed(unit)};
  const int power = power_of_thousand(largest);
  if (unit == "1" || unit.empty()) {
    constexpr double smallest_plain = 0.01, largest_plain = 1e5;
    if (largest >= smallest_plain && largest < largest_plain) return {};
    return {thousand_to(-power), fmt::format("1e{}", 3 * power)};
  }
  const int chosen = std::clamp(power, smallest_power, largest_power);
  return {thousand_to(-chosen), prefixes[static_cast<std::size_t>(chosen - smallest_power)] + printed(unit)};
}

double round_below(double limit) {
  limit *= 1 + rounding;
  const double power = std::pow(10.0, std::floor(std::log10(limit)));
  const double rest = limit / power;
  return power * (rest >= 5 ? 5 : rest >= 2 ? 2 : 1);
}

Ticks round_ticks(double low, double high, int count) {
  Ticks ticks;
  const double wanted = (high - low) / std::max(count, 1) * (1 - rounding), below = round_below(wanted);
  ticks.step = below;
  for (const double factor : {2.0, 2.5})
    if (ticks.step < wanted) ticks.step = round_below(factor * below);
  const double first = std::ceil(low / ticks.step - rounding), last = std::floor(high / ticks.step + rounding);
  for (double k = first; k <= last; ++k) ticks.values.push_back(k * ticks.step);
  return ticks;
}

std::string number_text(double value, double step) {
  constexpr int most = 9;  // digits behind the point
  if (!(step > 0) || std::abs(value) < 1e-6 * step) value = step > 0 ? 0 : value;
  const int digits = step > 0 ? static_cast<int>(std::ceil(-std::log10(step) - 1e-9)) : most;
  if (digits > most || std::abs(value) >= 1e7) return fmt::format("{:.4g}", value);
  std::string text = fmt::format("{:.{}f}", value, std::max(digits, 0));
  if (text.find_first_not_of("-0.") == std::string::npos) text = "0";
  return text;
}

std::string short_number_text(double value, double step) {
  std::string text = number_text(value, step);
  if (text.find('.') == std::string::npos || text.find('e') != std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string length_text(double length) {
  const double limit = length * (1 + rounding);
  if (limit >= 0.01 && limit < 1) return fmt::format("{:.4g} cm", 100 * length);
  const ReadableUnit unit = readable_unit(length, "m");
  if (limit >= 1e6) return fmt::format("{:.4g} km", length / 1000);
  return fmt::format("{:.4g} {}", length * unit.factor, unit.unit);
}

std::string distinct_text(double value, double apart) {
  constexpr int fewest = 4, most = 15;
  int digits = fewest;
  if (std::abs(value) > 0) {
    const int first = power_of_ten(std::abs(value)), last = apart > 0 ? std::min(power_of_ten(apart), 0) : 0;
    digits = std::clamp(first - last + 1, fewest, most);
  }
  return fmt::format("{:.{}g}", value, digits);
}

std::string quantity_text(double value, const std::string& unit, double apart) {
  const double size = std::abs(value);
  const bool plain = unit == "s" && size >= 0.01;
  const ReadableUnit scaled = plain ? ReadableUnit{1, unit} : readable_unit(size, unit);
  return distinct_text(value * scaled.factor, apart * scaled.factor) + " " + scaled.unit;
}

}  // namespace fascia::io
