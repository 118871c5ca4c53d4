#pragma once

#include <cstddef>
#include <span>

namespace fascia {

/// Moves the numbers [begin, end) along: x += s p, r −= s q.
inline void advance_range(double s, std::span<const double> p, std::span<const double> q, std::span<double> x,
                          std::span<double> r, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    x[i] += s * p[i];
    r[i] -= s * q[i];
  }
}

}  // namespace fascia
