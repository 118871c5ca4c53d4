#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/physics/point_physics.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Puts dependent nodes where their hosts take them.
void place_dependents(const PointSet& set, State& state);
/// Velocities of dependent nodes, du/dt = Σ w du_a/dt + dQ_a/dt b_a.
void place_dependent_rates(const PointSet& set, State& state);

/// Some dependent node has a host that is a rigid frame, which forces on the node turn: add_turning() has what to add.
bool forces_turn_hosts(const PointSet& set);
/// Newton's tangent extrapolates stresses. Forces on dependent nodes are those of the state, and what these do to the
/// turning of hosts must not meet extrapolated stresses elsewhere: such models keep the stresses of the state. So do
/// those with user blocks, which know no others.
inline bool extrapolates_stresses(const PointSet& set, Tangent tangent) {
  return tangent == Tangent::full && set.user_blocks.empty() && !forces_turn_hosts(set);
}

/// The dependent nodes of a model at a state, where small motions of their hosts move them by
///
///   dx = Σ w dx_a + dA_a b_a,   and where they turn   dr = dr_a,   briefly d = J d_hosts.
///
/// Vectors and matrices of all degrees of freedom become those of the free ones: with d = T d', all of d from the rest,
/// g' = Tᵀ g and K' = Tᵀ K T, in which the entries of what depends are zero.
class DependentNodes {
 public:
  explicit DependentNodes(const PointSet& set);

  bool empty() const { return set_.dependents.empty(); }

  /// Takes the rotations of a state.
  void turn(const FrameMatrices& D);
  /// @param Q  I + D of each node
  void turn(const std::vector<Mat3d>& Q);

  /// Entries of dependent nodes of a direction, from those of their hosts.
  void expand(std::span<double> d) const;
  /// Moves forces on dependent nodes to their hosts.
  /// @param forces  (dependents × 6) takes what each hands on, with what it had from those that depend on it: force,
  /// and
  ///                where it turns the torque about it; or empty
  void transfer(std::span<double> g, std::span<double> forces = {}) const;
  /// Adds to the nodes' own blocks the second derivative of the dependent nodes' places, f · Q b along rotations of
  /// their hosts. @param forces  as transfer() kept them, of a gradient
  void add_turning(std::span<const double> forces, std::vector<double>& node_blocks) const;
  /// K ← Tᵀ K T, both halves.
  void condense(BlockMatrix& K) const;

  /// How much larger than the rounding of forces that of torques is on a part's hosts, with torques over the part's
  /// length. (parts)
  const std::vector<double>& leverage() const { return leverage_; }

 private:
  /// One host's part of J, by rows.
  struct Columns {
    int count = 0;  ///< degrees of freedom of the host
    double entry[6][kMostDofs] = {};
  };
  Columns columns_of(std::size_t dependent, std::size_t host) const;
  const Vec3d& lever(std::size_t dependent, std::size_t host) const { return lever_[lever_begin_[dependent] + host]; }
  void condense_node(std::size_t dependent, BlockMatrix& K) const;
  bool is_gone(int node, std::size_t dependent) const;

  const PointSet& set_;
  std::vector<std::size_t> lever_begin_;
  std::vector<Vec3d> lever_;    ///< Q b of rigid hosts, b of others [m]
  std::vector<int> dependent_;  ///< of each node: its place among dependents, −1: none
  std::vector<double> leverage_;
};

}  // namespace fascia
