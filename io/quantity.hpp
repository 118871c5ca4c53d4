#pragma once

#include <string>
#include <vector>

/// Numbers for people: scaled units, round steps, and how the fields of results are called.
namespace fascia::io {

/// A field of a result on a legend.
struct FieldName {
  std::string words;  ///< "von Mises stress"; of tensors and vectors with what is shown of them
  std::string unit;   ///< SI, as UDUNITS spells it: "Pa", "J/m3"; "1" for a pure number, empty where it is not known
  bool of_motion = false;  ///< follows from the displacement, without which it is zero; false where it is not known
};

/// How the fields that fascia writes are called; of others the name itself, without a unit.
FieldName name_of_field(const std::string& field);

/// A unit in which a number reads well: value · factor [unit].
struct ReadableUnit {
  double factor = 1;
  std::string unit;  ///< "kPa", "mm", "µm", "kJ/m³"; of pure numbers empty or a power of ten such as "1e-6"
};

/// @param largest  absolute value of the largest number shown, in SI; it becomes one from 1 to 1000
ReadableUnit readable_unit(double largest, const std::string& unit);

/// 1, 2 or 5 times a power of ten: the largest that is not above `limit`. @pre limit > 0
double round_below(double limit);

/// The multiples of a round step from low to high, about `count` of them. @pre low < high
struct Ticks {
  double step = 1;
  std::vector<double> values;
};
Ticks round_ticks(double low, double high, int count);

/// A number with the digits that tell it from one that differs by `step`.
std::string number_text(double value, double step);

/// The same without zeros at its end that tell nothing.
std::string short_number_text(double value, double step);

/// "5 cm", "200 µm", "1 km": kilometres, metres, centimetres, millimetres and smaller by thousands. @param length  [m]
std::string length_text(double length);

/// A number of four digits, or of as many as tell it from one that differs by `apart` (0: from none).
std::string distinct_text(double value, double apart);

/// The same with a scaled unit: "4 ms", "1.234 kHz". Seconds from 0.01 on stay seconds.
std::string quantity_text(double value, const std::string& unit, double apart = 0);

}  // namespace fascia::io
