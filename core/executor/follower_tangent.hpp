#pragma once

#include "core/structure/dof_layout.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

struct Linearization;

/// A follower load at a state, as its second derivative needs it.
struct FollowerTangent {
  const FollowerLoad* load = nullptr;
  Vec3d force{}, torque{};             ///< turned and scaled [N], [N m]
  Mat3d F{};                           ///< Σ w A of frames, I + Σ u gᵀ of vertices
  Mat3d rotation{}, spin_of_change{};  ///< Q of F; ω = spin_of_change · axl(Q dFᵀ) turns Q. Zero: nothing turns

  FollowerTangent(const FollowerLoad& load, const State& state, double factor);
};

/// A torque on a rigid frame that keeps its direction in space.
struct TorqueTangent {
  int node = 0;
  Vec3d torque{};  ///< scaled [N m]
};

/// y += what no symmetric matrix holds of K x, with K the derivative of what loads without a potential add to the
/// gradient: pressure on surfaces with free edges, followers, torques. At rigid frames it is K − ½ [τ]×, as for all
/// that acts on them (their torques τ cancel at equilibrium). Of surfaces it is the antisymmetric part, of others all.
void add_unsymmetric_product(const Linearization& lin, const PointSet& set, std::span<const double> x,
                             std::span<double> y);

}  // namespace fascia
