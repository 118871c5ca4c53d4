#include "app/scene/units.hpp"

#include "app/schema/schema.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <sstream>

namespace fascia::app::units_test {
namespace {

constexpr double pi = std::numbers::pi;

double si(std::string_view text, std::string_view unit) {
  const auto result = parse_quantity(text, unit);
  if (const auto* error = std::get_if<UnitError>(&result)) ADD_FAILURE() << error->message;
  return std::holds_alternative<double>(result) ? std::get<double>(result) : -1;
}

std::string error(std::string_view text, std::string_view unit) {
  const auto result = parse_quantity(text, unit);
  return std::holds_alternative<UnitError>(result) ? std::get<UnitError>(result).message : "no error";
}

TEST(Units, ReadsQuantities) {
  EXPECT_DOUBLE_EQ(si("40 kPa", "Pa"), 4e4);
  EXPECT_DOUBLE_EQ(si("-5 mm", "m"), -5e-3);
  EXPECT_DOUBLE_EQ(si("+5mm", "m"), 5e-3);
  EXPECT_DOUBLE_EQ(si("  1.5e-1  s ", "s"), 0.15);
  EXPECT_DOUBLE_EQ(si("0 mm", "m"), 0);
  EXPECT_DOUBLE_EQ(si("1 µm", "m"), 1e-6);
  EXPECT_DOUBLE_EQ(si("1 min", "s"), 60);
}

TEST(Units, ExamplesAreUnderstood) {
  for (const UnitExamples& u : unit_examples()) {
    EXPECT_GT(si(u.example, u.unit), 0) << u.example;
    std::istringstream others(u.others);
    for (std::string unit; others >> unit;) EXPECT_GT(si("1 " + unit, u.unit), 0) << unit;
  }
}

TEST(Units, ReadsComposedUnits) {
  EXPECT_DOUBLE_EQ(si("2 N.m", "N m"), 2);
  EXPECT_DOUBLE_EQ(si("2 N mm", "N m"), 2e-3);
  EXPECT_DOUBLE_EQ(si("1 g/cm^3", "kg/m3"), 1000);
  EXPECT_DOUBLE_EQ(si("1 g cm-3", "kg/m3"), 1000);
  EXPECT_DOUBLE_EQ(si("5 mm/s", "m/s"), 5e-3);
  EXPECT_DOUBLE_EQ(si("2 1/s", "1/s"), 2);
  EXPECT_DOUBLE_EQ(si("2 Hz", "1/s"), 2);
  EXPECT_DOUBLE_EQ(si("30 %", "1"), 0.3);
}

TEST(Units, ReadsAngles) {
  EXPECT_DOUBLE_EQ(si("180 degree", "rad"), pi);
  EXPECT_DOUBLE_EQ(si("180 degrees", "rad"), pi);
  EXPECT_DOUBLE_EQ(si("180 deg", "rad"), pi);
  EXPECT_DOUBLE_EQ(si("180°", "rad"), pi);
  EXPECT_DOUBLE_EQ(si("2 turn", "rad"), 4 * pi);
  EXPECT_DOUBLE_EQ(si("180 degree/s", "rad/s"), pi);
}

TEST(Units, WrongDimensionNamesBoth) {
  EXPECT_EQ(error("5 kg", "m"), "\"5 kg\" is a mass; must be a length in m, such as \"5 mm\"");
  EXPECT_EQ(error("5 mm", "Pa"), "\"5 mm\" is a length; must be a pressure in Pa, such as \"40 kPa\"");
  EXPECT_EQ(error("5 mm", "1"), "\"5 mm\" is a length; must be a number");
  EXPECT_EQ(error("5 mol", "m"), "\"5 mol\" is in mol; must be a length in m, such as \"5 mm\"");
}

TEST(Units, ReciprocalIsNotTheSame) {
  EXPECT_EQ(error("100 Hz", "s"), "\"100 Hz\" is a rate; must be a time in s, such as \"10 ms\"");
}

TEST(Units, AnglesAreNoPureNumbers) {
  EXPECT_EQ(error("5 %", "rad"), "\"5 %\" is a pure number; must be an angle in rad, such as \"90 degree\"");
  EXPECT_EQ(error("5 rad", "1"), "\"5 rad\" is an angle; must be a number");
}

TEST(Units, BareNumberHasNoUnit) {
  EXPECT_EQ(error("5", "m"), "\"5\" has no unit; write 5 (SI) or, with a unit, \"5 mm\"");
  EXPECT_EQ(error("0.3", "1"), "\"0.3\" has no unit; write 0.3");
  EXPECT_EQ(error(".3", "1"), "\".3\" has no unit; write 0.3");
}

TEST(Units, UnknownUnitsAndGarbage) {
  EXPECT_EQ(error("5 parsnips", "m"), "\"parsnips\" is no known unit; must be a length in m, such as \"5 mm\"");
  EXPECT_EQ(error("soft", "Pa"), "\"soft\" is no number with a unit; must be a pressure in Pa, such as \"40 kPa\"");
  EXPECT_EQ(error("", "m"), "\"\" is no number with a unit; must be a length in m, such as \"5 mm\"");
  for (const char* text :
       {"nan m", "inf m", "1e999 m", "5 6 mm", "5 -mm", "5 s since 2000-01-01", "5 dB", "5 m^", "5 ((((", "m", "\n"})
    EXPECT_NE(error(text, "m"), "no error") << text;
}

TEST(Units, OverflowIsAnError) {
  EXPECT_EQ(error("1e308 km", "m"), "\"1e308 km\" is too large; must be a length in m, such as \"5 mm\"");
}

void collect_units(const Shape& shape, std::set<std::string>& units) {
  if (shape.type == Type::number) units.insert(shape.unit);
  for (const Shape& item : shape.items) collect_units(item, units);
  for (const Key& k : shape.keys) collect_units(k.shape, units);
}

TEST(Units, KnowEveryUnitOfTheSchema) {
  std::set<std::string> units;
  collect_units(scene_schema(), units);
  collect_units(region_schema(), units);
  for (const std::string& unit : units) {
    if (unit == "1") continue;
    EXPECT_DOUBLE_EQ(si("2 " + unit, unit), 2) << unit;
    EXPECT_EQ(dimension_in_words(unit).find("a quantity"), std::string::npos) << unit;
  }
}

}  // namespace
}  // namespace fascia::app::units_test
