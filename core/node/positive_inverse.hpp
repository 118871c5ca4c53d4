#pragma once

#include "core/structure/dof_layout.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

/// The inverse of a small symmetric matrix, by rows, as a preconditioner: by L D Lᵀ whose pivots are kept positive, so
/// that the result is positive definite also where the matrix is not (then it is the inverse of a matrix nearby).
/// @param a  n × n, n ≤ kMostDofs; overwritten
FASCIA_HD inline void positive_inverse(double* a, int n) {
  double largest = 0, L[kMostDofs][kMostDofs] = {}, d[kMostDofs] = {};
  for (int i = 0; i < n; ++i) largest = std::max(largest, std::abs(a[n * i + i]));
  if (largest == 0) largest = 1;
  for (int j = 0; j < n; ++j) {
    L[j][j] = 1;
    d[j] = a[n * j + j];
    for (int k = 0; k < j; ++k) d[j] -= L[j][k] * L[j][k] * d[k];
    d[j] = std::max(std::abs(d[j]), 1e-12 * largest);
    for (int i = j + 1; i < n; ++i) {
      double sum = a[n * i + j];
      for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k] * d[k];
      L[i][j] = sum / d[j];
    }
  }
  for (int column = 0; column < n; ++column) {
    double x[kMostDofs] = {};
    x[column] = 1;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < i; ++k) x[i] -= L[i][k] * x[k];
    for (int i = n - 1; i >= 0; --i) {
      x[i] /= d[i];
      for (int k = i + 1; k < n; ++k) x[i] -= L[k][i] * x[k];
    }
    for (int i = 0; i < n; ++i) a[n * i + column] = x[i];
  }
}

}  // namespace fascia
