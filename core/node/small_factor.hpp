#pragma once

#include "core/structure/dof_layout.hpp"

namespace fascia {

/// L D Lᵀ of a small symmetric positive definite matrix: the mass block of a node.
class SmallFactor {
 public:
  /// False where a pivot falls below kSingular of its diagonal entry: the matrix is singular.
  /// @param a  n × n by rows, n ≤ kMostDofs; its lower triangle is read
  FASCIA_HD bool factorize(const double* a, int n) {
    n_ = n;
    for (int j = 0; j < n; ++j) {
      d_[j] = a[n * j + j];
      for (int k = 0; k < j; ++k) d_[j] -= L_[j][k] * L_[j][k] * d_[k];
      if (!(d_[j] > kSingular * a[n * j + j])) return false;
      for (int i = j + 1; i < n; ++i) {
        double sum = a[n * i + j];
        for (int k = 0; k < j; ++k) sum -= L_[i][k] * L_[j][k] * d_[k];
        L_[i][j] = sum / d_[j];
      }
    }
    return true;
  }

  /// x ← A⁻¹ x
  FASCIA_HD void solve(double* x) const {
    for (int i = 0; i < n_; ++i)
      for (int k = 0; k < i; ++k) x[i] -= L_[i][k] * x[k];
    for (int i = n_ - 1; i >= 0; --i) {
      x[i] /= d_[i];
      for (int k = i + 1; k < n_; ++k) x[i] -= L_[k][i] * x[k];
    }
  }

 private:
  static constexpr double kSingular = 1e-11;
  int n_ = 0;
  double L_[kMostDofs][kMostDofs]{}, d_[kMostDofs]{};
};

}  // namespace fascia
