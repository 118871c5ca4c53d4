#pragma once

#include "core/body/model_body.hpp"
#include "core/math/vec3.hpp"

#include <string>

/// Numbers with the units that people use for their size, for messages.
namespace fascia {

/// "3.2 um", "12 mm", "16 cm", "2.1 m", "1.2 km"
std::string length_text(double metres);
/// "160 x 120 x 90 mm": all in the unit of the largest.
std::string box_text(const Vec3d& metres);
/// A body in the units that people use: "16 x 10 x 8 cm, 1.26 l, 1.33 kg".
std::string body_text(const ModelBody& body);
/// "3 mg", "12 g", "1.6 kg", "38 t"
std::string mass_text(double kilograms);
/// "3 mm3", "12 cm3", "1.5 l", "38 m3"
std::string volume_text(double cubic_metres);
/// "5 Pa", "40 kPa", "1.2 MPa", "210 GPa"
std::string pressure_text(double pascals);
/// "3 us", "20 ms", "1.5 s", "10 min", "2 h"
std::string time_text(double seconds);

}  // namespace fascia
