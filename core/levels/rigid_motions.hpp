#pragma once

#include "core/base/index.hpp"
#include "core/levels/block_rows.hpp"
#include "core/math/mat3.hpp"

#include <algorithm>
#include <array>
#include <cmath>

/// Rigid motions of aggregates.
namespace fascia {

/// A rigid motion about x_A of a node at x: columns U and Θ, rows by degrees of freedom in the axes of the world.
inline void rigid_motion(int size, const Vec3d& arm, const Mat3d& Q, double* T) {
  std::fill(T, T + size * kFrameDofs, 0.0);
  const auto entry = [&](int row, int column) -> double& { return T[kFrameDofs * row + column]; };
  for (int k = 0; k < 3; ++k) entry(k, k) = 1;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    const Vec3d u = cross(axis, arm);
    for (int i = 0; i < 3; ++i) entry(i, 3 + k) = u[i];
    if (size == 6) entry(3 + k, 3 + k) = 1;
    if (size != 12) continue;
    const Mat3d dA = skew(axis) * Q;
    for (int q = 0; q < 3; ++q)
      for (int i = 0; i < 3; ++i) entry(3 + 3 * q + i, 3 + k) = dA(i, q);
  }
}

/// Bit k: the motion k is a combination of those before it. @param G  6 × 6, products of motions; becomes L of L Lᵀ
inline unsigned dependent_motions(std::array<double, 36>& G) {
  constexpr double kIndependent = 1e-8;  // squared sine of the angle between a rigid motion and those before it
  unsigned found = 0;
  for (int j = 0; j < kFrameDofs; ++j) {
    const double whole = G[at(7 * j)];
    double pivot = whole;
    for (int k = 0; k < j; ++k) pivot -= G[at(6 * j + k)] * G[at(6 * j + k)];
    const bool dead = !(pivot > kIndependent * whole);
    if (dead) found |= 1U << j;
    for (int i = j + 1; i < kFrameDofs; ++i) {
      double sum = G[at(6 * i + j)];
      for (int k = 0; k < j; ++k) sum -= G[at(6 * i + k)] * G[at(6 * j + k)];
      G[at(6 * i + j)] = dead ? 0 : sum / std::sqrt(pivot);
    }
  }
  return found;
}

}  // namespace fascia
