#pragma once

#include "core/base/thread_pool.hpp"
#include "core/executor/element_executor.hpp"
#include "core/executor/follower_tangent.hpp"
#include "core/executor/shell_executor.hpp"
#include "core/executor/surface_tangent.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/physics/point_physics.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Sums over all points [J].
struct InternalEnergy {
  double elastic = 0, stabilization = 0, viscous = 0;  ///< springs count as elastic, tethers as stabilisation
  double total() const { return elastic + stabilization + viscous; }
};

/// Strains at the start of a time step, for stiffness damping.
struct StrainHistory {
  /// (groups × 6 × 8, then points of element batches × 6 × 8): 11 22 33 23 13 12; then batches of shells × 12 × 8; or
  /// empty
  AlignedVector<double> E;
  double inverse_step = 0;  ///< 1/dt [1/s]; 0 switches the viscous stress off
};

/// A step of Newton's method, along which stresses are extrapolated for the tangent where it ends.
struct TakenStep {
  std::vector<Vec3d> u;   ///< where it started: displacements [m]
  FrameMatrices D;        ///< and rotations − I
  std::vector<double> d;  ///< its direction times its length, by degrees of freedom
};

/// What an assembly must fill: all blocks, or at least those of the diagonal.
enum class Entries { all, diagonal };

/// The second derivative of the internal energy at a state. It stays valid as long as it is held.
struct Linearization {
  static constexpr int kRows = 27;  ///< of a group
  Tangent tangent = Tangent::full;
  double inverse_step = 0;          ///< of the viscous stress
  std::vector<Mat3d> Q;             ///< I + D of each frame
  std::vector<double> node_blocks;  ///< what acts on one frame alone, by rows: rotation-rotation terms, inertia, loads
  AlignedVector<double> points;     ///< (groups × kRows × 8): H (9), Dbar (9), S (6), drilling (3)
  std::vector<Vec3d> u;             ///< displacements
  std::vector<Mat3d> D;             ///< rotations − I, where there are shells
  AlignedVector<double> E;          ///< StrainHistory::E, where elements or shells are damped
  bool extrapolated = false;        ///< stresses are extrapolated
  AlignedVector<double> stress;     ///< such stresses of elements and shells, in the layout of E
  std::vector<SurfaceTangent> surfaces;    ///< of surface loads; added by who knows them, as to node_blocks
  std::vector<RankOne> low_rank;           ///< terms that no matrix holds; products have them
  std::vector<FollowerTangent> followers;  ///< as those of surfaces
  std::vector<TorqueTangent> torques;

  /// Loads have a potential: nothing is beside the symmetric part, which matrices and products hold.
  bool symmetric() const;
};

/// Executes a point set on the processor: one pass over groups of points, one gather over frames. No atomics, sums in
/// fixed order: results do not depend on the number of threads.
class CpuExecutor {
 public:
  CpuExecutor(const PointSet& set, ThreadPool& pool);

  /// Where tethers pull to: (groups with axes × 3 × 8) [m]. Zero at first.
  std::span<double> targets() { return targets_; }

  /// Where a step starts: increments of its states carry the rounding of that motion.
  void start_from(const State& state);

  /// Gradient of the internal energy by degrees of freedom: force, then torque or what is conjugate to A (overwritten).
  /// Along u ← u + dx, Q ← exp(dr) Q or A ← A + dA the energy changes by gradient · (dx, dr or dA).
  InternalEnergy gradient(const State& state, const StrainHistory& history, std::span<double> gradient);

  /// The same without energies and without what linearize() needs.
  void forces(const State& state, const StrainHistory& history, std::span<double> gradient);

  /// Tangent at the state of the last call of gradient(), which must have been `state`.
  /// @param tethers_turn  false leaves out what the pull of tethers does to turning frames: a place that is still far
  ///                      from its target pulls so hard that the full tangent is indefinite
  /// @param taken  the step that led here: stresses of the geometric part are extrapolated along it
  void linearize(const State& state, const StrainHistory& history, Tangent tangent, Linearization& out,
                 bool tethers_turn = true, const TakenStep* taken = nullptr);

  /// y = K x without a matrix.
  void multiply(const Linearization& at, std::span<const double> x, std::span<double> y);

  /// The largest rotation that a direction has in elements [rad]; frames show theirs.
  double largest_spin(std::span<const double> direction);

  /// Fills a matrix made from the same point set.
  void assemble(const Linearization& at, BlockMatrix& matrix, Entries entries = Entries::all);

  /// Keeps the strains of a state.
  void store_strain(const State& state, StrainHistory& history);

