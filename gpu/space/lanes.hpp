#pragma once

#include "core/math/mat3.hpp"

#include <type_traits>

/// One lane at a time of arrays in batches of eight (array of structures of arrays).
namespace fascia::gpu::kernels {

inline constexpr int kLanes = 8;

/// The nearest values of another scalar.
template <class T, class S>
FASCIA_HD constexpr Vec3<T> rounded(const Vec3<S>& a) {
  if constexpr (std::is_same_v<T, S>) return a;
  return {{static_cast<T>(a[0]), static_cast<T>(a[1]), static_cast<T>(a[2])}};
}
template <class T, class S>
FASCIA_HD constexpr Mat3<T> rounded(const Mat3<S>& a) {
  if constexpr (std::is_same_v<T, S>) return a;
  Mat3<T> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = static_cast<T>(a(i, j));
  return m;
}

template <class T>
FASCIA_HD T row(const T* base, int r, int lane) {
  return base[r * kLanes + lane];
}

template <class T>
FASCIA_HD Mat3<T> matrix(const T* base, int first_row, int lane) {
  Mat3<T> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = row(base, first_row + 3 * i + j, lane);
  return m;
}

template <class T, class S>
FASCIA_HD void store_matrix(T* base, int first_row, int lane, const Mat3<S>& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) base[(first_row + 3 * i + j) * kLanes + lane] = static_cast<T>(m(i, j));
}

/// Rows: 11 22 33 23 13 12.
template <class T>
FASCIA_HD Mat3<T> symmetric_matrix(const T* base, int first_row, int lane) {
  const T a = row(base, first_row, lane), b = row(base, first_row + 1, lane), c = row(base, first_row + 2, lane);
  const T d = row(base, first_row + 3, lane), e = row(base, first_row + 4, lane), f = row(base, first_row + 5, lane);
  Mat3<T> m;
  m(0, 0) = a;
  m(1, 1) = b;
  m(2, 2) = c;
  m(1, 2) = m(2, 1) = d;
  m(0, 2) = m(2, 0) = e;
  m(0, 1) = m(1, 0) = f;
  return m;
}

template <class T, class S>
FASCIA_HD void store_symmetric(T* base, int first_row, int lane, const Mat3<S>& m) {
  const S values[6] = {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)};
  for (int k = 0; k < 6; ++k) base[(first_row + k) * kLanes + lane] = static_cast<T>(values[k]);
}

}  // namespace fascia::gpu::kernels
