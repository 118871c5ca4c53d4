#pragma once

#include "core/physics/spring.hpp"

namespace fascia {

/// How far a spring is stretched, and along what. Of one that has no length at rest, t (l − l₀) is u itself.
struct SpringStretch {
  double length = 0, rest_length = 0;  ///< l, l₀ [m]
  Vec3d t{};                           ///< unit vector of the pull against which the node moves
  double stretch = 0;                  ///< u · n, or l − l₀ [m]
};

/// Displacement of the place that a spring is attached to [m]. @param u, D  displacement and A − I of its node
FASCIA_HD inline Vec3d spring_end(const Spring& spring, const Vec3d& u, const Mat3d& D) { return u + D * spring.arm; }

/// @param u  displacement of the node [m]
FASCIA_HD inline SpringStretch spring_stretch(const Spring& spring, const Vec3d& u) {
  SpringStretch s;
  if (squared_norm(spring.direction) > 0) {
    s.t = spring.direction;
    s.stretch = dot(u, s.t);
    return s;
  }
  const Vec3d rest = spring.X - spring.point, now = rest + u;
  s.rest_length = norm(rest);
  s.length = s.rest_length > 0 ? norm(now) : norm(u);
  // l² − l₀² over l + l₀: keeps the digits of small displacements.
  s.stretch = s.rest_length > 0 ? dot(u, rest + now) / (s.length + s.rest_length) : s.length;
  if (s.length > 0)
    s.t = now * (1 / s.length);
  else if (s.rest_length > 0)
    s.t = rest * (1 / s.rest_length);  // the node is just at the point, where any direction is as good
  return s;
}

/// Energy k s² / 2 of the stretch s [J].
FASCIA_HD inline double spring_energy(const Spring& spring, const Vec3d& u) {
  const double s = spring_stretch(spring, u).stretch;
  return 0.5 * spring.stiffness * s * s;
}

/// Gradient of the energy: k s t [N].
FASCIA_HD inline Vec3d spring_gradient(const Spring& spring, const Vec3d& u) {
  const SpringStretch s = spring_stretch(spring, u);
  if (squared_norm(spring.direction) == 0 && s.rest_length == 0) return u * spring.stiffness;
  return s.t * (spring.stiffness * s.stretch);
}

/// Second derivative of the energy: k t tᵀ, and of one that runs to a point k (1 − l₀/l) (I − t tᵀ) [N/m].
/// @param geometric  false leaves the latter out, which is negative in compression; where l₀ = 0 it is stiffness
FASCIA_HD inline Mat3d spring_tangent(const Spring& spring, const Vec3d& u, bool geometric) {
  const SpringStretch s = spring_stretch(spring, u);
  const bool directed = squared_norm(spring.direction) > 0;
  if (!directed && s.rest_length == 0) return Mat3d::diagonal(spring.stiffness);
  const Mat3d along = outer(s.t, s.t);
  Mat3d K = along * spring.stiffness;
  if (!directed && geometric && s.length > 0)
    K += (Mat3d::identity() - along) * (spring.stiffness * s.stretch / s.length);
  return K;
}

}  // namespace fascia
