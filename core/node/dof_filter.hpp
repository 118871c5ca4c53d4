#pragma once

#include "core/node/dof_turn.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Coordinates in which prescribed degrees of freedom are single numbers: each constrained frame's increments are
/// turned into its constraint's axes (an affine frame's A into R A Rᵀ). What follows from other nodes is fixed too.
class DofFilter {
 public:
  explicit DofFilter(const Model& model);

  bool turns() const { return !turns_.empty(); }  ///< constraint axes are not those of the world
  bool is_fixed(std::size_t dof) const { return fixed_[dof]; }
  int free_count() const { return free_count_; }
  std::size_t size() const { return fixed_.size(); }

  void to_local(std::span<double> v) const;   ///< world → constraint axes
  void to_global(std::span<double> v) const;  ///< constraint axes → world
  void clear_fixed(std::span<double> local) const;
  void keep_fixed(std::span<double> local) const;  ///< clears the free ones

  /// Axes of a node; null where they are those of the world.
  const DofTurn* turn_of(int node) const {
    const int turn = turn_of_node_[at(node)];
    return turn < 0 ? nullptr : &turns_[at(turn)];
  }
  /// Bit k: the degree of freedom k of a node is fixed.
  unsigned fixed_of(int node) const;
  /// Those of them that a constraint holds; the others follow the hosts of a dependent node.
  unsigned carried_of(int node) const { return carried_.empty() ? 0 : carried_[at(node)]; }

  /// The block of a row and a column in constraint axes: T_row K T_colᵀ.
  void rotate_block(int row, int column, const double* in, double* out) const;

 private:
  void apply(const DofTurn& turn, bool back, double* v) const;

  DofLayout dofs_;
  std::vector<DofTurn> turns_;
  std::vector<int> turn_of_node_;  ///< −1: none
  std::vector<bool> fixed_;
  std::vector<std::size_t> fixed_list_;
  std::vector<unsigned> carried_;  ///< (nodes); empty: no constraint
  int free_count_ = 0;
};

}  // namespace fascia
