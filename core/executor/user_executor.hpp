#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/executor/block_executor.hpp"
#include "core/structure/user_block.hpp"

#include <span>
#include <vector>

namespace fascia {

/// A UserBlock as CpuExecutor asks for it. Cells are computed in parallel; nodes add up their cells in fixed order.
class UserExecutor {
 public:
  UserExecutor(const UserBlock& block, const PointSet& set, ThreadPool& pool);

  static constexpr bool kSeesMotions = true, kSeesTranslations = true, kSeesStateAgain = false;

  static bool empty() { return false; }
  /// Follows the cells of the block, which may have changed. @return  whether they have
  /// @throws InputError  a node that the model does not have
  bool follow();
  static std::size_t strain_size() { return 0; }
  static void store_strain(const BlockState&, std::span<double>) {}
  static void store_stress(const BlockState&, std::span<double>) {}
  void compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion);
  static std::size_t kept_size(bool) { return 0; }
  static void linearize(const BlockState&, const BlockState*, const BlockDirection*, std::span<double>) {}
  void compute_product(const BlockState& state, const BlockDirection& direction);
  void assemble(const BlockState& state, BlockMatrix& matrix, Entries entries);
  void add_sums(int node, NodeSum& sum) const;
  InternalEnergy energy() const { return {energy_, 0, 0}; }
  void add_rounding(std::span<double> squares_of_parts) const;
  double largest_spin(const BlockDirection& direction);
  /// The longest part of a step along the direction that all cells allow, up to 1.
  double largest_step(const BlockState& state, const BlockDirection& direction);

 private:
  void list_slots();
  std::span<const CellMotion> take_motions(const BlockDirection& direction, int cell);
  std::span<const CellPose> take_poses(const BlockState& state, int cell);
  /// A cell's part of an array by slots.
  template <class T>
  std::span<T> of_cell(std::vector<T>& by_slot, int cell) {
    return std::span(by_slot).subspan(at(block_.nodes * cell), at(block_.nodes));
  }
  /// Fills the matrix of a cell by rows, over the degrees of freedom of its nodes.
  void fill_matrix(const BlockState& state, int cell, std::span<double> K);
  void add_matrix(int cell, std::span<const double> K, Entries entries, BlockMatrix& matrix) const;
  int dofs_of_cell(int cell) const;
  /// Calls act(cell) for a range on all threads.
  template <class Act>
  void for_cells(int begin, int end, const Act& act);

  const UserBlock& block_;
  long revision_ = 0;  ///< of the block's cells
  const PointSet& set_;
  ThreadPool& pool_;
  std::vector<CellForce> slot_sums_;  ///< (cells × nodes)
  std::vector<CellPose> poses_;
  std::vector<CellMotion> motions_;
  std::vector<Vec3d> dx_;
  std::vector<int> node_slot_begin_, node_slot_;  ///< slots of each node of the model, ascending
  std::vector<double> cell_energy_, cell_rounding_;
  double energy_ = 0;
};

}  // namespace fascia
