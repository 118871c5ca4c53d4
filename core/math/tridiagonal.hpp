#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace fascia {

/// Largest eigenvalue of a symmetric tridiagonal matrix, by bisection on the signs of its pivots.
/// @param off  entries beside the diagonal, one fewer
inline double largest_eigenvalue(std::span<const double> diagonal, std::span<const double> off) {
  double low = diagonal[0], high = diagonal[0];
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    const double beside = (i > 0 ? off[i - 1] : 0.0) + (i + 1 < diagonal.size() ? off[i] : 0.0);
    low = std::max(low, diagonal[i]);
    high = std::max(high, diagonal[i] + beside);
  }
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    bool above = true;  // of every eigenvalue
    double pivot = 1;
    for (std::size_t i = 0; i < diagonal.size() && above; ++i) {
      pivot = middle - diagonal[i] - (i > 0 ? off[i - 1] * off[i - 1] / pivot : 0.0);
      above = pivot > 0;
    }
    if (middle <= low || middle >= high) break;
    (above ? high : low) = middle;
  }
  return high;
}

/// Its eigenvector, of length 1. Below the largest eigenvalue all pivots are positive, so that the entries grow from
/// one another without cancellation.
inline std::vector<double> largest_eigenvector(std::span<const double> diagonal, std::span<const double> off,
                                               double value) {
  std::vector<double> s(diagonal.size(), 1.0);
  double pivot = 1, squares = 1;
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    pivot = value - diagonal[i] - (i > 0 ? off[i - 1] * off[i - 1] / pivot : 0.0);
    s[i + 1] = s[i] * pivot / off[i];
    squares += s[i + 1] * s[i + 1];
  }
  for (double& entry : s) entry /= std::sqrt(squares);
  return s;
}

}  // namespace fascia
