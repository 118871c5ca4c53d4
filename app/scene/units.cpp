#include "app/scene/units.hpp"

#include "app/scene/diagnostics.hpp"
#include "app/scene/trimmed.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>

namespace fascia::app {
namespace {

using Dimension = UnitExamples;

/// Units of SI that scenes use, the kind of quantity, a sample with another unit, and further units.
constexpr std::array<Dimension, 23> dimensions{{
    {"m", "a length", "5 mm", "um cm mm km inch foot"},
    {"s", "a time", "10 ms", "us ms min h day"},
    {"kg", "a mass", "200 g", "mg g t lb"},
    {"rad", "an angle", "90 degree", "deg degree mrad turn"},
    {"Pa", "a pressure", "40 kPa", "kPa MPa GPa bar mbar mmHg N/mm2 psi"},
    {"N", "a force", "5 mN", "mN kN kgf dyne"},
    {"N m", "a torque", "3 N mm", "mN.m kN.m J"},
    {"m/s", "a velocity", "5 mm/s", "mm/s cm/s km/h"},
    {"m/s2", "an acceleration", "981 cm/s2", "mm/s2 cm/s2 gal"},
    {"1/s", "a rate", "2 Hz", "Hz kHz 1/min 1/h"},
    {"rad/s", "an angular velocity", "10 degree/s", "degree/s rpm"},
    {"kg/m3", "a density", "1 g/cm3", "g/cm3 kg/l g/ml"},
    {"N/m", "a force per length", "5 N/mm", "N/mm mN/mm kN/m"},
    {"m2", "an area", "4 cm2", "mm2 cm2"},
    {"m3", "a volume", "1 l", "mm3 cm3 ml l"},
    {"Pa s", "a viscosity", "1 mPa s", "mPa.s poise"},
    {"kg m2", "a moment of inertia", "5 g cm2", "g.cm2 kg.mm2"},
    {"W", "a power", "5 mW", "mW kW"},
    {"kg m/s", "a momentum", "5 N s", "N.s g.m/s"},
    {"1/m", "a curvature", "2 1/mm", "1/mm 1/cm"},
    {"K", "a temperature", "300 K", "mK"},
    {"A", "an electric current", "5 mA", "mA"},
    {"byte", "an amount of memory", "1 GB", "kB MB GB MiB GiB"},
}};

constexpr std::array<std::array<const char*, 2>, 7> memory_units{{{"kB", "1e3 byte"},
                                                                  {"MB", "1e6 byte"},
                                                                  {"GB", "1e9 byte"},
                                                                  {"TB", "1e12 byte"},
                                                                  {"KiB", "1024 byte"},
                                                                  {"MiB", "1048576 byte"},
                                                                  {"GiB", "1073741824 byte"}}};

const Dimension* find_dimension(std::string_view unit) {
  for (const Dimension& d : dimensions)
    if (unit == d.unit) return &d;
  return nullptr;
}

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;

/// UDUNITS' database. Its parser keeps global state, hence the lock.
class Database {
 public:
  static Database& instance() {
    static Database database;
    return database;
  }

  std::mutex mutex;

  Unit parse(const std::string& text) const { return Unit(ut_parse(system_.get(), text.c_str(), UT_UTF8)); }

 private:
  Database() {
    ut_set_error_message_handler(ut_ignore);
    system_.reset(ut_read_xml(nullptr));
    if (!system_) throw FileError("cannot read the units database of UDUNITS-2 (package libudunits2-data)");
    const auto name = [&](const char* shorter, const char* definition) {
      if (const Unit unit = parse(definition)) ut_map_name_to_unit(shorter, UT_ASCII, unit.get());
    };
    name("deg", "degree");
    for (const auto& [shorter, definition] : memory_units) name(shorter, definition);
  }

