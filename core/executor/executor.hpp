#pragma once

#include "core/base/thread_pool.hpp"
#include "core/executor/element_executor.hpp"
#include "core/executor/load_tangent.hpp"
#include "core/executor/point_executor.hpp"
#include "core/executor/shell_executor.hpp"
#include "core/executor/spring_executor.hpp"
#include "core/executor/user_executor.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/space/part_sums.hpp"
#include "core/space/pool_space.hpp"

#include <span>
#include <tuple>
#include <vector>

namespace fascia {

/// Strains at the start of a time step, for stiffness damping, and what points that remember stresses add.
struct StrainHistory {
  /// By blocks, in their order: (groups × 6 × 8, then points of element batches × 6 × 8): 11 22 33 23 13 12; then
  /// batches of shells × 12 × 8; or empty
  AlignedVector<double> E;
  double inverse_step = 0;          ///< 1/dt [1/s]; 0 switches the viscous stress off
  std::span<const double> given{};  ///< (lanes × kGivenRows) of the caller's, see StressMemory; empty: nothing fades
};

/// A step of Newton's method, along which stresses are extrapolated for the tangent where it ends.
struct TakenStep {
  std::vector<Vec3d> u;   ///< where it started: displacements [m]
  FrameMatrices D;        ///< and rotations − I
  std::vector<double> d;  ///< its direction times its length, by degrees of freedom
};

/// The second derivative of the internal energy at a state. It stays valid as long as it is held.
struct Linearization {
  Tangent tangent = Tangent::full;
  double inverse_step = 0;          ///< of the viscous stress
  std::vector<Mat3d> Q;             ///< I + D of each frame
  std::vector<double> node_blocks;  ///< what acts on one frame alone, by rows: rotation-rotation terms, inertia, loads
  std::vector<Vec3d> u;             ///< displacements
  std::vector<Mat3d> D;             ///< rotations − I
  AlignedVector<double> E;          ///< StrainHistory::E, where blocks look at the state again
  AlignedVector<double> given;      ///< StrainHistory::given
  AlignedVector<double> kept;       ///< what blocks keep of the state, in their order
  std::vector<std::size_t> kept_begin;  ///< (blocks + 1)
  LoadTangent loads;                    ///< added by who knows them, as to node_blocks
};

/// Executes a point set on the processor: one pass over its blocks, one gather over nodes. No atomics, sums in fixed
/// order: results do not depend on the number of threads.
class CpuExecutor {
 public:
  CpuExecutor(const PointSet& set, ThreadPool& pool);

  /// Where tethers pull to: (groups with axes × 3 × 8) [m]. Zero at first.
  std::span<double> targets() { return std::get<Several<PointExecutor>>(blocks_).front().targets(); }

  /// Where a step starts: increments of its states carry the rounding of that motion.
  void start_from(const State& state);
  /// Changes where cells of user blocks have changed, so that the pattern of the matrix has: gradient() and forces()
  /// follow them.
  /// @throws (these two) InputError  a cell that names a node that there is not; the block is followed no further
  long pattern() const { return pattern_; }

  /// Gradient of the internal energy by degrees of freedom: force, then torque or what is conjugate to A (overwritten).
  /// Along u ← u + dx, Q ← exp(dr) Q or A ← A + dA the energy changes by gradient · (dx, dr or dA).
  InternalEnergy gradient(const State& state, const StrainHistory& history, std::span<double> gradient);

  /// Gradient of the internal energy like gradient(), without energies and without what linearize() needs.
  void forces(const State& state, const StrainHistory& history, std::span<double> gradient);

  /// Tangent at the state of the last call of gradient(), which must have been `state`.
  /// @param tethers_turn  false leaves out what the pull of tethers does to turning frames: a place that is still far
  ///                      from its target pulls so hard that the full tangent is indefinite
  /// @param taken  the step that led here: stresses of the geometric part are extrapolated along it
  void linearize(const State& state, const StrainHistory& history, Tangent tangent, Linearization& out,
                 bool tethers_turn = true, const TakenStep* taken = nullptr);

  /// y = K x without a matrix.
  void multiply(const Linearization& at, std::span<const double> x, std::span<double> y);

  /// The longest part of a step along a direction, up to 1, that user blocks allow. @param Q  I + D of each frame
  double largest_step(const State& state, std::span<const double> direction, const std::vector<Mat3d>& Q);

