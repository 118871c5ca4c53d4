#pragma once

#include <chrono>
#include <ctime>

namespace fascia {

/// The clock that times are measured with.
using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Processor time of this process so far, of all its threads [s]: other programs do not add to it.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace fascia
