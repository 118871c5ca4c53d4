#pragma once

#include "core/math/mat3.hpp"

/// One lane at a time of arrays in batches of eight (array of structures of arrays).
namespace fascia::gpu::kernels {

inline constexpr int kLanes = 8;

FASCIA_HD inline double row(const double* base, int r, int lane) { return base[r * kLanes + lane]; }

FASCIA_HD inline Mat3d matrix(const double* base, int first_row, int lane) {
  Mat3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = row(base, first_row + 3 * i + j, lane);
  return m;
}

FASCIA_HD inline void store_matrix(double* base, int first_row, int lane, const Mat3d& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) base[(first_row + 3 * i + j) * kLanes + lane] = m(i, j);
}

/// Rows: 11 22 33 23 13 12.
FASCIA_HD inline Mat3d symmetric_matrix(const double* base, int first_row, int lane) {
  const double a = row(base, first_row, lane), b = row(base, first_row + 1, lane), c = row(base, first_row + 2, lane);
  const double d = row(base, first_row + 3, lane), e = row(base, first_row + 4, lane),
               f = row(base, first_row + 5, lane);
  Mat3d m;
  m(0, 0) = a;
  m(1, 1) = b;
  m(2, 2) = c;
  m(1, 2) = m(2, 1) = d;
  m(0, 2) = m(2, 0) = e;
  m(0, 1) = m(1, 0) = f;
  return m;
}

FASCIA_HD inline void store_symmetric(double* base, int first_row, int lane, const Mat3d& m) {
  const double values[6] = {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)};
  for (int k = 0; k < 6; ++k) base[(first_row + k) * kLanes + lane] = values[k];
}

}  // namespace fascia::gpu::kernels
