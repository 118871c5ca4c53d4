#pragma once

#include "core/cpu/thread_pool.hpp"
#include "core/model/model.hpp"
#include "core/physics/point_physics.hpp"
#include "core/solver/block_matrix.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Sums over all points [J].
struct InternalEnergy {
  double elastic = 0, drilling = 0, viscous = 0;
  double total() const { return elastic + drilling + viscous; }
};

/// Strains at the start of a time step, for stiffness damping.
struct StrainHistory {
  AlignedVector<double> E;  ///< (groups × 6 × 8): 11 22 33 23 13 12; empty where nothing is damped
  double inverse_step = 0;  ///< 1/dt [1/s]; 0 switches the viscous stress off
};

/// The second derivative of the internal energy at a state. It stays valid as long as it is held.
struct Linearization {
  Tangent tangent = Tangent::full;
  double inverse_step = 0;          ///< of the viscous stress
  std::vector<Mat3d> Q;             ///< rotation of each frame
  std::vector<Block6> node_blocks;  ///< what acts on one frame alone: rotation-rotation terms, inertia, loads
  AlignedVector<double> points;     ///< (groups × 24 × 8): H (9), Dbar (9), S (6)
};

/// Executes a point set on the processor: one pass over groups of points, one gather over frames. No atomics, sums in
/// fixed order: results do not depend on the number of threads.
class CpuExecutor {
 public:
  CpuExecutor(const PointSet& set, ThreadPool& pool);

  /// Gradient of the internal energy: 6 numbers a frame, force then torque (overwritten).
  /// Along u ← u + dx, Q ← exp(dr) Q the energy changes by gradient · (dx, dr).
  ///
  InternalEnergy gradient(const State& state, const StrainHistory& history, std::span<double> gradient);

  /// Tangent at the state of the last call of gradient(), which must have been `state`.
  void linearize(const State& state, const StrainHistory& history, Tangent tangent, Linearization& out);

  /// y = K x without a matrix.
  void multiply(const Linearization& at, std::span<const double> x, std::span<double> y);

  /// Fills a matrix made from the same point set.
  void assemble(const Linearization& at, BlockMatrix& matrix);

  /// Keeps the strains of a state.
  void store_strain(const State& state, StrainHistory& history);

  /// Elastic and drilling energy of each group at the last call of gradient() [J].
  std::span<const double> group_elastic() const { return group_elastic_; }
  std::span<const double> group_drilling() const { return group_drilling_; }

  /// What rounding alone leaves in the gradient of a connected part, as a norm with torques divided by the part's
  /// length, at the last call of gradient() [N]. It grows with the largest motion that the part ever went through here.
  double rounding(int part) const { return part_rounding_[static_cast<std::size_t>(part)]; }

  ThreadPool& pool() { return pool_; }

 private:
  template <bool Drilling>
  void gradient_of_groups(const State& state, const StrainHistory& history, int begin, int end);
  void note_motion(const State& state);
  template <bool Drilling>
  void multiply_groups(const Linearization& at, int begin, int end);
  template <bool Drilling>
  void assemble_group(const Linearization& at, int group, BlockMatrix& matrix) const;

  const PointSet& set_;
  ThreadPool& pool_;
  bool drilling_ = false;
  AlignedVector<double> slot_sums_;  ///< (slots × 12): Σ v P g (3), Σ v (P Bᵀ + w Y) (9)
  std::vector<double> group_elastic_, group_drilling_, group_viscous_, group_rounding_;
  std::vector<double> part_motion_, part_rounding_;
  std::vector<Mat3d> node_L_;         ///< L of the last gradient
  AlignedVector<double> directions_;  ///< (nodes × 12): dx (3), [dr]× Q (9)
};

}  // namespace fascia
