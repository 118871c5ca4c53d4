#include "meshless/gauss.hpp"

#include <cmath>
#include <numbers>

namespace fascia {

std::vector<GaussPoint> gauss_legendre(int n) {
  std::vector<GaussPoint> points;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (n - i - 0.25) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 20; ++iteration) {
      double p = 1, previous = 0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * previous) / k;
        previous = p;
        p = next;
      }
      slope = n * (x * p - previous) / (x * x - 1);
      x -= p / slope;
    }
    points.push_back({0.5 * (x + 1), 1 / ((1 - x * x) * slope * slope)});
  }
  return points;
}

}  // namespace fascia
