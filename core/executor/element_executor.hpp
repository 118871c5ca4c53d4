#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/physics/point_physics.hpp"
#include "core/structure/element_block.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

class BlockMatrix;

/// What a block of elements does at a state, as CpuExecutor asks for it: forces on vertices, products with the tangent,
/// its entries. Patches are computed in parallel, each in a fixed order.
class ElementExecutor {
 public:
  ElementExecutor(const ElementBlock& block, const PointSet& set, ThreadPool& pool);

  /// State at which something is computed. The arrays belong to the caller.
  struct At {
    std::span<const Vec3d> u;   ///< displacement of each node of the model [m]
    std::span<const double> E;  ///< strains at the start of the step (batches × points × 6 × 8), or empty
    double inverse_step = 0;    ///< of damping [1/s]
    Tangent tangent = Tangent::full;
    std::span<const double> S{};  ///< stresses of the tangent, in the layout of E; empty: those of the state
  };

  std::size_t strain_size() const;
  void store_strain(std::span<const Vec3d> u, std::span<double> E);
  /// Stresses extrapolated along a step dx from a state. @param S  in the layout of E
  void extrapolate(const At& start, std::span<const Vec3d> dx, std::span<double> S);

  /// Sums forces (the gradient of the energy) by patch. @param energies  energies and rounding too
  void compute_forces(const At& state, bool energies, std::span<const double> part_motion);
  /// The same of K dx at a state. @param dx  by node (3 a node)
  void compute_product(const At& state, std::span<const Vec3d> dx);
  /// What the last of these gave a node.
  Vec3d sum_at(int node) const {
    Vec3d sum;
    for (int k = block_.node_slot_begin[at(node)]; k < block_.node_slot_begin[at(node + 1)]; ++k)
      sum += slot_sum_[at(block_.node_slot[at(k)])];
    return sum;
  }

  /// The largest rotation that a motion has at a point, to first order [rad]; 0 of the linear law, which has no use for
  /// it.
  double largest_spin(std::span<const Vec3d> dx);

  /// Adds K to a matrix of the set's pattern.
  void assemble(const At& state, BlockMatrix& matrix);

  /// Of the last forces with energies: [J], and squares of rounding by connected part [N²].
  double elastic() const { return elastic_; }
  double viscous() const { return viscous_; }
  void add_rounding(std::span<double> squares_of_parts) const;

 private:
  struct PatchSums {
    double elastic = 0, viscous = 0, rounding = 0;
  };
  template <Law L, int N>
  void forces_of_patch(const At& state, int patch, std::span<const double> part_motion);
  template <Law L, int N>
  void product_of_patch(const At& state, int patch, std::span<const Vec3d> dx);
  template <Law L, int N>
  void assemble_patch(const At& state, int patch, BlockMatrix& matrix);
  template <Law L, int N>
  void strain_of_patch(int patch, std::span<double> E) const;
  template <int N>
  double spin_of_patch(int patch) const;
  template <Law L, int N>
  void extrapolate_patch(const At& start, int patch, std::span<double> S) const;
  void gather_patch(std::span<const Vec3d> values, int patch, std::vector<Vec3d>& out) const;
  void find_pair_slots(const BlockMatrix& matrix);

  void find_lane_parts();
  Lanes lane_motion(int batch, int half, std::span<const double> part_motion) const;
  int part_of_patch(int patch) const { return set_.node_part[at(block_.nodes_of_patch(patch)[0])]; }

  // Node-averaged volumetric strain (element_average.cpp).
  void prepare_average();
  double average_energy() const;
  void average(const At& state);
  void average_direction(const At& state, std::span<const Vec3d> dx);
  template <class Theta>
  void average_of(const At& state, std::span<const Vec3d> dx, std::vector<double>& out, const Theta& theta);
  void assemble_average(const At& state, BlockMatrix& matrix);

  const ElementBlock& block_;
  const PointSet& set_;
  ThreadPool& pool_;
  std::vector<Vec3d> slot_u_, slot_d_, slot_sum_;
  std::vector<PatchSums> patch_sums_;
  std::vector<double> patch_spin_;
  std::vector<int> lane_part_;         ///< (batches × 8): part of each element; empty where each patch lies in one
  std::vector<double> lane_rounding_;  ///< likewise: squares of rounding [N²]
  double elastic_ = 0, viscous_ = 0;
  std::vector<std::uint32_t> pair_slot_;   ///< (batches × pairs × 8): place of a block's values
  std::vector<std::uint8_t> pair_stride_;  ///< likewise: length of its rows; empty where all nodes are vertices

  std::vector<double> node_volume_, node_modulus_;  ///< of averaging: Σ V/4 [m³], mean k [Pa]
  std::vector<double> slot_theta_;                  ///< Σ V θ/4 by patch
  std::vector<double> node_pressure_, node_theta_;  ///< λ times the mean of θ, and of its derivative [Pa]
};

}  // namespace fascia
