#pragma once

#include "core/node/node_force.hpp"
#include "core/physics/spring_law.hpp"
#include "core/structure/model.hpp"

/// Dead loads and springs at one node, as functions of plain values. Entries and blocks are those of the node.
namespace fascia {

/// Adds s times a load to the entries of its node. @param D  its present A − I
FASCIA_HD inline void add_dead_load(FrameKind kind, const NodeLoad& load, double s, const Mat3d& D, double* g) {
  add_node_force(kind, D, load.force * s, load.couple * s, load.torque * s, g);
}

/// Work that the load has done without its torque; minus its potential [J].
FASCIA_HD inline double dead_load_work(const NodeLoad& load, const Vec3d& u, const Mat3d& D) {
  return dot(load.force, u) + contract(load.couple, D);
}

/// Adds what s times a load on a rigid frame is in the tangent. @param Q  its present I + D
FASCIA_HD inline void add_dead_load_block(const NodeLoad& load, double s, const Mat3d& Q, double* block) {
  add_rotation_block(block, rotation_tangent(times_transpose(load.couple, Q)) * -s);
}

/// Adds the gradient of a spring's energy. @param u, D  displacement and A − I of its node
FASCIA_HD inline void add_spring_force(FrameKind kind, const Spring& spring, const Vec3d& u, const Mat3d& D,
                                       double* g) {
  const Vec3d force = spring_gradient(spring, spring_end(spring, u, D));
  add_node_force(kind, D, force, outer(force, spring.arm), {}, g);
}

/// Adds the second derivative. @param full  false leaves out what may be negative
FASCIA_HD inline void add_spring_block(FrameKind kind, const Spring& spring, const Vec3d& u_node, const Mat3d& D,
                                       bool full, double* block) {
  const Vec3d u = spring_end(spring, u_node, D);
  const Mat3d K = spring_tangent(spring, u, full);
  const int n = dof_count(kind);
  const auto add = [&](int row, int column, const Mat3d& part) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) block[n * (row + i) + column + j] += part(i, j);
  };
  add(0, 0, K);
  if (squared_norm(spring.arm) == 0) return;
  const Vec3d arm = spring.arm + D * spring.arm;
  const Mat3d W = skew(arm) * -1.0;  // du of the end for a small rotation
  add(0, 3, K * W);
  add(3, 0, transpose(W) * K);
  add(3, 3, transpose(W) * K * W);
  if (full) add_rotation_block(block, rotation_tangent(outer(spring_gradient(spring, u), arm)));
}

}  // namespace fascia
