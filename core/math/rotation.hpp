#pragma once

#include "core/math/mat3.hpp"

#include <algorithm>
#include <cmath>

/// Rotations are kept as D = Q − I: strains and increments then keep their relative accuracy however small they are.
namespace fascia {

/// exp([r]×) − I, accurate for small r.
///
/// @param r  rotation vector [rad]
FASCIA_HD inline Mat3d rotation_increment(const Vec3d& r) {
  const double angle = norm(r);
  const double half = 0.5 * angle;
  const double sinc = angle > 1e-8 ? std::sin(angle) / angle : 1.0 - angle * angle / 6.0;
  const double sinc_half = half > 1e-8 ? std::sin(half) / half : 1.0 - half * half / 6.0;
  const Mat3d W = skew(r);
  return W * sinc + (W * W) * (0.5 * sinc_half * sinc_half);
}

/// (I + A)(I + B) − I: applies the rotation I + A after I + B.
FASCIA_HD inline Mat3d compose_increments(const Mat3d& A, const Mat3d& B) { return A + B + A * B; }

/// Removes the drift of I + D from orthogonality, which rounding leaves; D's own accuracy is kept.
FASCIA_HD inline Mat3d orthonormalized_increment(const Mat3d& D) {
  const Mat3d C = D + transpose(D) + transpose_times(D, D);
  return D - (C + D * C) * 0.5;
}

/// Rotation of the polar decomposition of I + D, minus I: for blended rotations Σ w Q, which are not orthogonal.
FASCIA_HD inline Mat3d polar_increment(Mat3d D) {
  for (int i = 0; i < 100; ++i) {
    const Mat3d Q = Mat3d::identity() + D;
    const double det = determinant(Q);
    if (!(std::abs(det) > 1e-12)) return D;
    const Mat3d next = (Q + transpose(inverse(Q))) * 0.5 - Mat3d::identity();
    const Mat3d change = next - D;
    D = next;
    if (contract(change, change) < 1e-30) break;
  }
  return D;
}

/// Rotation vector of I + D, |r| ≤ π [rad].
FASCIA_HD inline Vec3d rotation_vector(const Mat3d& D) {
  const Vec3d s = axl(transpose(D)) * 0.5;  // sin(angle) · axis
  const double sine = norm(s);
  const double cosine_minus_one = 0.5 * trace(D);
  const double angle = std::atan2(sine, 1.0 + cosine_minus_one);
  if (sine > 1e-6) return s * (angle / sine);
  if (cosine_minus_one > -1.0) return s;  // small angle: angle / sine = 1 to rounding
  // Near π: the axis from the symmetric part, (D + I) ≈ 2 a aᵀ − I.
  const Mat3d symmetric = sym(D) + Mat3d::diagonal(2.0);
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (symmetric(i, i) > symmetric(k, k)) k = i;
  Vec3d axis = normalized(symmetric.column(k));
  if (dot(axis, s) < 0) axis = -axis;
  return axis * angle;
}

/// Rotation matrix about a unit axis by an angle [rad].
FASCIA_HD inline Mat3d rotation_about(const Vec3d& axis, double angle) {
  return Mat3d::identity() + rotation_increment(axis * angle);
}

/// Orthonormal rows whose first is along `first`.
FASCIA_HD inline Mat3d basis_from(const Vec3d& first) {
  const Vec3d a = normalized(first);
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(a[i]) < std::abs(a[k])) k = i;
  Vec3d e;
  e[k] = 1;
  const Vec3d b = normalized(cross(a, e));
  return transpose(Mat3d::from_columns(a, b, cross(a, b)));
}

}  // namespace fascia
