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

/// Holds the residual, M⁻¹ of it, the direction and its product: they keep their memory from solve to solve.
template <class Vector>
struct CgVectors {
  Vector r, z, p, Ap;
};

/// Does to vectors what conjugate gradients ask for, each in a loop of its own. An operator that can do several things
/// in one loop over its rows has such functions itself.
template <class Space, class Apply, class Precondition>
struct SeparateLoops {
  const Space& space;
  const Apply& apply;
  const Precondition& precondition;

  /// p = z + s p, Ap = A p; returns p · Ap
  template <class Vector>
  double direct(const Vector& z, double s, Vector& p, Vector& Ap) const {
    space.xpay(z, s, p);
    apply(p, Ap);
    return space.dot(p, Ap);
  }
  /// x += s p, r −= s Ap, z = M⁻¹ r; returns r · z
  template <class Vector>
  double advance(double s, const Vector& p, const Vector& Ap, Vector& x, Vector& r, Vector& z) const {
    space.advance(s, p, Ap, x, r);
    return precondition(r, z);
  }
  /// z = M⁻¹ r; returns r · z
  template <class Vector>
  double begin(const Vector& r, Vector& z) const {
    return precondition(r, z);
  }
};

/// Preconditioned conjugate gradients for A x = b from x = 0.
///
/// At a direction of negative curvature it stops with the x reached, which is a descent direction (truncated Newton,
/// Steihaug 1983); at the first iteration with M⁻¹ b. Reflected, x goes along that direction too.
///
/// @param space  dot, copy, clear and advance, as in CpuVectors
/// @param loops  begin, direct and advance, as in SeparateLoops
template <class Space, class Loops>
CgReport conjugate_gradients(const Space& space, const Loops& loops, const typename Space::Vector& b,
                             typename Space::Vector& x, CgVectors<typename Space::Vector>& vectors,
                             const CgOptions& options, NegativeCurvature negative = NegativeCurvature::stops) {
  // Reflected, a softer direction than this part of the preconditioner counts as one of negative curvature, so that a
  // direction without stiffness does not take all of the step.
  constexpr double kLeast = 1e-4;
  const bool reflects = negative == NegativeCurvature::reflected;
  const double goal = options.goal();
  CgReport report;
  typename Space::Vector &r = vectors.r, &z = vectors.z, &p = vectors.p, &Ap = vectors.Ap;
  for (auto* v : {&r, &z, &Ap}) v->resize(b.size());
  for (auto* v : {&p, &x}) space.clear(b.size(), *v);
  space.copy(b, r);
  const auto stop = [&](CgStatus status, double residual) {
    report.status = status;
    report.relative_residual = residual;
    report.relative_norm = std::sqrt(space.dot(r, r) / space.dot(b, b));
    return report;
  };
  double rz = loops.begin(r, z), s = 0;
  const double rz_start = rz;
  if (!std::isfinite(rz)) return {CgStatus::not_finite, 0, 0};
  if (rz <= 0) return report;
  for (; report.iterations < options.max_iterations; ++report.iterations) {
    const double curvature = loops.direct(z, s, p, Ap);
    if (!std::isfinite(curvature)) return stop(CgStatus::not_finite, std::sqrt(rz / rz_start));
    if (curvature <= (reflects ? kLeast * rz : 0.0)) {
      if (reflects)
        space.advance(rz / std::max(-curvature, kLeast * rz), p, Ap, x, r);
      else if (report.iterations == 0)
        x = p;
      return stop(CgStatus::negative_curvature, std::sqrt(rz / rz_start));
    }
    const double alpha = rz / curvature;
    const double rz_next = loops.advance(alpha, p, Ap, x, r, z);
    if (rz_next <= goal * goal * rz_start) {
      ++report.iterations;
      return stop(CgStatus::converged, std::sqrt(std::max(rz_next, 0.0) / rz_start));
    }
    if (report.iterations + 1 == options.look && rz_next > options.hope * options.hope * rz_start) {
      ++report.iterations;
      return stop(CgStatus::limit, std::sqrt(rz_next / rz_start));
    }
    s = rz_next / rz;
    rz = rz_next;
  }
  const double left = std::sqrt(rz / rz_start);
  return stop(left <= options.tolerance ? CgStatus::converged : CgStatus::limit, left);
}

/// Solves likewise, where an operator and a preconditioner know no vectors but their own: by SeparateLoops.
///
/// @param apply         apply(p, Ap)
/// @param precondition  precondition(r, z) returns r · z
/// @param space         xpay besides, as in CpuVectors
template <class Space, class Apply, class Precondition>
CgReport conjugate_gradients(const Space& space, const Apply& apply, const Precondition& precondition,
                             const typename Space::Vector& b, typename Space::Vector& x, const CgOptions& options,
                             NegativeCurvature negative = NegativeCurvature::stops) {
  CgVectors<typename Space::Vector> vectors;
  return conjugate_gradients(space, SeparateLoops<Space, Apply, Precondition>{space, apply, precondition}, b, x,
                             vectors, options, negative);
}

}  // namespace fascia
