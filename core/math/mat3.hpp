#pragma once

#include "core/math/vec3.hpp"

namespace fascia {

/// A 3×3 matrix, stored by rows, of any scalar: double, float, a SIMD batch, a dual number.
template <class T>
struct Mat3 {
  T m[3][3]{};

  FASCIA_HD constexpr T& operator()(int i, int j) { return m[i][j]; }
  FASCIA_HD constexpr const T& operator()(int i, int j) const { return m[i][j]; }
  FASCIA_HD constexpr Vec3<T> row(int i) const { return {{m[i][0], m[i][1], m[i][2]}}; }
  FASCIA_HD constexpr Vec3<T> column(int j) const { return {{m[0][j], m[1][j], m[2][j]}}; }

  FASCIA_HD static constexpr Mat3 identity() { return diagonal(T(1)); }
  FASCIA_HD static constexpr Mat3 diagonal(const T& s) {
    Mat3 r;
    for (int i = 0; i < 3; ++i) r.m[i][i] = s;
    return r;
  }
  FASCIA_HD static constexpr Mat3 from_columns(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    Mat3 r;
    for (int i = 0; i < 3; ++i) {
      r.m[i][0] = a[i];
      r.m[i][1] = b[i];
      r.m[i][2] = c[i];
    }
    return r;
  }

  FASCIA_HD constexpr Mat3& operator+=(const Mat3& b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] += b.m[i][j];
    return *this;
  }
  FASCIA_HD constexpr Mat3& operator-=(const Mat3& b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] -= b.m[i][j];
    return *this;
  }
  FASCIA_HD constexpr Mat3& operator*=(const T& s) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] *= s;
    return *this;
  }
  friend FASCIA_HD constexpr Mat3 operator+(Mat3 a, const Mat3& b) { return a += b; }
  friend FASCIA_HD constexpr Mat3 operator-(Mat3 a, const Mat3& b) { return a -= b; }
  friend FASCIA_HD constexpr Mat3 operator*(Mat3 a, const T& s) { return a *= s; }
  friend FASCIA_HD constexpr Mat3 operator*(const T& s, Mat3 a) { return a *= s; }
  friend constexpr bool operator==(const Mat3&, const Mat3&) = default;

  friend FASCIA_HD constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    Mat3 r;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
    return r;
  }
  friend FASCIA_HD constexpr Vec3<T> operator*(const Mat3& a, const Vec3<T>& x) {
    return {{dot(a.row(0), x), dot(a.row(1), x), dot(a.row(2), x)}};
  }
};

template <class T>
FASCIA_HD constexpr Mat3<T> transpose(const Mat3<T>& a) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(j, i);
  return r;
}

/// Aᵀ B
template <class T>
FASCIA_HD constexpr Mat3<T> transpose_times(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(0, i) * b(0, j) + a(1, i) * b(1, j) + a(2, i) * b(2, j);
  return r;
}

/// A Bᵀ
template <class T>
FASCIA_HD constexpr Mat3<T> times_transpose(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = dot(a.row(i), b.row(j));
  return r;
}

/// a bᵀ
template <class T>
FASCIA_HD constexpr Mat3<T> outer(const Vec3<T>& a, const Vec3<T>& b) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a[i] * b[j];
  return r;
}

/// (A + Aᵀ) / 2
template <class T>
FASCIA_HD constexpr Mat3<T> sym(const Mat3<T>& a) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = T(0.5) * (a(i, j) + a(j, i));
  return r;
}

template <class T>
FASCIA_HD constexpr T trace(const Mat3<T>& a) {
  return a(0, 0) + a(1, 1) + a(2, 2);
}

/// A : B = Σ A_ij B_ij
template <class T>
FASCIA_HD constexpr T contract(const Mat3<T>& a, const Mat3<T>& b) {
  return dot(a.row(0), b.row(0)) + dot(a.row(1), b.row(1)) + dot(a.row(2), b.row(2));
}

/// Frobenius norm.
template <class T>
FASCIA_HD T norm(const Mat3<T>& a) {
  using std::sqrt;
  return sqrt(contract(a, a));
}

template <class T>
FASCIA_HD constexpr T determinant(const Mat3<T>& a) {
  return dot(a.row(0), cross(a.row(1), a.row(2)));
}

/// [a]×, the matrix with [a]× b = a × b
template <class T>
FASCIA_HD constexpr Mat3<T> skew(const Vec3<T>& a) {
  Mat3<T> r;
  r(0, 1) = -a[2];
  r(0, 2) = a[1];
  r(1, 0) = a[2];
  r(1, 2) = -a[0];
  r(2, 0) = -a[1];
  r(2, 1) = a[0];
  return r;
}

/// axl(M)_k = ε_kab M_ab = (M23 − M32, M31 − M13, M12 − M21); for a force f with lever a, axl(a fᵀ) = a × f.
template <class T>
FASCIA_HD constexpr Vec3<T> axl(const Mat3<T>& m) {
  return {{m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0)}};
}

/// Inverse by cofactors; the determinant must not be zero.
template <class T>
FASCIA_HD constexpr Mat3<T> inverse(const Mat3<T>& a) {
  const Vec3<T> c0 = cross(a.row(1), a.row(2)), c1 = cross(a.row(2), a.row(0)), c2 = cross(a.row(0), a.row(1));
  return Mat3<T>::from_columns(c0, c1, c2) * (T(1) / dot(a.row(0), c0));
}

using Mat3d = Mat3<double>;

}  // namespace fascia