  /// The largest rotation that a direction has in elements [rad]; frames show theirs.
  double largest_spin(std::span<const double> direction);

  /// Fills a matrix made from the same point set.
  void assemble(const Linearization& at, BlockMatrix& matrix, Entries entries = Entries::all);

  /// Stores the strains of a state, as StrainHistory has them.
  void store_strain(const State& state, AlignedVector<double>& E);
  /// Stores what fades of points that remember it: second Piola-Kirchhoff stress, of shells strains.
  /// @param given  with these rows
  /// @param out    (lanes × 6)
  void store_stress(const State& state, std::span<const double> given, std::span<double> out);

  /// Stores what each slot of the groups of points has of their forces at a state, for sum_of_groups().
  void store_slot_sums(const State& state, const StrainHistory& history, std::vector<double>& out);

  /// Energies as the last call of gradient() found them.
  BlockEnergies energies() const;
  /// Groups of points, with their tethers. Products and tangents with extrapolated stresses overwrite their sums.
  const PointExecutor& points() const { return of_kind<PointExecutor>().front(); }

  /// Norm of what rounding alone leaves in the gradient of a connected part, with torques divided by the part's length,
  /// at the last call of gradient() [N]. It grows with the part's motion there and at the start of the step.
  double rounding(int part) const { return part_rounding_[static_cast<std::size_t>(part)]; }

  /// The largest displacement of a part, or rotation at its length, that this rounding came from [m].
  double motion(int part) const { return part_motion_[static_cast<std::size_t>(part)]; }

  ThreadPool& pool() { return pool_; }

  /// Evaluations of forces by all executors of this process so far. Tests see by it where results were evaluated.
  static long evaluations();

 private:
  template <class Kind>
  using Several = std::vector<Kind>;
  /// Kinds of blocks, in the order in which their strains and what they keep lie, and in which nodes sum them. Points,
  /// which there are always, come first: they clear the matrix to which the others add.
  using Blocks =
      std::tuple<Several<PointExecutor>, Several<ElementExecutor>, Several<ShellExecutor>, Several<UserExecutor>>;
  template <class Kind>
  const Several<Kind>& of_kind() const {
    return std::get<Several<Kind>>(blocks_);
  }
  /// Calls act(block, its number) for all.
  template <class Act>
  void for_each_block(const Act& act) {
    std::size_t number = 0;
    const auto each = [&](auto& blocks) {
      for (auto& block : blocks) act(block, number++);
    };
    std::apply([&](auto&... kinds) { (each(kinds), ...); }, blocks_);
  }
  /// A block sees a state, or a linearisation, with its own part of arrays over all blocks.
  BlockState state_of(const State& state, const StrainHistory& history, std::size_t block) const;
  BlockState state_of(const Linearization& lin, std::size_t block) const;
  /// A motion as blocks see it. @param Q  I + D where it starts
  BlockDirection direction_of(std::span<const double> d, const std::vector<Mat3d>& Q);
  std::span<const Vec3d> translations_of(std::span<const double> d);
  NodeSum sum_at(int node);
  /// @param all  with energies, rounding, and what linearize() needs
  void sum_terms(const State& state, const StrainHistory& history, bool all, std::span<double> gradient);
  void sum_forces(const State& state, bool keep_moments, std::span<double> gradient);
  void linearize_blocks(const State& state, const StrainHistory& history, const TakenStep* taken, Linearization& out);
  void note_motion(const State& state, std::span<double> motion);

  const PointSet& set_;
  ThreadPool& pool_;
  PoolSpace space_;
  PartSums<PoolSpace> node_parts_;
  Blocks blocks_;
  SpringExecutor springs_;
  long pattern_ = 0;
  std::vector<std::size_t> strain_begin_;  ///< (blocks + 1): of each in StrainHistory::E
  bool see_motions_ = false, see_translations_ = false, see_state_again_ = false;  ///< some block does
  std::vector<double> part_motion_, start_motion_, part_rounding_;
  std::vector<Mat3d> node_L_;  ///< L of the last gradient, of rigid frames
  std::vector<Mat3d> extrapolated_L_;
  std::vector<Mat3d> tether_L_;      ///< the part of tethers; empty where there are none
  std::vector<Vec3d> translations_;  ///< (nodes) of the last direction
  AlignedVector<double> motions_;    ///< (nodes × 12) likewise
};

}  // namespace fascia
