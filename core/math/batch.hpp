#pragma once

#include "core/base/portability.hpp"

#include <bit>
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
  /// Less zero is the number itself, −0 too, so that no instruction is spent on it; plus zero is not.
  Batch(double s) : v(s - Register{}) {}  // NOLINT: a batch of equal numbers reads like the number
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

/// ln(1 + a) to 2 ulp, of lanes together: 1 + a = 2ᵏ m with m between √½ and √2, ln m = 2 artanh((m − 1)/(m + 1)),
/// whose series is cut where it is below rounding; what rounding takes from 1 + a is added to first order. Not a number
/// where a is below −1.
template <int W>
Batch<W> log1p(const Batch<W>& a) {
  using Register = typename Batch<W>::Register;
  using Bits = decltype(Register{} < Register{});
  constexpr long long kRootHalf = 0x3fe6a09e667f3bcd, kMantissa = 0x000fffffffffffff;
  constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33, kHuge = 1e300;
  for (int i = 0; i < W; ++i)
    if (!(a.v[i] > -1 && a.v[i] < kHuge)) return for_each(a, [](double x) { return std::log1p(x); });
  const Register sum = a.v + 1.0;
  const Bits shifted = std::bit_cast<Bits>(sum) - kRootHalf;   // its exponent is k
  const Bits exponent = shifted >> 52, whole = exponent == 0;  // 1 + a is between √½ and √2 itself
  const Bits mantissa = (shifted & kMantissa) + kRootHalf;
  const Register lost = (sum > 2.0 ? 1.0 - (sum - a.v) : a.v - (sum - 1.0)) / sum;
  const Register f = whole ? a.v : std::bit_cast<Register>(mantissa) - 1.0;
  const Register k = __builtin_convertvector(exponent, Register);
  const Register s = f / (f + 2.0), z = s * s;
  Register series = Register{} + 2.0 / 21;
  for (int n = 19; n >= 3; n -= 2) series = series * z + 2.0 / n;
  // ln(1 + f) = f − f s + s z series: f is exact, and the rest is small beside it.
  const Register small = k * kLn2Low + (whole ? Register{} : lost);
  return Batch<W>::of(k * kLn2High + (f - (f * s - (s * z * series + small))));
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
