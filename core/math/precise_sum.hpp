#pragma once

#include <cmath>

namespace fascia {

/// A sum of products, as precise as if computed with twice the digits of a double and rounded once (Ogita, Rump and
/// Oishi, Accurate Sum and Dot Product, 2005, Algorithm 5.3). Large terms may cancel.
class PreciseSum {
 public:
  PreciseSum& add(double a, double b) {
    const double product = a * b, sum = sum_ + product, part = sum - sum_;
    rest_ += std::fma(a, b, -product) + ((sum_ - (sum - part)) + (product - part));
    sum_ = sum;
    return *this;
  }
  double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0;
  double rest_ = 0;  ///< what rounding took from the sum
};

}  // namespace fascia
