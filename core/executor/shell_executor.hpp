#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/executor/block_executor.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

/// Computes a block of shell triangles at a state, as CpuExecutor asks for it: forces on frames, products with the
/// tangent, its entries. Batches are computed in parallel; frames add up their triangles in fixed order.
class ShellExecutor {
 public:
  ShellExecutor(const ShellBlock& block, const PointSet& set, ThreadPool& pool);

  static constexpr bool kSeesMotions = false, kSeesTranslations = false, kSeesStateAgain = true;

  bool empty() const { return block_.count == 0; }
  /// (batches × 12 × 8)
  std::size_t strain_size() const { return at(block_.batch_count()) * 12 * kElementLanes; }
  void store_strain(const BlockState& state, std::span<double> e);
  void store_stress(const BlockState& state, std::span<double> e) { store_strain(state, e); }
  /// By triangle.
  void compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion);
  /// Stresses that are extrapolated, in the layout of strains; empty: those of the state.
  std::size_t kept_size(bool extrapolated) const { return extrapolated ? strain_size() : 0; }
  void linearize(const BlockState& now, const BlockState* start, const BlockDirection* step, std::span<double> kept);
  void compute_product(const BlockState& state, const BlockDirection& direction);
  void assemble(const BlockState& state, BlockMatrix& matrix, Entries entries);
  void add_sums(int node, NodeSum& sum) const;
  InternalEnergy energy() const { return {elastic_, 0, viscous_}; }
  void add_rounding(std::span<double> squares_of_parts) const;
  static double largest_spin(const BlockDirection&) { return 0; }

 private:
  struct Sums {
    double elastic = 0, viscous = 0, rounding = 0;
  };
  void forces_of_batch(const BlockState& state, int batch, bool energies, double motion);
  void product_of_batch(const BlockState& state, int batch, std::span<const double> d);
  void assemble_batch(const BlockState& state, int batch, BlockMatrix& matrix) const;
  void find_pair_slots(const BlockMatrix& matrix);
  int part_of_batch(int batch) const { return set_.node_part[at(block_.nodes_of(batch)[0])]; }

  const ShellBlock& block_;
  const PointSet& set_;
  ThreadPool& pool_;
  std::vector<double> slot_sums_;  ///< (batches × 8 × 18): force and torque of each corner
  std::vector<Sums> sums_;         ///< (batches)
  double elastic_ = 0, viscous_ = 0;
  std::uint64_t pattern_ = 0;             ///< of the matrix in which these are:
  std::vector<std::uint32_t> pair_slot_;  ///< (batches × 6 × 8): place of a block's values
};

}  // namespace fascia
