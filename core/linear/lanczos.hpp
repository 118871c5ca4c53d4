#pragma once

#include "core/math/tridiagonal.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

namespace fascia {

/// How far Lanczos iterations go.
struct LanczosOptions {
  int most = 400;         ///< products
  int look = 10;          ///< the eigenvalue is asked for every so many
  double settled = 1e-4;  ///< part by which it grew since then where it counts as found
};

/// The largest eigenvalue of a pencil A x = λ B x, and the tridiagonal matrix that it comes from.
struct LanczosValue {
  double value = 0;
  std::vector<double> diagonal, off;
};

/// Largest eigenvalue of A x = λ B x, A symmetric and B positive definite, by Lanczos iterations. It is found from
/// below.
///
/// @param y         where they start: B times a vector that has a share of the eigenvector
/// @param solve     solve(y, v): v ← B⁻¹ y
/// @param multiply  multiply(v, w): w ← A v
/// @param each      each(k, vₖ, B vₖ) sees the vectors of the basis, of length 1 in the norm of B; or empty
inline LanczosValue largest_ratio(
    std::vector<double> y, const LanczosOptions& options,
    const std::function<void(const std::vector<double>&, std::vector<double>&)>& solve,
    const std::function<void(const std::vector<double>&, std::vector<double>&)>& multiply,
    const std::function<void(std::size_t, const std::vector<double>&, const std::vector<double>&)>& each = {}) {
  const std::size_t n = y.size();
  std::vector<double> v(n), y_old(n, 0.0), w(n);
  LanczosValue out;
  double beta = 0, found = 0, looked = 0;
  for (int k = 1; k <= options.most; ++k) {
    solve(y, v);
    double norm2 = 0;
    for (std::size_t i = 0; i < n; ++i) norm2 += v[i] * y[i];
    beta = std::sqrt(norm2);
    if (!(beta > 1e-8 * std::abs(found))) break;
    if (k > 1) out.off.push_back(beta);
    for (std::size_t i = 0; i < n; ++i) {
      v[i] /= beta;
      y[i] /= beta;
    }
    if (each) each(out.diagonal.size(), v, y);
    multiply(v, w);
    double alpha = 0;
    for (std::size_t i = 0; i < n; ++i) alpha += v[i] * w[i];
    out.diagonal.push_back(alpha);
    const double beside = k > 1 ? beta : 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double next = w[i] - alpha * y[i] - beside * y_old[i];
      y_old[i] = y[i];
      y[i] = next;
    }
    if (k % options.look == 0 || k == 1) {
      found = largest_eigenvalue(out.diagonal, out.off);
      if (k > 1 && found - looked <= options.settled * found) break;
      looked = found;
    }
  }
  out.off.resize(out.diagonal.empty() ? 0 : out.diagonal.size() - 1);
  if (!out.diagonal.empty()) out.value = std::max(0.0, largest_eigenvalue(out.diagonal, out.off));
  return out;
}

}  // namespace fascia