  struct FreeSystem {
    void operator()(ut_system* system) const { ut_free_system(system); }
  };
  std::unique_ptr<ut_system, FreeSystem> system_;
};

/// In base units, for example "0.001 kg"; empty where that is impossible.
std::string definition(const Unit& unit) {
  std::array<char, 160> text{};
  const int length = ut_format(unit.get(), text.data(), text.size(), UT_ASCII | UT_DEFINITION);
  return length < 0 || length >= static_cast<int>(text.size()) ? "" : std::string(text.data());
}

bool is_angle(const Unit& unit) {
  const std::string text = definition(unit);
  return text == "rad" || text.ends_with(" rad");
}

/// Not by ut_are_convertible: to it, seconds and hertz are the same.
bool same_dimension(const Unit& unit, const Unit& expected) {
  if (ut_is_dimensionless(expected.get()))
    return ut_is_dimensionless(unit.get()) && is_angle(unit) == is_angle(expected);
  const Unit ratio(ut_divide(unit.get(), expected.get()));
  return ratio && ut_is_dimensionless(ratio.get()) != 0;
}

/// The kind of quantity of a unit: "a mass", or its base units. To the database bytes are pure numbers.
std::string kind_of(const Database& database, const Unit& unit) {
  for (const Dimension& d : dimensions)
    if (std::string_view(d.unit) != "byte" && same_dimension(unit, database.parse(d.unit))) return d.noun;
  return ut_is_dimensionless(unit.get()) ? "a pure number" : "in " + definition(unit);
}

std::string wanted(std::string_view si_unit) {
  const Dimension* d = find_dimension(si_unit);
  if (!d) return fmt::format("must be {}", dimension_in_words(si_unit));
  return fmt::format("must be {}, such as \"{}\"", dimension_in_words(si_unit), d->example);
}

struct Split {
  double number;
  std::string_view unit;
};

/// "-5 mm" → −5 and "mm"; nothing where the text does not start with a finite number.
std::optional<Split> split(std::string_view text) {
  text = trimmed(text);
  const std::size_t sign = text.starts_with('+') && !text.starts_with("+-") ? 1 : 0;
  double number = 0;
  const char* begin = text.data() + sign;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
  if (error != std::errc{} || !std::isfinite(number)) return std::nullopt;
  const auto length = static_cast<std::size_t>(end - text.data());
  return Split{number, trimmed(text.substr(length))};
}

Unit parse_unit(const Database& database, std::string_view text) {
  const bool second_number = text.find_first_of("0123456789.+-") == 0 && !text.starts_with("1/");
  if (second_number || text.size() > 64) return nullptr;
  Unit unit = database.parse(std::string(text));
  const bool is_date = unit && definition(unit).find('@') != std::string::npos;
  return is_date ? nullptr : std::move(unit);
}

std::optional<double> convert(double number, const Unit& from, const Unit& to) {
  cv_converter* converter = ut_get_converter(from.get(), to.get());
  if (!converter) return std::nullopt;
  const double value = cv_convert_double(converter, number);
  cv_free(converter);
  return value;
}

}  // namespace

std::span<const UnitExamples> unit_examples() { return dimensions; }

std::string dimension_in_words(std::string_view si_unit) {
  if (si_unit == "1") return "a number";
  const Dimension* d = find_dimension(si_unit);
  return fmt::format("{} in {}", d ? d->noun : "a quantity", si_unit);
}

std::variant<double, UnitError> parse_quantity(std::string_view text, std::string_view si_unit) {
  const std::string shown = in_quotes(text);
  const std::optional<Split> parts = split(text);
  if (!parts) return UnitError{fmt::format("{} is no number with a unit; {}", shown, wanted(si_unit))};
  if (parts->unit.empty()) {
    const Dimension* d = find_dimension(si_unit);
    const std::string example = d ? fmt::format(" (SI) or, with a unit, \"{}\"", d->example) : "";
    return UnitError{fmt::format("{} has no unit; write {}{}", shown, parts->number, example)};
  }
  Database& database = Database::instance();
  const std::lock_guard lock(database.mutex);
  const Unit unit = parse_unit(database, parts->unit);
  if (!unit) return UnitError{fmt::format("{} is no known unit; {}", in_quotes(parts->unit), wanted(si_unit))};
  const Unit expected = database.parse(std::string(si_unit));
  if (!same_dimension(unit, expected))
    return UnitError{fmt::format("{} is {}; {}", shown, kind_of(database, unit), wanted(si_unit))};
  const std::optional<double> value = convert(parts->number, unit, expected);
  if (!value || !std::isfinite(*value)) return UnitError{fmt::format("{} is too large; {}", shown, wanted(si_unit))};
  return *value;
}

}  // namespace fascia::app
