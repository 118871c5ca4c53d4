#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/linear/rank_one.hpp"
#include "core/space/pool_space.hpp"
#include "core/step/surfaces.hpp"
#include "core/structure/dof_layout.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

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

/// The second derivative of what loads that turn or move with the body add to the gradient, but for what acts on one
/// frame alone (Linearization::node_blocks): pressed surfaces, followers, and dead torques on rigid frames.
struct LoadTangent {
  Surfaces<PoolSpace>* surfaces = nullptr;  ///< none: no surface loads
  SurfaceTangent<PoolSpace> surface;        ///< of these
  std::vector<RankOne> volumes;             ///< terms that no matrix holds
  std::vector<FollowerTangent> followers;
  std::vector<TorqueTangent> torques;

  void clear();
  /// Takes followers and torques at a state. @param factors  of schedules
  void take(const Model& model, const State& state, std::span<const double> factors);
  /// Loads have a potential: nothing is beside the symmetric part, which matrices and products hold.
  bool symmetric() const;
  /// y += K x, the symmetric part with the volumes. @param Q  I + D of each node, here and below
  void add_product(const PointSet& set, const std::vector<Mat3d>& Q, std::span<const double> x,
                   std::span<double> y) const;
  /// Adds the symmetric part without the volumes to a matrix.
  void add_to(BlockMatrix& matrix, const std::vector<Mat3d>& Q) const;
  /// y += what no symmetric matrix holds of K x, with K the derivative of what loads without a potential add to the
  /// gradient: pressure on surfaces with free edges, followers, torques. At rigid frames it is K − ½ [τ]×, as for all
  /// that acts on them (their torques τ cancel at equilibrium). Of surfaces it is the antisymmetric part, of others
  /// all.
  void add_unsymmetric_product(const PointSet& set, const std::vector<Mat3d>& Q, std::span<const double> x,
                               std::span<double> y) const;
};

}  // namespace fascia
