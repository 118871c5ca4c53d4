#pragma once

#include "core/math/mat3.hpp"

#include <cmath>

namespace fascia {

/// Equivalent stress √(3/2 s:s), s the deviator of a symmetric stress [Pa].
FASCIA_HD inline double von_mises(const Mat3d& s) {
  const double a = s(0, 0) - s(1, 1), b = s(1, 1) - s(2, 2), c = s(2, 2) - s(0, 0);
  const double shear = s(0, 1) * s(0, 1) + s(1, 2) * s(1, 2) + s(0, 2) * s(0, 2);
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
}

}  // namespace fascia
