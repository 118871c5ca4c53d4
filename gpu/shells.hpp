#pragma once

#include "core/model/point_set.hpp"
#include "core/physics/point_physics.hpp"
#include "gpu/array.hpp"
#include "gpu/views.hpp"

#include <vector>

namespace fascia::gpu {

/// Entries of a triangle's symmetric tangent (18 × 18), on and below the diagonal by rows.
inline constexpr int kShellStiffness = 171;

/// One block of triangles, in the layout of core/model/shell_block.hpp.
struct ShellBlockView {
  int count = 0, batches = 0;
  bool damped = false;
  const double* constants = nullptr;  ///< (batches × ShellBlock::kRows × 8)
  const int* node = nullptr;          ///< (batches × 3 × 8)
  double* corners = nullptr;          ///< (batches × 3 × 6 × 8): force and torque of the last pass on each node
  double* quantities = nullptr;       ///< (batches × 8 × kQuantities)
  double* stiffness = nullptr;        ///< (batches × kShellStiffness × 8), of the linearisation
};

/// What all triangles gave the nodes of a model.
struct ShellsView {
  const int *node_begin = nullptr, *node_corner = nullptr;  ///< place of each corner's force, ascending
  const double *corners = nullptr, *stiffness = nullptr;

  /// Adds what the last pass gave a node.
  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    for (int k = node_begin[node]; k < node_begin[node + 1]; ++k) {
      const double* force = corners + node_corner[k];
      for (int i = 0; i < 3; ++i) {
        sums.force[i] += force[i * kElementLanes];
        sums.torque[i] += force[(3 + i) * kElementLanes];
      }
    }
  }
};

/// The triangles of shells of a model on the device: forces and torques on their corners, which frames then gather.
/// A linearisation keeps the tangent of each triangle: as many bytes as all that a product would recompute it from.
template <class Space>
class Shells {
 public:
  explicit Shells(const PointSet& set);

  bool empty() const { return blocks_.empty(); }
  const ShellsView& view() const { return view_; }
  /// (blocks: batches × 12 × 8), as ShellExecutor has them
  std::size_t strain_size() const { return strain_size_; }

  /// Connected part of each item of quantities(), −1 in unused lanes: one item a lane.
  std::vector<int> item_parts(const PointSet& set) const;
  /// (items × kQuantities), of the last forces with them
  const double* quantities() const { return quantities_.data(); }

  /// The gradient of the energy at a pose, for add_sums(). @param part_motion  largest motion of each part (parts) [m];
  /// quantities only where it is given
  void forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history, const double* part_motion);
  /// Keeps the tangents at a pose.
  void linearize(const PoseView& pose, const HistoryView& history, Tangent tangent);
  /// The tangent's product at the linearisation, for add_sums().
  void product(const DirectionView& direction);
  /// Adds the tangent's own block of each node, by rows.
  void add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks);
  /// @param E  (strain_size())
  void store_strain(const PoseView& pose, double* E);

 private:
  struct Block {
    Array<Space, double> constants;
    Array<Space, int> node;
    ShellBlockView view;
    std::size_t strain_begin = 0;
  };
  void find_corners(const PointSet& set);
  /// Strains of one block. @param E  of all
  static HistoryView history_of(const Block& block, const double* E, double inverse_step) {
    return {E == nullptr || !block.view.damped ? nullptr : E + block.strain_begin, inverse_step};
  }

  std::vector<Block> blocks_;
  Array<Space, int> node_begin_, node_corner_, dof_;
  Array<Space, double> corners_, quantities_, stiffness_;
  ShellsView view_;
  int nodes_ = 0;
  std::size_t strain_size_ = 0;
};

}  // namespace fascia::gpu
