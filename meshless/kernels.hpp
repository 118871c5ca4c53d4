#pragma once

/// Kernels W(r) of r = distance / support: positive below 1, 0 at 1. Each gives W and W'/r, which is finite at r = 0.
/// Their scale is free, since weights are normalised.
namespace fascia {

/// Wendland's C2 function, W = (1 − r)⁴ (1 + 4r).
struct WendlandC2Kernel {
  static constexpr double value(double r) {
    const double s = 1 - r;
    return s * s * s * s * (1 + 4 * r);
  }
  static constexpr double slope_over_radius(double r) {
    const double s = 1 - r;
    return -20 * s * s * s;
  }
};

/// Cubic spline, W = 2/3 − 4r² + 4r³ up to r = 1/2, 4/3 (1 − r)³ from there on.
struct CubicSplineKernel {
  static constexpr double value(double r) {
    const double s = 1 - r;
    return r <= 0.5 ? 2.0 / 3.0 - 4 * r * r * s : 4.0 / 3.0 * s * s * s;
  }
  static constexpr double slope_over_radius(double r) {
    const double s = 1 - r;
    return r <= 0.5 ? 12 * r - 8 : -4 * s * s / r;
  }
};

}  // namespace fascia
