#pragma once

#include "core/base/portability.hpp"

#include <cmath>

namespace fascia {

/// A vector of three components of any scalar: double, float, a SIMD batch, a dual number.
template <class T>
struct Vec3 {
  T v[3]{};

  FASCIA_HD constexpr T& operator[](int i) { return v[i]; }
  FASCIA_HD constexpr const T& operator[](int i) const { return v[i]; }

  FASCIA_HD constexpr Vec3& operator+=(const Vec3& b) {
    for (int i = 0; i < 3; ++i) v[i] += b.v[i];
    return *this;
  }
  FASCIA_HD constexpr Vec3& operator-=(const Vec3& b) {
    for (int i = 0; i < 3; ++i) v[i] -= b.v[i];
    return *this;
  }
  FASCIA_HD constexpr Vec3& operator*=(const T& s) {
    for (int i = 0; i < 3; ++i) v[i] *= s;
    return *this;
  }
  friend FASCIA_HD constexpr Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend FASCIA_HD constexpr Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend FASCIA_HD constexpr Vec3 operator*(Vec3 a, const T& s) { return a *= s; }
  friend FASCIA_HD constexpr Vec3 operator*(const T& s, Vec3 a) { return a *= s; }
  friend FASCIA_HD constexpr Vec3 operator-(const Vec3& a) { return Vec3{{-a.v[0], -a.v[1], -a.v[2]}}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

template <class T>
FASCIA_HD constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
FASCIA_HD constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

template <class T>
FASCIA_HD constexpr T squared_norm(const Vec3<T>& a) {
  return dot(a, a);
}

template <class T>
FASCIA_HD T norm(const Vec3<T>& a) {
  using std::sqrt;
  return sqrt(squared_norm(a));
}

/// a / |a|; a must not be zero.
template <class T>
FASCIA_HD Vec3<T> normalized(const Vec3<T>& a) {
  return a * (T(1) / norm(a));
}

using Vec3d = Vec3<double>;

}  // namespace fascia
