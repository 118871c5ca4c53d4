#pragma once

#include "core/base/portability.hpp"

#include <cmath>
#include <cstddef>

namespace fascia {

/// The register type of W doubles.
template <int W>
struct BatchRegister;
template <>
struct BatchRegister<2> {
  using Type = double __attribute__((vector_size(16)));
};
template <>
struct BatchRegister<4> {
  using Type = double __attribute__((vector_size(32)));
};
template <>
struct BatchRegister<8> {
  using Type = double __attribute__((vector_size(64)));
};

/// W doubles that are computed together (SIMD), as a scalar for Vec3 and Mat3.
template <int W>
struct Batch {
  using Register = typename BatchRegister<W>::Type;
  Register v{};

  Batch() = default;
  Batch(double s) : v(Register{} + s) {}  // NOLINT: a batch of equal numbers reads like the number
  static Batch of(const Register& r) {
    Batch b;
    b.v = r;
    return b;
  }

  static Batch load(const double* aligned) { return of(*reinterpret_cast<const Register*>(aligned)); }
  void store(double* aligned) const { *reinterpret_cast<Register*>(aligned) = v; }

  Batch& operator+=(const Batch& b) {
    v += b.v;
    return *this;
  }
  Batch& operator-=(const Batch& b) {
    v -= b.v;
    return *this;
  }
  Batch& operator*=(const Batch& b) {
    v *= b.v;
    return *this;
  }
  friend Batch operator+(const Batch& a, const Batch& b) { return of(a.v + b.v); }
  friend Batch operator-(const Batch& a, const Batch& b) { return of(a.v - b.v); }
  friend Batch operator*(const Batch& a, const Batch& b) { return of(a.v * b.v); }
  friend Batch operator/(const Batch& a, const Batch& b) { return of(a.v / b.v); }
  friend Batch operator-(const Batch& a) { return of(-a.v); }
};

/// Lane by lane: a where condition > 0, else b.
template <int W>
Batch<W> where_positive(const Batch<W>& condition, const Batch<W>& a, const Batch<W>& b) {
  return Batch<W>::of(condition.v > 0 ? a.v : b.v);
}

FASCIA_HD inline double where_positive(double condition, double a, double b) { return condition > 0 ? a : b; }
FASCIA_HD inline float where_positive(float condition, float a, float b) { return condition > 0 ? a : b; }

template <int W>
Batch<W> abs(const Batch<W>& a) {
  return where_positive(a, a, -a);
}

/// A function of doubles, lane by lane.
template <int W, class Function>
Batch<W> for_each(Batch<W> a, const Function& f) {
  for (int i = 0; i < W; ++i) a.v[i] = f(a.v[i]);
  return a;
}
template <class Function>
FASCIA_HD double for_each(double a, const Function& f) {
  return f(a);
}

template <int W>
Batch<W> log1p(const Batch<W>& a) {
  return for_each(a, [](double x) { return std::log1p(x); });
}

template <int W>
Batch<W> expm1(const Batch<W>& a) {
  return for_each(a, [](double x) { return std::expm1(x); });
}

template <int W>
Batch<W> cbrt(const Batch<W>& a) {
  return for_each(a, [](double x) { return std::cbrt(x); });
}

template <int W>
Batch<W> sqrt(const Batch<W>& a) {
  return for_each(a, [](double x) { return std::sqrt(x); });
}

/// The largest lane.
template <int W>
double largest(const Batch<W>& a) {
  double most = a.v[0];
  for (int i = 1; i < W; ++i) most = a.v[i] > most ? a.v[i] : most;
  return most;
}
FASCIA_HD inline double largest(double a) { return a; }

/// Sum over the lanes, always in the same order.
template <int W>
double lane_sum(const Batch<W>& a) {
  if constexpr (W == 2) {
    return a.v[0] + a.v[1];
  } else {
    Batch<W / 2> low, high;
    for (int i = 0; i < W / 2; ++i) {
      low.v[i] = a.v[i];
      high.v[i] = a.v[i + W / 2];
    }
    return lane_sum(low + high);
  }
}

#if defined(__AVX512F__)
inline constexpr int kBatchWidth = 8;
#elif defined(__AVX__)
inline constexpr int kBatchWidth = 4;
#else
inline constexpr int kBatchWidth = 2;
#endif

/// The batch that this processor computes fastest.
using Lanes = Batch<kBatchWidth>;

}  // namespace fascia
