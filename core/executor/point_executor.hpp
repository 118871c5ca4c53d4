#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/executor/block_executor.hpp"
#include "core/executor/point_frames.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace fascia {
namespace kernels {
class PointModuli;
struct PointTie;
}  // namespace kernels

/// How far a tether's material is from where it pulls to, and the force with which it does.
/// @param targets  as CpuExecutor::targets()
Vec3d tether_stretch(const PointSet& set, std::span<const double> targets, const Tether& tether, const State& state);
Vec3d tether_force(const PointSet& set, std::span<const double> targets, const Tether& tether, const State& state);
/// Sums what a range of groups gave a node. @param slot_sums  (slots × 12): Σ v P g (3), Σ v (P Bᵀ + w Y) (9)
NodeSum sum_of_groups(const PointSet& set, std::span<const double> slot_sums, const BodyBlocks::Run& groups, int node);

/// Computes the groups of points of a set at a state, as CpuExecutor asks for it: one pass over groups, whose sums by
/// frame the nodes gather.
class PointExecutor {
 public:
  static constexpr bool kSeesMotions = true, kSeesTranslations = false, kSeesStateAgain = false;

  PointExecutor(const PointSet& set, ThreadPool& pool);

  /// Where tethers pull to: (groups with axes × 3 × 8) [m]. Zero at first.
  std::span<double> targets() { return targets_; }

  bool empty() const { return set_.group_count() == 0; }
  std::size_t strain_size() const { return at(set_.group_count()) * 6 * kGroupSize; }
  void store_strain(const BlockState& state, std::span<double> E);
  void store_stress(const BlockState& state, std::span<double> S);
  void compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion);
  std::size_t kept_size(bool /*extrapolated*/) const { return kept_begin_.back(); }
  /// Where a step led there, add_sums() gives what acts with extrapolated stresses.
  void linearize(const BlockState& now, const BlockState* start, const BlockDirection* step, std::span<double> kept);
  void compute_product(const BlockState& state, const BlockDirection& direction);
  /// Clears the matrix before: the blocks of other executors are added after these.
  void assemble(const BlockState& state, BlockMatrix& matrix, Entries entries);
  void add_sums(int node, NodeSum& sum) const { frames_.add_sums(node, false, sum); }
  InternalEnergy energy() const;
  void add_rounding(std::span<double> squares_of_parts) const;
  static double largest_spin(const BlockDirection&) { return 0; }

  /// Elastic and stabilisation energy of each group at the last forces with energies [J].
  std::span<const double> group_elastic() const { return group_elastic_; }
  std::span<const double> group_stabilization() const { return group_stabilization_; }
  /// Stores what each slot of each group has of the forces at a state, for sum_of_groups().
  void store_slot_sums(const BlockState& state, std::vector<double>& out);

  bool has_tethers() const { return has_tethers_; }
  /// Tethers alone gave this to a node.
  NodeSum tether_sum(int node) const {
    NodeSum sum;
    frames_.add_sums(node, true, sum);
    return sum;
  }
  /// Σ |force|² of a connected part's tethers at the last forces with energies [N²].
  double squared_tether_force(int part) const { return part_tether_[at(part)]; }
  Vec3d tether_force(const Tether& tether, const State& state) const {
    return fascia::tether_force(set_, targets_, tether, state);
  }
  Vec3d tether_stretch(const Tether& tether, const State& state) const {
    return fascia::tether_stretch(set_, targets_, tether, state);
  }

 private:
  using Rows = PointFrames::Rows;
  template <Stabilization Tie>
  GroupStress stress_on_group(const BlockState& state, int group, Rows rows, bool energies,
                              std::span<const double> part_motion);
  /// Returns the rows that are kept of a group: kernels::KeptRow in point_kernels.hpp.
  const double* kept_of(const BlockState& state, int group) const { return state.kept.data() + kept_begin_[at(group)]; }
  template <Stabilization Tie, Law L>
  void split_energy(const BlockState& state, int group, int batch, const PointMotion<Lanes>& x,
                    PointEnergy<Lanes>& energy) const;
  void stress_of_group(const BlockState& state, int group, Rows rows, std::span<double> S) const;
  template <Stabilization Tie>
  void linearize_group(const BlockState& now, int group, Rows rows, std::span<double> kept) const;
  template <Stabilization Tie>
  void extrapolate_group(const BlockState& now, int group, const std::array<Rows, 3>& rows, std::span<double> kept);
  template <PointKind Kind>
  void product_of_group(const BlockState& state, int group, Rows rows);
  struct GroupOfFrames;
  struct FramesOfOne;
  struct FramesOfAll;
  template <Law L>
  void set_moduli_of(const BlockState& state, int group, int batch, kernels::PointModuli& moduli) const;
  void set_moduli(const BlockState& state, int group, int batch, kernels::PointModuli& moduli) const;
  template <Stabilization Tie>
  kernels::PointTie tie_of(const BlockState& state, int group, int batch) const;
  void set_frames(const BlockState& state, int group, const GroupOfFrames& frames) const;
  template <Stabilization Tie>
  void assemble_slot(const BlockState& state, int group, int slot, const GroupOfFrames& frames, Entries entries,
                     BlockMatrix& matrix) const;
  void assemble_slot_of(const BlockState& state, int group, int slot, const GroupOfFrames& frames, Entries entries,
                        BlockMatrix& matrix) const;
  void assemble_node(const BlockState& state, int node, Entries entries, BlockMatrix& matrix) const;
  void assemble_by_nodes(const BlockState& state, Entries entries, BlockMatrix& matrix);
  void assemble_group(const BlockState& state, int group, Entries entries, BlockMatrix& matrix) const;
  void assemble_one(const BlockState& state, int group, Entries entries, BlockMatrix& matrix) const;
  template <Stabilization Tie, FrameKind Frame>
  void assemble_lanes(const BlockState& state, int group, Entries entries, BlockMatrix& matrix) const;
  void find_pairs(const BlockMatrix& matrix);
  /// Both move a point of their group.
  bool together(int slot, int other) const { return (set_.slot_lanes[at(slot)] & set_.slot_lanes[at(other)]) != 0; }
  const PointRule& rule_of(int group) const { return set_.rule[at(group)].rule; }

  const PointSet& set_;
  ThreadPool& pool_;
  PointFrames frames_;
  AlignedVector<double> now_, start_;    ///< rows of nodes at states
  std::vector<std::size_t> kept_begin_;  ///< (groups + 1) of what is kept of a state
  bool has_tethers_;
  std::uint64_t pattern_ = 0;            ///< of the matrix in which these are:
  std::vector<std::uint32_t> pairs_;     ///< places of blocks of pairs of frames of each group, or of each lane of one
  std::vector<std::size_t> pair_begin_;  ///< (slots); of lanes by the group's first slot
  std::vector<int> group_of_slot_;       ///< empty where groups are assembled by colours
  std::shared_ptr<FramesOfAll> frames_of_all_;  ///< where nodes assemble, from the first time on
  std::vector<double> group_elastic_, group_stabilization_, group_viscous_, group_rounding_, group_tether_;
  std::vector<double> part_tether_;
  AlignedVector<double> targets_;
};

}  // namespace fascia
