#pragma once

#include "core/math/vec3.hpp"

#include <array>
#include <cstdio>
#include <string>

/// Numbers and places in messages.
namespace fascia::message {

inline std::string text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.4g", value);
  return buffer.data();
}

inline std::string text(const Vec3d& X) { return "(" + text(X[0]) + ", " + text(X[1]) + ", " + text(X[2]) + ")"; }

}  // namespace fascia::message
