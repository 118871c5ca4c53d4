#pragma once

#include "app/scene/document.hpp"
#include "app/schema/schema.hpp"

#include <functional>
#include <optional>
#include <string_view>

/// A scene in other units: every number by its dimension, so that the run must end the same.
namespace fascia::app {

/// Factors of all masses, lengths and times of a scene.
struct UnitFactors {
  double mass = 1, length = 1, time = 1;

  /// mass^a length^b time^c, where a, b and c are the dimension of a unit.
  /// @param si_unit  as the schema spells it: "kg/m3", "N m", "1"
  /// @throws std::invalid_argument  a symbol that no key of a scene has
  double of(std::string_view si_unit) const;
};

/// The number that a value is, as a double; none where it is no number.
std::optional<double> number_in(const Value& value);

/// Multiplies numbers of a document by what `factor` says of their unit and of the path of their key,
/// "bodies.liver.density". Texts with a unit become numbers in SI.
/// @param shape  the schema of the value
void scale_numbers(Value& value, const Shape& shape,
                   const std::function<double(std::string_view si_unit, std::string_view path)>& factor);

/// The scene in other units. @return false, and nothing is changed, where files give frames, points or motions, or a
/// need of times of this machine is stated: their numbers cannot be reached
bool change_units(Value& scene, const UnitFactors& factors);

}  // namespace fascia::app
