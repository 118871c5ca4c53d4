#pragma once

#include "core/math/batch.hpp"

#include <cmath>

namespace fascia {

/// f = φ / sin φ of a rotation by φ as a function of z = sin²(φ/2), with its derivatives; |φ| < π.
///
///   f = arcsin(√z) / √(z (1 − z)) = Σ c_n zⁿ, c_n = c_{n−1} 2n/(2n+1);  2 z (1 − z) f' + (1 − 2z) f = 1
template <class T>
struct HalfAngle {
  T z{}, f{}, df{}, ddf{};

  HalfAngle() = default;
  FASCIA_HD explicit HalfAngle(const T& sine_squared) : z(sine_squared) {
    if (largest(z) < kSmall)
      expand();
    else
      evaluate();
  }

 private:
  static constexpr double kSmall = 0.02;  ///< twelve terms leave 1e-20 here
  static constexpr int kTerms = 12;
  struct Series {
    double c[kTerms + 3];
  };
  FASCIA_HD static constexpr Series series() {
    Series s{{1}};
    for (int n = 1; n < kTerms + 3; ++n) s.c[n] = s.c[n - 1] * 2.0 * n / (2.0 * n + 1);
    return s;
  }

  FASCIA_HD void expand() {
    constexpr Series s = series();
    f = df = ddf = T(0);
    for (int n = kTerms; n >= 0; --n) {
      f = f * z + T(s.c[n]);
      df = df * z + T(s.c[n + 1] * (n + 1));
      ddf = ddf * z + T(s.c[n + 2] * (n + 2) * (n + 1));
    }
  }

  /// Closed forms, and the series in lanes that they would lose digits in.
  FASCIA_HD void evaluate() {
    HalfAngle low;
    low.z = for_each(z, [](double s) { return s < kSmall ? s : 0.0; });
    low.expand();
    const T high = z - T(kSmall), slope = T(1) - T(2) * z;
    const T s = where_positive(high, z, T(0.5)), denominator = T(2) * s * (T(1) - s);
    f = where_positive(high, for_each(s, [](double x) { return std::asin(std::sqrt(x)) / std::sqrt(x * (1 - x)); }),
                       low.f);
    df = where_positive(high, (T(1) - slope * f) / denominator, low.df);
    ddf = where_positive(high, (T(2) * f - T(3) * slope * df) / denominator, low.ddf);
  }
};

}  // namespace fascia
