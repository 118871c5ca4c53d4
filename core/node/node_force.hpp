#pragma once

#include "core/math/rotation.hpp"
#include "core/structure/model.hpp"

namespace fascia {

/// Adds a force, what is conjugate to A, and a torque to the entries of one node.
/// @param D  its present A − I
FASCIA_HD inline void add_node_force(FrameKind kind, const Mat3d& D, const Vec3d& force, const Mat3d& N,
                                     const Vec3d& torque, double* g) {
  const Mat3d A = Mat3d::identity() + D;
  for (int k = 0; k < 3; ++k) g[k] += force[k];
  if (kind == FrameKind::vertex) return;
  add_moment(kind, squared_norm(torque) > 0 ? N + moment_of_torque(torque, A) : N, A, g + 3);
}

/// Second derivative of Σ f · Q b along rotation increments of a rigid frame, from the moment L = Σ f (Q b)ᵀ.
FASCIA_HD inline Mat3d rotation_tangent(const Mat3d& L) { return sym(L) - Mat3d::diagonal(trace(L)); }

FASCIA_HD inline void add_rotation_block(double* block, const Mat3d& rr) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) block[6 * (3 + i) + 3 + j] += rr(i, j);
}

/// ω of a motion Q_dot of a rotation Q: the spin of Q_dot Qᵀ.
FASCIA_HD inline Vec3d spin_of(const Mat3d& Q_dot, const Mat3d& Q) {
  return axl(transpose(times_transpose(Q_dot, Q))) * 0.5;
}

}  // namespace fascia
