#pragma once

#include "core/math/batch.hpp"
#include "core/math/mat3.hpp"
#include "core/math/rotation.hpp"

#include <cmath>

namespace fascia {

/// Below this determinant F counts as nearly flat, and Newton's iteration is not used.
inline constexpr double kNearlyFlat = 0.05;

/// The rotation in I + H of positive determinant, minus I, by Newton's iteration (Higham 1986).
template <class T>
FASCIA_HD Mat3<T> polar_by_newton(const Mat3<T>& H) {
  const Mat3<T> I = Mat3<T>::identity();
  Mat3<T> D = H;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Mat3<T> Q = I + D;
    const Mat3<T> next = (Q + transpose(inverse(Q))) * T(0.5) - I;
    const Mat3<T> change = next - D;
    D = next;
    const T unsettled = contract(change, change) - T(1e-18);
    if (largest(where_positive(unsettled, T(1), T(0))) == 0) break;
  }
  const Mat3<T> C = D + transpose(D) + transpose_times(D, D);
  return D - (C + D * C) * T(0.5);
}

/// The rotation in F = I + H of any determinant, minus I: F V = U Σ by one-sided Jacobi rotations of columns, R = U Vᵀ.
/// V is proper, and so U is made: where F is turned inside out that turns the direction of its smallest singular value.
/// Among those that a singular F leaves open, it is a rotation that turns little.
FASCIA_HD inline Mat3d polar_by_jacobi(const Mat3d& H) {
  const Mat3d I = Mat3d::identity();
  Mat3d F = I + H;
  const double size = norm(F);
  if (size == 0) return {};
  F *= 1 / size;
  Vec3d b[3], v[3];  // columns of F V and of V
  for (int k = 0; k < 3; ++k) {
    b[k] = F.column(k);
    v[k] = I.column(k);
  }
  const auto turn = [](Vec3d& first, Vec3d& second, double c, double s) {
    const Vec3d old = first;
    first = old * c - second * s;
    second = old * s + second * c;
  };
  bool settled = false;
  for (int sweep = 0; sweep < 30 && !settled; ++sweep) {
    settled = true;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        const double pp = squared_norm(b[p]), qq = squared_norm(b[q]), pq = dot(b[p], b[q]);
        if (!(std::abs(pq) > 4e-16 * std::sqrt(pp * qq))) continue;
        settled = false;
        const double ratio = (qq - pp) / (2 * pq), size_of_ratio = std::abs(ratio);
        const double tangent = (ratio < 0 ? -1 : 1) / (size_of_ratio + std::sqrt(1 + size_of_ratio * size_of_ratio));
        const double c = 1 / std::sqrt(1 + tangent * tangent), s = c * tangent;
        turn(b[p], b[q], c, s);
        turn(v[p], v[q], c, s);
      }
  }
  // Largest first; a quarter turn in the place of an exchange.
  for (int exchange = 0; exchange < 3; ++exchange) {
    const int k = exchange % 2;
    if (squared_norm(b[k]) < squared_norm(b[k + 1])) {
      turn(b[k], b[k + 1], 0, -1);
      turn(v[k], v[k + 1], 0, -1);
    }
  }
  constexpr double kNothing = 1e-15;
  const Vec3d u = normalized(b[0]);
  Vec3d w = b[1] - u * dot(u, b[1]);
  if (norm(w) < kNothing) {
    const Vec3d one = v[1] - u * dot(u, v[1]), other = cross(v[2] - u * dot(u, v[2]), u);
    w = squared_norm(one) < squared_norm(other) ? other : one;
  }
  w = normalized(w);
  const Mat3d R = outer(u, v[0]) + outer(w, v[1]) + outer(cross(u, w), v[2]);
  return orthonormalized_increment(R - I);
}

/// The rotation R nearest to F = I + H, as R − I: that of the polar decomposition F = R U, proper also where F is
/// turned inside out (then U has a negative eigenvalue).
FASCIA_HD inline Mat3d nearest_rotation_increment(const Mat3d& H) {
  return determinant(Mat3d::identity() + H) > kNearlyFlat ? polar_by_newton(H) : polar_by_jacobi(H);
}

/// R − I of the rotations R nearest to a batch of I + H; lanes that are nearly flat or turned inside out go one by one.
template <int W>
Mat3<Batch<W>> nearest_rotation_increment(const Mat3<Batch<W>>& H) {
  using T = Batch<W>;
  const T regular = determinant(Mat3<T>::identity() + H) - T(kNearlyFlat);
  Mat3<T> D;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) D(i, j) = where_positive(regular, H(i, j), T(0));
  D = polar_by_newton(D);
  for (int lane = 0; lane < W; ++lane) {
    if (regular.v[lane] > 0) continue;
    Mat3d single;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) single(i, j) = H(i, j).v[lane];
    single = polar_by_jacobi(single);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) D(i, j).v[lane] = single(i, j);
  }
  return D;
}

}  // namespace fascia
