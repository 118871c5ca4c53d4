#pragma once

#include <array>
#include <vector>

namespace fascia {

struct GaussPoint {
  double x = 0, weight = 0;  ///< on [0, 1]; the weights add up to 1
};

/// Gauss-Legendre rule of n points on [0, 1], exact for degree 2n − 1.
std::vector<GaussPoint> gauss_legendre(int n);

/// Four points of a tetrahedron in barycentric coordinates, equal weights, exact for degree 2.
inline constexpr std::array<std::array<double, 4>, 4> kTetrahedronPoints = [] {
  constexpr double a = 0.58541019662496852, b = 0.13819660112501048;
  return std::array<std::array<double, 4>, 4>{{{a, b, b, b}, {b, a, b, b}, {b, b, a, b}, {b, b, b, a}}};
}();

}  // namespace fascia
