#pragma once

#include "core/math/mat3.hpp"

#include <memory>

namespace fascia {

/// A stress that muscle makes by itself, along its fibres a at rest, beside that of any law:
///
///   S_a = s(t) σ a aᵀ   [Pa], second Piola-Kirchhoff,
///
/// with the factor s of a schedule. It does not depend on the strain, so that s σ a·Ea is its potential (Holzapfel
/// 2000, section 6.8, adds such terms to a law's).
struct ActiveStress {
  Mat3d S{};          ///< at a factor of 1 [Pa]
  int schedule = -1;  ///< index into the factors of loads

  static ActiveStress along(const Vec3d& fibres, double stress, int schedule) {
    return {outer(fibres, fibres) * stress, schedule};
  }
};

/// Two points act by one schedule, along whatever fibres, or neither does.
inline bool act_alike(const std::shared_ptr<const ActiveStress>& a, const std::shared_ptr<const ActiveStress>& b) {
  return a == b || (a && b && a->schedule == b->schedule);
}

}  // namespace fascia
