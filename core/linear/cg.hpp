#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fascia {

struct CgOptions {
  int max_iterations = 1000;
  double tolerance = 1e-6;  ///< on |r|_M⁻¹ relative to the right-hand side's
  double aim = 0;           ///< it goes on to this, which need not be reached, where it is less
  bool timed = false;       ///< the limit is that of the time left: a solve that ends there says nothing of its solver
  int look = 0;     ///< after so many iterations a solve ends as at its limit where more is left of |r|_M⁻¹ than
  double hope = 0;  ///< this part; 0 iterations: it goes on

  double goal() const { return aim > 0 ? std::min(aim, tolerance) : tolerance; }
};

enum class CgStatus { converged, limit, negative_curvature, not_finite };

/// A solve stops before a direction of negative curvature; or it goes along it as far as if the curvature were
/// positive.
enum class NegativeCurvature { stops, reflected };

struct CgReport {
  CgStatus status = CgStatus::converged;
  int iterations = 0;
  double relative_residual = 0;  ///< |r|_M⁻¹ / |b|_M⁻¹
  double relative_norm = 0;      ///< |r| / |b|
};

/// Preconditioned conjugate gradients for A x = b from x = 0.
///
/// At a direction of negative curvature it stops with the x reached, which is a descent direction (truncated Newton,
/// Steihaug 1983); at the first iteration with M⁻¹ b. Reflected, x goes along that direction too.
///
/// @param apply         apply(p, Ap)
/// @param precondition  precondition(r, z) returns r · z
/// @param space         dot, advance, xpay and zeros, as in CpuVectors
template <class Space, class Apply, class Precondition>
CgReport conjugate_gradients(const Space& space, const Apply& apply, const Precondition& precondition,
                             const typename Space::Vector& b, typename Space::Vector& x, const CgOptions& options,
                             NegativeCurvature negative = NegativeCurvature::stops) {
  using Vector = typename Space::Vector;
  // Reflected, a softer direction than this part of the preconditioner counts as one of negative curvature, so that a
  // direction without stiffness does not take all of the step.
  constexpr double kLeast = 1e-4;
  const bool reflects = negative == NegativeCurvature::reflected;
  const double goal = options.goal();
  CgReport report;
  Vector r = b, z = space.zeros(b.size()), p = z, Ap = z;
  const auto stop = [&](CgStatus status, double residual) {
    report.status = status;
    report.relative_residual = residual;
    report.relative_norm = std::sqrt(space.dot(r, r) / space.dot(b, b));
    return report;
  };
  x = z;
  double rz = precondition(r, z);
  const double rz_start = rz;
  if (!std::isfinite(rz)) return {CgStatus::not_finite, 0, 0};
  if (rz <= 0) return report;
  p = z;
  for (; report.iterations < options.max_iterations; ++report.iterations) {
    apply(p, Ap);
    const double curvature = space.dot(p, Ap);
    if (!std::isfinite(curvature)) return stop(CgStatus::not_finite, std::sqrt(rz / rz_start));
    if (curvature <= (reflects ? kLeast * rz : 0.0)) {
      if (reflects)
        space.advance(rz / std::max(-curvature, kLeast * rz), p, Ap, x, r);
      else if (report.iterations == 0)
        x = p;
      return stop(CgStatus::negative_curvature, std::sqrt(rz / rz_start));
    }
    const double alpha = rz / curvature;
    space.advance(alpha, p, Ap, x, r);
    const double rz_next = precondition(r, z);
    if (rz_next <= goal * goal * rz_start) {
      ++report.iterations;
      return stop(CgStatus::converged, std::sqrt(std::max(rz_next, 0.0) / rz_start));
    }
    if (report.iterations + 1 == options.look && rz_next > options.hope * options.hope * rz_start) {
      ++report.iterations;
      return stop(CgStatus::limit, std::sqrt(rz_next / rz_start));
    }
    space.xpay(z, rz_next / rz, p);
    rz = rz_next;
  }
  const double left = std::sqrt(rz / rz_start);
  return stop(left <= options.tolerance ? CgStatus::converged : CgStatus::limit, left);
}

}  // namespace fascia
