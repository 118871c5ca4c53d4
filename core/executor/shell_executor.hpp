#pragma once

#include "core/base/index.hpp"
#include "core/base/thread_pool.hpp"
#include "core/physics/point_physics.hpp"
#include "core/structure/point_set.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

class BlockMatrix;

/// What a block of shell triangles does at a state, as CpuExecutor asks for it: forces on frames, products with the
/// tangent, its entries. Batches are computed in parallel; frames add up their triangles in fixed order.
class ShellExecutor {
 public:
  ShellExecutor(const ShellBlock& block, const PointSet& set, ThreadPool& pool);

  /// State at which something is computed. The arrays belong to the caller.
  struct At {
    std::span<const Vec3d> u;   ///< displacement of each node of the model [m]
    std::span<const Mat3d> D;   ///< its rotation − I
    std::span<const double> e;  ///< strains at the start of the step (batches × 12 × 8), or empty
    double inverse_step = 0;    ///< of damping [1/s]
    Tangent tangent = Tangent::full;
    std::span<const double> s{};  ///< stresses of the tangent, in the layout of e; empty: those of the state
  };
  struct Force {
    Vec3d force{}, torque{};
  };

  std::size_t strain_size() const { return at(block_.batch_count()) * 12 * kElementLanes; }
  void store_strain(const At& state, std::span<double> e);
  /// Stresses extrapolated along a step d from a state, by degrees of freedom. @param s  in the layout of e
  void extrapolate(const At& start, std::span<const double> d, std::span<double> s);

  /// The gradient of the energy, by triangle. @param energies  energies and rounding too
  void compute_forces(const At& state, bool energies, std::span<const double> part_motion);
  /// The same of K d at a state. @param d  by degrees of freedom of the model
  void compute_product(const At& state, std::span<const double> d);
  /// What the last of these gave a node.
  Force sum_at(int node) const;

  /// Adds K to a matrix of the set's pattern.
  void assemble(const At& state, BlockMatrix& matrix);

  /// Of the last forces with energies: [J], and squares of rounding by connected part [N²].
  double elastic() const { return elastic_; }
  double viscous() const { return viscous_; }
  void add_rounding(std::span<double> squares_of_parts) const;

 private:
  struct Sums {
    double elastic = 0, viscous = 0, rounding = 0;
  };
  void forces_of_batch(const At& state, int batch, bool energies, double motion);
  void product_of_batch(const At& state, int batch, std::span<const double> d);
  void assemble_batch(const At& state, int batch, BlockMatrix& matrix) const;
  void find_pair_slots(const BlockMatrix& matrix);
  int part_of_batch(int batch) const { return set_.node_part[at(block_.nodes_of(batch)[0])]; }

  const ShellBlock& block_;
  const PointSet& set_;
  ThreadPool& pool_;
  std::vector<double> slot_sums_;  ///< (batches × 8 × 18): force and torque of each corner
  std::vector<Sums> sums_;         ///< (batches)
  double elastic_ = 0, viscous_ = 0;
  std::vector<std::uint32_t> pair_slot_;  ///< (batches × 6 × 8): place of a block's values
};

}  // namespace fascia
