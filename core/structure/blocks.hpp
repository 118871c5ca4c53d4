#pragma once

#include "core/structure/point_set.hpp"

namespace fascia {

/// The groups of points of a set, as a block.
struct PointGroups {
  const PointSet& set;

  /// Calls act(nodes, largest stiffness λ + 2μ of its points [Pa]) for each group; a tether's is 0: it is no matter.
  template <class Act>
  void for_each_cell(const Act& act) const {
    for (int group = 0; group < set.group_count(); ++group) act(set.nodes(group), stiffness_of(group));
  }
  /// Σ v (λ + 2μ) |g|² over points, |g| the norm of the gradients of its frames' weights [N/m].
  double stiffness_sum() const;

 private:
  double stiffness_of(int group) const;
};

/// Calls act(block) for all that is matter between nodes, in the order in which the executor has it. Each has
/// for_each_cell(), and stiffness_sum().
template <class Act>
void for_each_block(const PointSet& set, const Act& act) {
  act(PointGroups{set});
  for (const ElementBlock& block : set.blocks) act(block);
  for (const ShellBlock& shell : set.shells) act(shell);
  for (const auto& block : set.user_blocks) act(*block);
}

/// Calls act(nodes, stiffness [Pa]) for each of their cells: all that ties nodes to one another by matter.
template <class Act>
void for_each_cell(const PointSet& set, const Act& act) {
  for_each_block(set, [&](const auto& block) { block.for_each_cell(act); });
}

}  // namespace fascia
