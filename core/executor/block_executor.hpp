#pragma once

#include "core/base/aligned.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/point_physics.hpp"
#include "core/structure/model.hpp"

#include <cmath>
#include <concepts>
#include <span>
#include <vector>

/// A kind of block: matter between nodes, as CpuExecutor walks it. A new kind is a class that satisfies IsBlockExecutor
/// and a place in the list of CpuExecutor.
namespace fascia {

class BlockMatrix;

/// Sums over all points [J].
struct InternalEnergy {
  double elastic = 0, stabilization = 0, viscous = 0;  ///< springs count as elastic, tethers as stabilisation
  double total() const { return elastic + stabilization + viscous; }
  /// The sizes of its terms add up; those of stresses that fade have any sign.
  double size() const { return std::abs(elastic + stabilization) + std::abs(viscous); }
  InternalEnergy& operator+=(const InternalEnergy& other) {
    elastic += other.elastic;
    stabilization += other.stabilization;
    viscous += other.viscous;
    return *this;
  }
};

/// Holds the elastic energy of each group of points, block of elements, shell, user block and spring, and the
/// stabilisation of groups [J].
struct BlockEnergies {
  std::vector<double> groups, stabilization, blocks, shells, user_blocks, springs;

  /// Calls act(elastic energy, stabilisation) for each group, block of elements and shell of a body.
  template <class Act>
  void for_each(const BodyBlocks& of, const Act& act) const {
    of.groups.for_each([&](std::size_t g) { act(groups[g], stabilization[g]); });
    of.elements.for_each([&](std::size_t b) { act(blocks[b], 0.0); });
    of.shells.for_each([&](std::size_t b) { act(shells[b], 0.0); });
  }
};

/// An assembly must fill all entries, or at least those of the diagonal.
enum class Entries { all, diagonal };

/// A state as a block sees it. The arrays belong to the caller; those of the block are in its own layout.
struct BlockState {
  std::span<const Vec3d> u;   ///< displacement of each node of the model [m]
  std::span<const Mat3d> D;   ///< its rotation − I, or A − I; empty where no block asks for it
  std::span<const double> E;  ///< of the block: strains at the start of the step, or empty
  double inverse_step = 0;    ///< of damping [1/s]
  Tangent tangent = Tangent::full;
  std::span<const double> kept{};   ///< of the block: what linearize() kept of this state
  std::span<const double> given{};  ///< of the block: rows of its lanes by GivenRow, or empty
};

/// A motion of all nodes.
struct BlockDirection {
  std::span<const double> d;        ///< by degrees of freedom
  std::span<const Vec3d> dx;        ///< (nodes) displacements; empty where no block asks for them
  std::span<const double> motions;  ///< (nodes × 12) dx (3), dA (9), by rows; likewise
};

/// Blocks give a node a force, a torque, and what is conjugate to A (add_moment()).
struct NodeSum {
  Vec3d force{}, torque{};
  Mat3d N{};
};

/// Sums over threads are in a fixed order: results do not depend on the number of threads.
template <class B>
concept IsBlockExecutor = requires(B& block, const B& same, const BlockState& state, const BlockDirection& direction,
                                   std::span<const double> part_motion, std::span<double> out, NodeSum& sum,
                                   BlockMatrix& matrix) {
  { B::kSeesMotions } -> std::convertible_to<bool>;       ///< of directions; otherwise d
  { B::kSeesTranslations } -> std::convertible_to<bool>;  ///< likewise
  { B::kSeesStateAgain } -> std::convertible_to<bool>;    ///< products need more of a state than what it kept
  { same.empty() } -> std::same_as<bool>;
  { same.strain_size() } -> std::same_as<std::size_t>;
  block.store_strain(state, out);
  /// Blocks that remember it store what fades, as strains lie: second Piola-Kirchhoff stress, shells their strains.
  block.store_stress(state, out);
  /// The gradient of the energy, for add_sums(). `true`: energies, and rounding by the parts' motion, too.
  block.compute_forces(state, true, part_motion);
  /// Keeps what products need of a state. @param start, step  where a step led to it: stresses are extrapolated along
  /// it
  { same.kept_size(true) } -> std::same_as<std::size_t>;
  block.linearize(state, &state, &direction, out);
  block.compute_product(state, direction);
  block.assemble(state, matrix, Entries::all);
  same.add_sums(0, sum);  ///< of the last forces or product
  { same.energy() } -> std::same_as<InternalEnergy>;
  same.add_rounding(out);                                     ///< squares of it by connected part [N²]
  { block.largest_spin(direction) } -> std::same_as<double>;  ///< within the block; frames show theirs [rad]
};

}  // namespace fascia
