#pragma once

#include "core/node/dof_filter.hpp"
#include "core/structure/inertia.hpp"
#include "core/structure/model.hpp"

#include <array>

namespace fascia {

/// Rotational inertia of a rigid frame, I = tr(J) 1 − J: about its mass centre, J = S − c cᵀ / m, or its origin, J = S
/// (also where it has no mass of its own, because its place depends on others).
struct SpinInertia {
  Mat3d rest{}, inverse_rest{};  ///< at rest [kg m²], [1/(kg m²)]
  bool regular = false;          ///< has an inverse

  SpinInertia() = default;
  FASCIA_HD explicit SpinInertia(const FrameInertia& i)
      : SpinInertia(i.mass > 0 ? i.second - outer(i.first, i.first) * (1 / i.mass) : i.second) {}
  FASCIA_HD explicit SpinInertia(const Mat3d& J) {
    rest = Mat3d::diagonal(trace(J)) - J;
    const double size = trace(rest);
    regular = determinant(rest) > kSingular * size * size * size;
    if (regular) inverse_rest = inverse(rest);
  }
  FASCIA_HD Vec3d momentum(const Mat3d& Q, const Vec3d& spin) const { return Q * (rest * (transpose(Q) * spin)); }
  FASCIA_HD Vec3d spin(const Mat3d& Q, const Vec3d& momentum) const {
    return Q * (inverse_rest * (transpose(Q) * momentum));
  }

 private:
  static constexpr double kSingular = 1e-10;
};

/// The mass block of a node (n × n by rows) in constraint axes at I + D = Q; rows and columns of what is held are those
/// of the identity.
/// @param turn   null: the axes of the world
/// @param fixed  bit k: the degree of freedom k is held
FASCIA_HD inline void free_mass_block(FrameKind kind, const FrameInertia& inertia, const Mat3d& Q, const DofTurn* turn,
                                      unsigned fixed, double* block) {
  double mass[kMostDofs * kMostDofs] = {};
  const int n = dof_count(kind);
  add_inertia_block(kind, inertia, Q, mass);
  turn_block(kind, turn, kind, turn, mass, block);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (((fixed >> i | fixed >> j) & 1U) != 0) block[n * i + j] = i == j ? 1 : 0;
}

/// The mass block of a node of a model (n × n by rows) in constraint axes; rows and columns of what is held are those
/// of the identity. @param Q  its I + D
inline std::array<double, kMostDofs * kMostDofs> free_mass_block(const Model& model, const DofFilter& filter, int node,
                                                                 const Mat3d& Q) {
  std::array<double, kMostDofs * kMostDofs> block{};
  free_mass_block(model.kind(node), model.inertia[at(node)], Q, filter.turn_of(node), filter.fixed_of(node),
                  block.data());
  return block;
}

}  // namespace fascia
