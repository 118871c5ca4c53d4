#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/executor/block_executor.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Computes a block of elements at a state, as CpuExecutor asks for it: forces on vertices, products with the tangent,
/// its entries. Patches are computed in parallel, each in a fixed order.
class ElementExecutor {
 public:
  ElementExecutor(const ElementBlock& block, const PointSet& set, ThreadPool& pool);

  static constexpr bool kSeesMotions = false, kSeesTranslations = true, kSeesStateAgain = true;

  bool empty() const { return block_.count == 0; }
  /// (batches × points × 6 × 8)
  std::size_t strain_size() const;
  void store_strain(const BlockState& state, std::span<double> E);
  void store_stress(const BlockState& state, std::span<double> S);
  /// Sums forces by patch.
  void compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion);
  /// Stresses that are extrapolated, in the layout of strains; empty: those of the state.
  std::size_t kept_size(bool extrapolated) const { return extrapolated && block_.extrapolates() ? strain_size() : 0; }
  void linearize(const BlockState& now, const BlockState* start, const BlockDirection* step, std::span<double> kept);
  void compute_product(const BlockState& state, const BlockDirection& direction);
  void assemble(const BlockState& state, BlockMatrix& matrix, Entries entries);
  void add_sums(int node, NodeSum& sum) const {
    Vec3d force;
    for (int k = block_.node_slot_begin[at(node)]; k < block_.node_slot_begin[at(node + 1)]; ++k)
      force += slot_sum_[at(block_.node_slot[at(k)])];
    sum.force += force;
  }
  InternalEnergy energy() const { return {elastic_, 0, viscous_}; }
  void add_rounding(std::span<double> squares_of_parts) const;
  /// To first order; 0 of the linear law, which has no use for it.
  double largest_spin(const BlockDirection& direction);

 private:
  struct PatchSums {
    double elastic = 0, viscous = 0, rounding = 0;
  };
  template <Law L, int N>
  void forces_of_patch(const BlockState& state, int patch, std::span<const double> part_motion);
  template <Law L, int N>
  void product_of_patch(const BlockState& state, int patch, std::span<const Vec3d> dx);
  template <Law L, int N>
  void assemble_patch(const BlockState& state, int patch, BlockMatrix& matrix);
  template <int N>
  void add_pairs(const Mat3<Lanes>* K, int batch, int half, BlockMatrix& matrix) const;
  void prefetch_pair(std::size_t place, const double* values) const;
  template <int N>
  void add_penalty_product(const BlockState& state, int patch);
  template <int N>
  void assemble_penalty(const BlockState& state, int patch, BlockMatrix& matrix);
  template <Law L, int N>
  void strain_of_patch(int patch, std::span<double> E) const;
  template <Law L, int N>
  void stress_of_patch(const BlockState& state, int patch, std::span<double> S) const;
  template <int N>
  double spin_of_patch(int patch) const;
  template <Law L, int N>
  void extrapolate_patch(const BlockState& start, int patch, std::span<double> S) const;
  void gather_patch(std::span<const Vec3d> values, int patch, std::vector<Vec3d>& out) const;
  void find_pair_slots(const BlockMatrix& matrix);

  void find_lane_parts();
  Lanes lane_motion(int batch, int half, std::span<const double> part_motion) const;
  int part_of_patch(int patch) const { return set_.node_part[at(block_.nodes_of_patch(patch)[0])]; }

  // Node-averaged volumetric strain (element_average.cpp).
  void prepare_average();
  double average_energy(const BlockState& state) const;
  static double lasting_part(const BlockState& state);
  void average(const BlockState& state);
  void average_direction(const BlockState& state, std::span<const Vec3d> dx);
  template <class Theta>
  void average_of(const BlockState& state, std::span<const Vec3d> dx, std::vector<double>& out, const Theta& theta);
  void assemble_average(const BlockState& state, BlockMatrix& matrix);
  void find_reach();
  template <Law L>
  void average_gradients_of_patch(const BlockState& state, int patch);
  void sum_average_gradient(int a);
  void assemble_average_row(int i, double factor, BlockMatrix& matrix) const;

  const ElementBlock& block_;
  const PointSet& set_;
  ThreadPool& pool_;
  std::vector<Vec3d> slot_u_, slot_d_, slot_sum_;
  std::vector<PatchSums> patch_sums_;
  std::vector<double> patch_spin_;
  std::vector<int> lane_part_;         ///< (batches × 8): part of each element; empty where each patch lies in one
  std::vector<double> lane_rounding_;  ///< likewise: squares of rounding [N²]
  double elastic_ = 0, viscous_ = 0;
  std::uint64_t pattern_ = 0;              ///< of the matrix in which these are:
  std::vector<std::uint32_t> pair_slot_;   ///< (batches × pairs × 8): place of a block's values
  std::vector<std::uint8_t> pair_stride_;  ///< likewise: length of its rows; empty where all nodes are vertices

  std::vector<double> node_volume_, node_modulus_;  ///< of averaging: Σ V/4 [m³], mean k [Pa]
  std::vector<double> slot_theta_;                  ///< Σ V θ/4 by patch
  std::vector<double> node_pressure_, node_theta_;  ///< k times the mean of θ, and of its derivative [Pa]
  std::vector<double> kept_pressure_;               ///< while stresses are stored
  /// Nodes whose places change the mean about each node: those of the elements around it. Empty until it is assembled.
  struct Reach {
    std::vector<int> begin, node;           ///< (nodes + 1), ascending
    std::vector<int> corner_begin, corner;  ///< of the elements around each node: corner 4 e + c of element e is it
    std::vector<std::uint16_t> slot;        ///< (corners × 4): place of its element's corners among `node`
    std::vector<Vec3d> element_gradient;    ///< (corners) V/4 ∂θ/∂x of each element [m²]
    std::vector<Vec3d> gradient;            ///< of `node`, Σ of these over the elements around

    std::span<const int> nodes(int a) const {
      return std::span(node).subspan(at(begin[at(a)]), at(begin[at(a) + 1] - begin[at(a)]));
    }
    std::span<const int> corners(int a) const {
      return std::span(corner).subspan(at(corner_begin[at(a)]), at(corner_begin[at(a) + 1] - corner_begin[at(a)]));
    }
  };
  Reach reach_;
};

}  // namespace fascia
