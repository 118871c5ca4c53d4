#pragma once

#include <stdexcept>

namespace fascia {

/// Thrown within a step that a program asks to stop.
struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped before its end, as it was asked to") {}
};

}  // namespace fascia
