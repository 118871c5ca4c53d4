#pragma once

#include "core/base/aligned.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/shell_constants.hpp"
#include "core/physics/viscosity.hpp"
#include "core/structure/element_block.hpp"
#include "core/structure/stress_memory.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// A triangle of a shell as a builder describes it.
struct ShellElementSpec {
  std::array<int, 3> node{};       ///< rigid frames of the model
  Mat3d axes = Mat3d::identity();  ///< T₀: columns in the plane, then the normal
  ShellConstants<double> constants{};
  double stiffness_damping = 0;  ///< β [s]
  std::shared_ptr<const Viscosity> viscosity{};
  int source = -1;  ///< which triangle of its body it is, where stresses fade
};

/// Triangles of shells in batches of eight, one a lane (array of structures of arrays). Unused lanes repeat the last
/// triangle without stiffness; a triangle's nodes are in ascending order.
struct ShellBlock {
  int count = 0;
  double length = 1;  ///< mean length of the edges [m]
  bool damped = false;
  std::vector<int> node;            ///< (batches × 3 × 8)
  AlignedVector<double> constants;  ///< (batches × kRows × 8)

  /// (batches × 8) what fades of the stress of each triangle; empty where nothing does
  std::vector<std::shared_ptr<const Viscosity>> viscosity;
  std::vector<int> source;  ///< (triangles) ShellElementSpec::source

  std::vector<int> node_slot_begin, node_slot;   ///< of each node of the model: 3 · triangle + corner, ascending
  std::vector<int> color_begin{0}, color_batch;  ///< batches of one colour share no node

  /// Rows of `constants`.
  static constexpr int kGradients = 0, kAxes = 6, kMembrane = 15, kBending = kMembrane + kPacked6,
                       kDamping = kBending + kPacked6, kRows = kDamping + 1;

  /// A triangle remembers twelve strains, in two lanes: those of its membrane, and eight lanes on those of its bending.
  /// Its stress is linear in them, so that what fades is strain as well.
  std::vector<StressBeside> beside_of_lanes() const;
  static std::size_t memory_lane(int triangle) {
    const auto t = static_cast<std::size_t>(triangle);
    return t / kElementLanes * 2 * kElementLanes + t % kElementLanes;
  }
  int batch_count() const { return (count + kElementLanes - 1) / kElementLanes; }
  const double* constants_of(int batch) const {
    return constants.data() + static_cast<std::size_t>(batch) * kRows * kElementLanes;
  }
  const int* nodes_of(int batch) const { return node.data() + static_cast<std::size_t>(batch) * 3 * kElementLanes; }
  static constexpr bool averaged = false;  ///< as ElementBlock has it
  static constexpr int nodes = 3;          ///< of a triangle
  /// Calls act(nodes, membrane stiffness of its area over the mean length [Pa]) for each triangle, as all blocks do
  /// (blocks.hpp): small triangles are as stiff as large ones.
  template <class Act>
  void for_each_cell(const Act& act) const {
    for (int e = 0; e < count; ++e) {
      const std::array<int, 3> corners = element(e);
      act(std::span<const int>(corners), membrane_by_area(e) / length);
    }
  }
  /// C t of a triangle, C the stiffness of plane stress [N/m].
  double membrane_by_area(int triangle) const {
    const double* rows = constants_of(triangle / kElementLanes) + triangle % kElementLanes;
    const auto g = [&](int k) { return rows[(kGradients + k) * kElementLanes]; };
    const double twice_area = 1 / std::abs(g(0) * g(3) - g(1) * g(2));
    return 2 * rows[kMembrane * kElementLanes] / twice_area;
  }
  /// Σ C |g|² over triangles and nodes, C the membrane stiffness: as that of elements [N/m].
  double stiffness_sum() const;
  std::array<int, 3> element(int e) const {
    const int* n = nodes_of(e / kElementLanes) + e % kElementLanes;
    return {n[0], n[kElementLanes], n[2 * kElementLanes]};
  }
};

/// @throws InputError  a viscosity that no material has, or that relaxes in shear alone
ShellBlock make_shell_block(std::span<const ShellElementSpec> elements, double length);

/// Fills slots by node and colours. @param nodes_of_model  their number
void finish_shell_block(ShellBlock& block, int nodes_of_model);

}  // namespace fascia
