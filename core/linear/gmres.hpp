#pragma once

#include "core/base/index.hpp"
#include "core/linear/vectors.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace fascia {

struct GmresOptions {
  int max_iterations = 200;
  int restart = 50;          ///< directions that are kept at once
  double tolerance = 1e-10;  ///< on |r| / |b|
};

/// Tolerance of conjugate gradients with the symmetric part, as a preconditioner of the whole.
inline constexpr double kInnerTolerance = 1e-3;
/// A solve that leaves more is worse than one with the symmetric part alone.
inline constexpr double kUsefulResidual = 1e-3;

struct GmresReport {
  bool converged = false;
  int iterations = 0;
  double relative_residual = 0;  ///< |r| / |b|, of the last product
};

/// The least-squares problem of GMRES: min |β e₁ − H y| of a Hessenberg matrix that grows by columns, by Givens
/// rotations.
class HessenbergProblem {
 public:
  explicit HessenbergProblem(double beta) : g_{beta} {}

  /// @param column  entries 0 … k + 1 of column k; overwritten. @return  |residual|
  double add(std::vector<double>& column) {
    const std::size_t k = columns_.size();
    for (std::size_t i = 0; i < k; ++i) {
      const double upper = cosine_[i] * column[i] + sine_[i] * column[i + 1];
      column[i + 1] = cosine_[i] * column[i + 1] - sine_[i] * column[i];
      column[i] = upper;
    }
    const double radius = std::hypot(column[k], column[k + 1]);
    cosine_.push_back(radius > 0 ? column[k] / radius : 1.0);
    sine_.push_back(radius > 0 ? column[k + 1] / radius : 0.0);
    column[k] = radius;
    columns_.push_back(column);
    g_.push_back(-sine_[k] * g_[k]);
    g_[k] *= cosine_[k];
    return std::abs(g_[k + 1]);
  }

  /// y; zero where a column brought nothing.
  std::vector<double> solution() const {
    std::vector<double> y(g_.begin(), g_.end() - 1);
    for (std::size_t k = y.size(); k-- > 0;) {
      for (std::size_t j = k + 1; j < y.size(); ++j) y[k] -= columns_[j][k] * y[j];
      y[k] = columns_[k][k] > 0 ? y[k] / columns_[k][k] : 0.0;
    }
    return y;
  }

 private:
  std::vector<std::vector<double>> columns_;
  std::vector<double> cosine_, sine_, g_;
};

/// Flexible GMRES for A x = b from x = 0 (Saad 1993): A may be unsymmetric and the preconditioner another one in each
/// iteration, as an iterative solver is. After `restart` directions it starts anew from what is left.
///
/// @param apply         apply(z, w): w = A z
/// @param precondition  precondition(v, z): z ≈ A⁻¹ v; false ends the solve
template <class Apply, class Precondition>
GmresReport flexible_gmres(const CpuVectors& space, const Apply& apply, const Precondition& precondition,
                           const CpuVectors::Vector& b, CpuVectors::Vector& x, const GmresOptions& options) {
  using Vector = CpuVectors::Vector;
  GmresReport report;
  const std::size_t n = b.size();
  x = space.zeros(n);
  const double size = std::sqrt(space.dot(b, b));
  report.converged = size == 0;
  Vector r = b, w = x;
  double left = size;
  bool goes_on = std::isfinite(size) && size > 0;
  while (goes_on && !report.converged && report.iterations < options.max_iterations) {
    const double begin = left;
    std::vector<Vector> v, z;
    HessenbergProblem problem(begin);
    v.push_back(r);
    space.scale(1 / begin, v[0]);
    while (goes_on && report.iterations < options.max_iterations && z.size() < at(options.restart)) {
      z.push_back(space.zeros(n));
      if (!precondition(v.back(), z.back())) {
        z.pop_back();
        goes_on = false;
        break;
      }
      apply(z.back(), w);
      ++report.iterations;
      std::vector<double> column(v.size() + 1);
      for (std::size_t i = 0; i < v.size(); ++i) {
        column[i] = space.dot(v[i], w);
        space.add(-column[i], v[i], w);
      }
      const double next = column.back() = std::sqrt(space.dot(w, w));
      if (!std::isfinite(next)) {
        z.pop_back();
        goes_on = false;
        break;
      }
      const double estimate = problem.add(column);
      if (estimate <= options.tolerance * size || next == 0) break;
      v.push_back(w);
      space.scale(1 / next, v.back());
    }
    const std::vector<double> y = problem.solution();
    for (std::size_t k = 0; k < z.size() && k < y.size(); ++k) space.add(y[k], z[k], x);
    apply(x, w);
    r = b;
    space.add(-1, w, r);
    left = std::sqrt(space.dot(r, r));
    // Rounding keeps the product from what the estimate says; then another round brings nothing.
    constexpr double kAsEstimated = 10, kStands = 0.5;
    report.converged = left <= kAsEstimated * options.tolerance * size;
    if (!(left < kStands * begin)) break;
  }
  report.relative_residual = size > 0 ? left / size : 0.0;
  return report;
}

/// flexible_gmres() with degrees of freedom of several units: norms are those of forces, and of torques over lengths.
/// @param length  what a unit of each degree of freedom moves [m]; 0 where it is fixed
template <class Apply, class Precondition>
GmresReport gmres_by_length(const CpuVectors& space, std::span<const double> length, const Apply& apply,
                            const Precondition& precondition, std::span<const double> b, CpuVectors::Vector& x,
                            const GmresOptions& options) {
  using Vector = CpuVectors::Vector;
  const auto scale = [&](Vector& r) {
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = length[i] > 0 ? r[i] / length[i] : 0.0;
  };
  Vector rhs(b.begin(), b.end());
  scale(rhs);
  return flexible_gmres(
      space,
      [&](const Vector& z, Vector& w) {
        apply(z, w);
        scale(w);
      },
      [&](const Vector& v, Vector& z) {
        Vector r = v;
        for (std::size_t i = 0; i < r.size(); ++i) r[i] *= length[i];
        return precondition(r, z) && std::all_of(z.begin(), z.end(), [](double value) { return std::isfinite(value); });
      },
      rhs, x, options);
}

}  // namespace fascia
