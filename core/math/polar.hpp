#pragma once

#include "core/math/batch.hpp"
#include "core/math/mat3.hpp"
#include "core/math/rotation.hpp"

namespace fascia {

/// The rotation R nearest to F = I + H, as R − I: that of the polar decomposition F = R U, proper also where F is
/// turned inside out (then U has a negative eigenvalue).
Mat3d nearest_rotation_increment(const Mat3d& H);

/// The same for a batch: Newton's iteration (Higham 1986), lanes that are nearly flat or turned inside out one by one.
template <int W>
Mat3<Batch<W>> nearest_rotation_increment(const Mat3<Batch<W>>& H) {
  using T = Batch<W>;
  constexpr double kFlat = 0.05;
  const Mat3<T> I = Mat3<T>::identity();
  const T regular = determinant(I + H) - T(kFlat);
  Mat3<T> D;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) D(i, j) = where_positive(regular, H(i, j), T(0));
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Mat3<T> Q = I + D;
    const Mat3<T> next = (Q + transpose(inverse(Q))) * T(0.5) - I;
    const Mat3<T> change = next - D;
    const T squares = contract(change, change);
    D = next;
    bool settled = true;
    for (int lane = 0; lane < W; ++lane) settled = settled && !(squares.v[lane] > 1e-18);
    if (settled) break;
  }
  const Mat3<T> C = D + transpose(D) + transpose_times(D, D);
  D -= (C + D * C) * T(0.5);
  for (int lane = 0; lane < W; ++lane) {
    if (regular.v[lane] > 0) continue;
    Mat3d single;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) single(i, j) = H(i, j).v[lane];
    single = nearest_rotation_increment(single);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) D(i, j).v[lane] = single(i, j);
  }
  return D;
}

}  // namespace fascia
