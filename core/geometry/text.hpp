#pragma once

#include "core/math/vec3.hpp"

#include <sstream>
#include <string>

/// Numbers and places in messages.
namespace fascia::message {

inline std::string text(double value) {
  std::ostringstream out;
  out.precision(4);
  out << value;
  return out.str();
}

inline std::string text(const Vec3d& X) { return "(" + text(X[0]) + ", " + text(X[1]) + ", " + text(X[2]) + ")"; }

}  // namespace fascia::message
