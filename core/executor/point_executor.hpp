#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/executor/block_executor.hpp"

#include <span>
#include <vector>

namespace fascia {

/// How far a tether's material is from where it pulls to, and the force with which it does.
/// @param targets  as CpuExecutor::targets()
Vec3d tether_stretch(const PointSet& set, std::span<const double> targets, const Tether& tether, const State& state);
Vec3d tether_force(const PointSet& set, std::span<const double> targets, const Tether& tether, const State& state);
/// Sums what a range of groups gave a node. @param slot_sums  (slots × 12): Σ v P g (3), Σ v (P Bᵀ + w Y) (9)
NodeSum sum_of_groups(const PointSet& set, std::span<const double> slot_sums, int first, int count, int node);

/// Computes the groups of points of a set at a state, as CpuExecutor asks for it: one pass over groups, whose sums by
/// slot the nodes gather.
class PointExecutor {
 public:
  static constexpr bool kSeesMotions = true, kSeesTranslations = false, kSeesStateAgain = false;
  static constexpr int kRows = 27;  ///< kept of a group: H (9), Dbar (9), S (6), drilling (3)

  PointExecutor(const PointSet& set, ThreadPool& pool);

  /// Where tethers pull to: (groups with axes × 3 × 8) [m]. Zero at first.
  std::span<double> targets() { return targets_; }

  bool empty() const { return set_.group_count() == 0; }
  std::size_t strain_size() const { return at(set_.group_count()) * 6 * kGroupSize; }
  void store_strain(const BlockState& state, std::span<double> E);
  void store_stress(const BlockState& state, std::span<double> S);
  void compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion);
  std::size_t kept_size(bool /*extrapolated*/) const { return at(set_.group_count()) * kRows * kGroupSize; }
  /// Where a step led there, add_sums() gives what acts with extrapolated stresses.
  void linearize(const BlockState& now, const BlockState* start, const BlockDirection* step, std::span<double> kept);
  void compute_product(const BlockState& state, const BlockDirection& direction);
  void assemble(const BlockState& state, BlockMatrix& matrix, Entries entries);
  void add_sums(int node, NodeSum& sum) const;
  InternalEnergy energy() const;
  void add_rounding(std::span<double> squares_of_parts) const;
  static double largest_spin(const BlockDirection&) { return 0; }

  /// Elastic and stabilisation energy of each group at the last forces with energies [J].
  std::span<const double> group_elastic() const { return group_elastic_; }
  std::span<const double> group_stabilization() const { return group_stabilization_; }
  /// Sums of slots as the last forces, or a product, left them; for sum_of_groups().
  std::span<const double> sums_of_slots() const { return slot_sums_; }

  bool has_tethers() const { return !slot_is_tether_.empty(); }
  /// Tethers alone gave this to a node.
  NodeSum tether_sum(int node) const;
  /// Σ |force|² of a connected part's tethers at the last forces with energies [N²].
  double squared_tether_force(int part) const { return part_tether_[at(part)]; }
  Vec3d tether_force(const Tether& tether, const State& state) const {
    return fascia::tether_force(set_, targets_, tether, state);
  }
  Vec3d tether_stretch(const Tether& tether, const State& state) const {
    return fascia::tether_stretch(set_, targets_, tether, state);
  }

 private:
  template <PointKind Kind>
  void forces_of_group(const BlockState& state, int group, bool energies, std::span<const double> part_motion);
  template <PointKind Kind>
  void split_energy(const BlockState& state, int group, int batch, const PointMotion<Lanes>& x,
                    PointEnergy<Lanes>& energy) const;
  template <PointKind Kind>
  void stress_of_group(const BlockState& state, int group, std::span<double> S) const;
  template <PointKind Kind>
  void linearize_group(const BlockState& now, const BlockState* start, const BlockDirection* step, int group,
                       std::span<double> kept);
  template <PointKind Kind>
  void product_of_group(const BlockState& state, int group, const BlockDirection& direction);
  template <PointKind Kind>
  void assemble_group(const BlockState& state, int group, Entries entries, BlockMatrix& matrix) const;
  const PointRule& rule_of(int group) const { return set_.rule[at(group)].rule; }

  const PointSet& set_;
  ThreadPool& pool_;
  AlignedVector<double> slot_sums_;  ///< (slots × 12): Σ v P g (3), Σ v (P Bᵀ + w Y) (9)
  std::vector<double> group_elastic_, group_stabilization_, group_viscous_, group_rounding_, group_tether_;
  std::vector<double> part_tether_;
  AlignedVector<double> targets_;
  std::vector<char> slot_is_tether_;  ///< empty where there are none
};

}  // namespace fascia
