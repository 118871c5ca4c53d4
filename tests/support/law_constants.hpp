#pragma once

#include "core/physics/law.hpp"

#include <vector>

namespace fascia::test {

/// Constants that a law has of its own, for tests of all laws: those of Mooney and Rivlin make μ.
inline std::vector<double> own_constants(Law law, double mu) {
  if (law != Law::mooney_rivlin) return {};
  return {0.3 * mu, 0.2 * mu, 0.1 * mu, -0.05 * mu, 0.07 * mu};
}

}  // namespace fascia::test
