#pragma once

#include "core/structure/model.hpp"

/// Block-lumped inertia of a frame in the 4×4 pose form: a motion (a, A) of (origin, axes) has
/// |(a, A)|² = m a·a + 2 a·(A c) + tr(A S Aᵀ), exact for every rigid motion of the body.
namespace fascia {

FASCIA_HD inline double inertia_product(const FrameInertia& i, const Vec3d& a, const Mat3d& A) {
  return i.mass * squared_norm(a) + 2 * dot(a, A * i.first) + contract(A * i.second, A);
}

/// Half the gradient of the square above, with respect to a and A.
struct InertiaForce {
  Vec3d force{};
  Mat3d moment{};
};
FASCIA_HD inline InertiaForce inertia_force(const FrameInertia& i, const Vec3d& a, const Mat3d& A) {
  return {a * i.mass + A * i.first, outer(a, i.first) + A * i.second};
}

/// The Hessian of half the square above on the degrees of freedom of a frame, at I + D = Q; of a rigid one, without
/// the part that vanishes with the motion.
FASCIA_HD inline void add_inertia_block(FrameKind kind, const FrameInertia& inertia, const Mat3d& Q, double* block) {
  if (kind == FrameKind::vertex) {
    for (int i = 0; i < 3; ++i) block[4 * i] += inertia.mass;
    return;
  }
  if (kind == FrameKind::affine) {
    for (int i = 0; i < 3; ++i) {
      block[13 * i] += inertia.mass;
      for (int q = 0; q < 3; ++q) {
        block[12 * i + 3 + 3 * q + i] += inertia.first[q];
        block[12 * (3 + 3 * q + i) + i] += inertia.first[q];
        for (int p = 0; p < 3; ++p) block[12 * (3 + 3 * p + i) + 3 + 3 * q + i] += inertia.second(p, q);
      }
    }
    return;
  }
  const Mat3d second = times_transpose(Q * inertia.second, Q), lever = skew(Q * inertia.first);
  for (int r = 0; r < 3; ++r) {
    block[7 * r] += inertia.mass;
    for (int c = 0; c < 3; ++c) {
      block[6 * r + 3 + c] -= lever(r, c);
      block[6 * (3 + r) + c] += lever(r, c);
    }
  }
  const Mat3d turn = Mat3d::diagonal(trace(second)) - second;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) block[6 * (3 + r) + 3 + c] += turn(r, c);
}

struct Momentum {
  Vec3d linear{}, angular{};  ///< [kg m/s], [kg m²/s] about `about`
  double kinetic_energy = 0;  ///< [J]
  double mass = 0;
  Vec3d first_moment{};  ///< Σ m x [kg m]
};

/// Momentum of one frame. @param x  present position of its origin, Q its rotation
FASCIA_HD inline Momentum momentum_of(const FrameInertia& i, const Vec3d& x, const Mat3d& Q, const Vec3d& v,
                                      const Mat3d& Q_dot, const Vec3d& about) {
  const Vec3d arm = Q * i.first, arm_dot = Q_dot * i.first, r = x - about;
  return {v * i.mass + arm_dot,
          cross(r, v * i.mass + arm_dot) + cross(arm, v) + axl(times_transpose(Q * i.second, Q_dot)),
          0.5 * inertia_product(i, v, Q_dot), i.mass, x * i.mass + arm};
}

}  // namespace fascia
