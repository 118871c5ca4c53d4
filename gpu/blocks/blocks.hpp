#pragma once

#include "core/executor/block_executor.hpp"
#include "core/space/part_sums.hpp"
#include "gpu/blocks/points.hpp"
#include "gpu/blocks/shells.hpp"
#include "gpu/blocks/springs.hpp"
#include "gpu/elements/elements.hpp"

#include <tuple>
#include <vector>

namespace fascia::gpu {

/// Views of all blocks from which a node gathers, of a scalar T.
template <class T>
struct BlocksOf {
  PointsOf<T> points;
  ElementsOf<T> elements;
  ShellsOf<T> shells;
  SpringsView springs;
  bool has_points = false, has_elements = false, has_shells = false, has_springs = false;

  /// Adds what the last pass gave a node: of all but springs, whose tangent is in the nodes' own blocks.
  FASCIA_HD void add_sums(int node, NodeSums& sums) const {
    if (has_points) points.add_sums(node, sums);
    if (has_elements) elements.add_sums(node, sums);
    if (has_shells) shells.add_sums(node, sums);
  }
};

using BlocksView = BlocksOf<double>;

/// Everything elastic of a model: blocks of one interface, each with its own strains in one array.
template <class Space>
class Blocks {
 public:
  explicit Blocks(const PointSet& set, Precision precision = Precision::full);

  BlocksView view() const { return view_of<double>(); }
  /// After a product: with the scalar of products.
  template <class T>
  BlocksOf<T> view_of() const;
  Points<Space>& points() { return std::get<Points<Space>>(kinds_); }
  const Elements<Space>& elements() const { return std::get<Elements<Space>>(kinds_); }
  /// By kinds, in the order in which CpuExecutor has them.
  std::size_t strain_size() const { return strain_size_; }
  /// Numbers that sum_quantities() writes.
  std::size_t report_size() const { return sums_.size() * at(parts_) * kQuantities; }

  void forces(const NodesView& nodes, const PoseView& pose, const HistoryView& history, const double* part_motion);
  /// All but springs, whose tangent is in the nodes' own blocks.
  void linearize(const PoseView& pose, const HistoryView& history, Tangent tangent, const TakenStepView& taken);
  void add_spring_blocks(const NodesView& nodes, const PoseView& pose, Tangent tangent, double* node_blocks) {
    if (!springs_.empty()) springs_.add_blocks(nodes, pose, tangent, node_blocks);
  }
  /// @tparam T  of the precision
  template <class T, class V>
  void product(const DirectionOf<T, V>& direction);
  void add_diagonal(const NodesView& nodes, const Mat3d* Q, double* blocks);
  void store_strain(const PoseView& pose, double* E);
  /// Stores what fades, of the points that remember it, with rows of `given`. @param out  (lanes × 6)
  void store_stress(const PoseView& pose, const double* given, double* out);

  /// Quantities of each part (kinds of blocks × parts × kQuantities) of the last forces with them.
  void sum_quantities(double* out);
  /// Energies as the last forces with quantities found them.
  BlockEnergies energies(const PointSet& set) const;

 private:
  struct Summed {
    PartSums<Space> by_part;
    const double* quantities;
  };
  template <class Kind>
  void sum_kind(const Kind& kind, const PointSet& set);
  /// Calls act(kind, strains before its own) for each kind of matter that the model has.
  template <class Act>
  void for_each_kind(const Act& act) {
    std::size_t begin = 0;
    const auto one = [&](auto& kind) {
      if (!kind.empty()) act(kind, begin);
      begin += kind.strain_size();
    };
    std::apply([&](auto&... kinds) { (one(kinds), ...); }, kinds_);
  }
  /// A kind's strains; what is given is of all blocks.
  static HistoryView part_of(const HistoryView& all, std::size_t begin) {
    return {.E = all.E == nullptr ? nullptr : all.E + begin, .inverse_step = all.inverse_step, .given = all.given};
  }

  std::tuple<Points<Space>, Elements<Space>, Shells<Space>> kinds_;
  Springs<Space> springs_;
  std::size_t strain_size_ = 0;
  std::vector<Summed> sums_;  ///< of the kinds that the model has
  int parts_;
};

}  // namespace fascia::gpu
