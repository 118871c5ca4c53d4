#pragma once

#include "core/physics/point_physics.hpp"
#include "core/solver/settings.hpp"
#include "core/space/array.hpp"
#include "core/structure/point_set.hpp"
#include "gpu/space/views.hpp"

#include <type_traits>
#include <utility>
#include <vector>

namespace fascia::gpu {

/// Entries of a triangle's symmetric tangent (18 × 18), on and below the diagonal by rows.
inline constexpr int kShellStiffness = 171;

/// One block of triangles, in the layout of core/structure/shell_block.hpp, with what passes leave of a scalar T.
template <class T>
struct ShellBlockOf {
  int count = 0, batches = 0;
  bool damped = false;
  const double* constants = nullptr;  ///< (batches × ShellBlock::kRows × 8)
  const int* node = nullptr;          ///< (batches × 3 × 8)
  T* corners = nullptr;               ///< (batches × 3 × 6 × 8): force and torque of the last pass on each node
  double* quantities = nullptr;       ///< (batches × 8 × kQuantities)
  T* stiffness = nullptr;             ///< (batches × kShellStiffness × 8), of the linearisation
};

using ShellBlockView = ShellBlockOf<double>;

/// Forces and torques that all triangles gave the nodes of a model.
template <class T>
struct ShellsOf {
  const int *node_begin = nullptr, *node_corner = nullptr;  ///< place of each corner's force, ascending
  const T *corners = nullptr, *stiffness = nullptr;

  /// Adds what the last pass gave a node.
  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    for (int k = node_begin[node]; k < node_begin[node + 1]; ++k) {
      const T* force = corners + node_corner[k];
      for (int i = 0; i < 3; ++i) {
        sums.force[i] += force[i * kElementLanes];
        sums.torque[i] += force[(3 + i) * kElementLanes];
      }
    }
  }
};

using ShellsView = ShellsOf<double>;

/// The triangles of shells of a model on the device: forces and torques on their corners, which frames then gather.
/// A linearisation keeps the tangent of each triangle: as many bytes as all that a product would recompute it from.
template <class Space>
class Shells {
 public:
  explicit Shells(const PointSet& set, Precision precision = Precision::full);

  bool empty() const { return blocks_.empty(); }
  const ShellsView& view() const { return view_of<double>(); }
  /// After a product: with the scalar of products.
  template <class T>
  const ShellsOf<T>& view_of() const {
    return rows<T>().view;
  }
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
  void linearize(const PoseView& pose, const HistoryView& history, Tangent tangent, const TakenStepView& taken = {});
  /// The tangent's product at the linearisation, for add_sums() of view_of<T>(). @tparam T  of the precision
  template <class T, class V>
  void product(const DirectionOf<T, V>& direction);
  /// Adds the tangent's own block of each node, by rows.
  void add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks);
  /// @param E  (strain_size())
  void store_strain(const PoseView& pose, double* E);
  void store_stress(const PoseView& pose, const double* given, double* out);

 private:
  struct Block {
    Array<Space, double> constants;
    Array<Space, int> node;
    ShellBlockView view;
    ShellBlockOf<float> narrow;
    std::size_t strain_begin = 0;
    std::size_t memory_begin = 0;  ///< first of its lanes
    bool remembers = false;

    template <class T>
    const ShellBlockOf<T>& view_of() const {
      if constexpr (std::is_same_v<T, double>)
        return view;
      else
        return narrow;
    }
  };
  /// Arrays that passes leave. Of 32 bits, they are there for products beside those for forces.
  template <class T>
  struct Rows {
    Array<Space, T> corners, stiffness;
    ShellsOf<T> view;
  };
  template <class T>
  const Rows<T>& rows() const {
    if constexpr (std::is_same_v<T, double>)
      return wide_;
    else
      return narrow_;
  }
  template <class T>
  void place_rows(std::size_t lanes, bool products, Rows<T>& rows, ShellBlockOf<T> Block::*view);
  template <class T>
  void linearize_as(const PoseView& pose, const HistoryView& history, Tangent tangent, const TakenStepView& taken);
  void find_corners(const PointSet& set);
  /// Finds that of one block. @param all  of all: strains of shells, what is given of all blocks
  static HistoryView history_of(const Block& block, const HistoryView& all) {
    return {.E = all.E == nullptr || !block.view.damped ? nullptr : all.E + block.strain_begin,
            .inverse_step = all.inverse_step,
            .given = block.remembers && all.given != nullptr ? all.given + block.memory_begin * kGivenRows : nullptr};
  }

  std::vector<Block> blocks_;
  Array<Space, int> node_begin_, node_corner_, dof_;
  Array<Space, double> quantities_;
  Rows<double> wide_;
  Rows<float> narrow_;
  int nodes_ = 0;
  bool is_narrow_;  ///< products have 32 bits
  std::size_t strain_size_ = 0;
};

}  // namespace fascia::gpu
