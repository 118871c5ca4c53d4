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

/// Rows that a linearisation keeps of a group: H (9), Dbar (9), S (6), drilling (3).
inline constexpr int kPointRows = 27;

/// The point groups of a PointSet, in the same layout (core/structure/point_set.hpp), with constants and what passes
/// leave of a scalar T.
template <class T>
struct PointsOf {
  int groups = 0, slots = 0;
  const int *slot_begin = nullptr, *slot_node = nullptr, *slot_group = nullptr;
  const int *node_slot_begin = nullptr, *node_slot = nullptr;
  const T *shape = nullptr, *material = nullptr, *axes = nullptr, *own = nullptr;
  const GroupRule* rule = nullptr;
  const char* blends = nullptr;     ///< of each group: Y is not zero
  const double* targets = nullptr;  ///< of tethers
  T* stress = nullptr;              ///< (groups × 18 × 8): v P, v Y of the last pass
  T* slot_sums = nullptr;           ///< (slots × 12): Σ v P g, Σ v (P Bᵀ + w Y)
  T* motion = nullptr;              ///< (groups × kPointRows × 8), of the linearisation
  double* quantities = nullptr;     ///< (groups × 8 × kQuantities)

  /// Adds what the last pass gave a node: all of it, or what tethers pull.
  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    for (int k = node_slot_begin[node]; k < node_slot_begin[node + 1]; ++k) add_slot(node_slot[k], sums);
  }
  FASCIA_HD void add_tether_sums(int node, NodeSums& sums) const {
    for (int k = node_slot_begin[node]; k < node_slot_begin[node + 1]; ++k)
      if (rule[slot_group[node_slot[k]]].rule.law == Law::tether) add_slot(node_slot[k], sums);
  }

 private:
  FASCIA_HD void add_slot(int slot, NodeSums& sums) const {
    const T* s = slot_sums + static_cast<std::size_t>(slot) * 12;
    for (int i = 0; i < 3; ++i) {
      sums.force[i] += s[i];
      for (int j = 0; j < 3; ++j) sums.N(i, j) += s[3 + 3 * i + j];
    }
  }
};

using PointsView = PointsOf<double>;

/// The point groups of a model on the device: a pass over points, then one over slots.
template <class Space>
class Points {
 public:
  explicit Points(const PointSet& set, Precision precision = Precision::full);

  bool empty() const { return view().groups == 0; }
  const PointsView& view() const { return view_of<double>(); }
  /// After a product: with the scalar of products.
  template <class T>
  const PointsOf<T>& view_of() const {
    return rows<T>().view;
  }
  /// Where tethers pull to: as CpuExecutor::targets().
  Array<Space, double>& targets() { return targets_; }
  std::size_t strain_size() const { return static_cast<std::size_t>(view().groups) * 6 * kGroupSize; }

  /// Connected part of each item of quantities(): one item a lane.
  std::vector<int> item_parts(const PointSet& set) const;
  /// (items × kQuantities), of the last forces with them
  const double* quantities() const { return quantities_.data(); }
  /// Sums as the last forces left them, for fascia::sum_of_groups().
  std::vector<double> slot_sums() const { return wide_.slot_sums.downloaded(); }

  /// The gradient of the energy at a pose, for add_sums(). @param part_motion  largest motion of each part (parts) [m];
  /// quantities only where it is given
  void forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history, const double* part_motion);
  /// Keeps what products need of a pose. Where a step led to it, add_sums() gives what acts with extrapolated stresses.
  void linearize(const PoseView& pose, const HistoryView& history, Tangent tangent, const TakenStepView& taken = {});
  /// The tangent's product at the linearisation, for add_sums() of view_of<T>(). @tparam T  of the precision
  template <class T, class V>
  void product(const DirectionOf<T, V>& direction);
  /// Adds the tangent's own block of each node, by rows. @param Q  I + D of each node
  void add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks);
  /// @param E  (groups × 6 × 8)
  void store_strain(const PoseView& pose, double* E);
  void store_stress(const PoseView& pose, const double* given, double* out);

 private:
  /// Groups of one kind are computed together.
  struct Kind {
    PointKind kind;
    Array<Space, int> groups;
  };
  /// Arrays that have a scalar T. Of 32 bits, they are there for products beside those for forces.
  template <class T>
  struct Rows {
    Array<Space, T> shape, material, axes, own, stress, slot_sums, motion;
    PointsOf<T> view;
  };
  template <class T>
  const Rows<T>& rows() const {
    if constexpr (std::is_same_v<T, double>)
      return wide_;
    else
      return narrow_;
  }
  template <class T>
  Rows<T>& rows() {
    return const_cast<Rows<T>&>(std::as_const(*this).template rows<T>());
  }
  template <class Act>
  void for_kinds(const Act& act);
  /// The groups are the first of all blocks.
  const double* own_given(const double* given) const { return remembers_ ? given : nullptr; }
  template <class T>
  void upload(const PointSet& set);
  template <class T>
  void linearize_as(const PoseView& pose, const HistoryView& history, const TakenStepView& taken);
  template <class T>
  void add_diagonal_as(const NodesView& nodes, const Mat3d* Q, double* blocks);

  std::vector<Kind> kinds_;
  Array<Space, int> slot_begin_, slot_node_, slot_group_, node_slot_begin_, node_slot_;
  Array<Space, double> targets_, quantities_;
  Array<Space, GroupRule> rule_;
  Array<Space, char> blends_;
  Rows<double> wide_;
  Rows<float> narrow_;
  bool is_narrow_;                 ///< products have 32 bits
  bool remembers_;                 ///< some points do
  double inverse_step_ = 0;        ///< of the linearisation
  const double* given_ = nullptr;  ///< likewise
  Tangent tangent_ = Tangent::full;
};

}  // namespace fascia::gpu