  /// Elastic energy of a block of elements, a spring or a shell at the last call of gradient() [J].
  double block_elastic(int block) const { return elements_[static_cast<std::size_t>(block)].elastic(); }
  double spring_energy(int spring) const { return spring_energy_[static_cast<std::size_t>(spring)]; }
  double shell_elastic(int shell) const { return shells_[static_cast<std::size_t>(shell)].elastic(); }
  /// Elastic and stabilisation energy of each group at the last call of gradient() [J].
  std::span<const double> group_elastic() const { return group_elastic_; }
  std::span<const double> group_stabilization() const { return group_stabilization_; }

  /// Σ |force|² of a connected part's tethers at the last call of gradient() [N²]; and the force on one of them [N].
  double squared_tether_force(int part) const { return part_tether_[static_cast<std::size_t>(part)]; }
  Vec3d tether_force(const Tether& tether, const State& state) const;
  /// From the place that a tether holds to its target [m].
  Vec3d tether_stretch(const Tether& tether, const State& state) const;
  /// Of a spring on its node [N].
  static Vec3d spring_force(const Spring& spring, const State& state);

  /// What a range of groups adds to the gradient of a node at the last call of gradient(): force, and what is conjugate
  /// to A. Products and tangents with extrapolated stresses overwrite it.
  struct NodeGradient {
    Vec3d force{};
    Mat3d N{};
  };
  NodeGradient gradient_of_groups(int first, int count, int node) const;

  /// What rounding alone leaves in the gradient of a connected part, as a norm with torques divided by the part's
  /// length, at the last call of gradient() [N]. It grows with the part's motion there and at the start of the step.
  double rounding(int part) const { return part_rounding_[static_cast<std::size_t>(part)]; }

  /// The largest displacement of a part, or rotation at its length, that this rounding came from [m].
  double motion(int part) const { return part_motion_[static_cast<std::size_t>(part)]; }

  ThreadPool& pool() { return pool_; }

 private:
  /// @param block  of elements, then of shells
  std::span<const double> strain_of_block(const AlignedVector<double>& E, std::size_t block) const;
  /// Extrapolated stresses of a block; empty where the tangent takes those of the state.
  std::span<const double> stress_of_block(const Linearization& lin, std::size_t block) const;
  ElementExecutor::At element_at(const Linearization& lin, std::size_t block) const;
  ShellExecutor::At shell_at(const Linearization& lin, std::size_t shell) const;
  /// @param all  with energies, rounding, and what linearize() needs
  void sum_terms(const State& state, const StrainHistory& history, bool all, std::span<double> gradient);
  void sum_forces(const State& state, bool keep_moments, std::span<double> gradient);
  template <PointKind Kind>
  void gradient_of_group(const State& state, const StrainHistory& history, int group, bool all);
  template <PointKind Kind>
  void linearize_group(const State& state, const StrainHistory& history, int group, const TakenStep* taken,
                       Linearization& out);
  void linearize_points(const State& state, const StrainHistory& history, const TakenStep* taken, Linearization& out);
  void extrapolate_blocks(const StrainHistory& history, const TakenStep& taken, Linearization& out);
  void spread_direction(std::span<const double> x, const std::vector<Mat3d>& Q);
  std::span<const Vec3d> translations(std::span<const double> x);
  std::size_t block_strains_begin() const { return static_cast<std::size_t>(set_.group_count()) * 6 * kGroupSize; }
  void note_motion(const State& state, std::span<const double> least, std::span<double> motion) const;
  void add_spring_forces(const State& state, std::span<double> gradient) const;
  double note_springs(const State& state);
  void linearize_springs(const State& state, Linearization& out) const;
  template <PointKind Kind>
  void multiply_group(const Linearization& at, int group);
  template <PointKind Kind>
  void assemble_group(const Linearization& at, int group, Entries entries, BlockMatrix& matrix) const;
  const PointRule& rule_of(int group) const { return set_.rule[static_cast<std::size_t>(group)].rule; }

  const PointSet& set_;
  ThreadPool& pool_;
  std::vector<ElementExecutor> elements_;
  std::vector<ShellExecutor> shells_;
  std::vector<std::size_t> strain_begin_;  ///< of each block in StrainHistory::E
  std::vector<Vec3d> element_direction_;
  AlignedVector<double> slot_sums_;  ///< (slots × 12): Σ v P g (3), Σ v (P Bᵀ + w Y) (9)
  std::vector<double> group_elastic_, group_stabilization_, group_viscous_, group_rounding_, group_tether_;
  std::vector<double> spring_energy_;
  std::vector<double> part_motion_, start_motion_, part_rounding_, part_tether_;
  AlignedVector<double> targets_;
  std::vector<Mat3d> node_L_;  ///< L of the last gradient, of rigid frames
  std::vector<Mat3d> extrapolated_L_;
  std::vector<char> slot_is_tether_;  ///< empty where there are none
  std::vector<Mat3d> tether_L_;       ///< the part of tethers; empty where there are none
  AlignedVector<double> directions_;  ///< (nodes × 12): dx (3), dA (9)
};

}  // namespace fascia
