#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

/// Quantities such as "40 kPa", read by UDUNITS-2.
namespace fascia::app {

/// A text that is no quantity of the asked dimension: "what is wrong; what would be right".
struct UnitError {
  std::string message;
};

/// Units of one kind of quantity.
struct UnitExamples {
  const char *unit, *noun;  ///< the SI unit of bare numbers, "a length"
  const char* example;      ///< "5 mm"
  const char* others;       ///< further units that are understood, with spaces between them
};
/// Of all kinds that scenes know.
std::span<const UnitExamples> unit_examples();

/// Reads a number with a unit into SI.
///
/// @param text     for example "40 kPa", "-5 mm", "180 degree"
/// @param si_unit  the unit of the result: "m", "Pa", "N m", "rad", "1" for a pure number ...
/// @return the finite value in `si_unit`, or what is wrong with the text
/// @throws FileError  where the units database cannot be read
std::variant<double, UnitError> parse_quantity(std::string_view text, std::string_view si_unit);

/// "a length in m", "a pressure in Pa"; "a number" for "1".
std::string dimension_in_words(std::string_view si_unit);

}  // namespace fascia::app
