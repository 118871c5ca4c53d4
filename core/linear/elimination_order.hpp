#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/node/dof_filter.hpp"

#include <limits>
#include <vector>

namespace fascia {

/// In which order a Cholesky factorisation eliminates the nodes of a matrix, and what the factor takes: found on the
/// graph of nodes, which has a small part of the matrix's entries.
struct EliminationOrder {
  std::vector<int> nodes;  ///< those that have free degrees of freedom
  double flops = 0;        ///< of one factorisation
  double numbers = 0;      ///< in the factor
  bool rough = false;      ///< another order takes fewer: it was not looked for

  /// More operations than these, by all that is known: nested dissection took 1 to 4.2 times fewer than minimum degree
  /// on bodies of 14,000 to 70,000 nodes, and up to 5.5 times on larger ones, which are far beyond any limit.
  bool exceeds(double limit) const { return flops > (rough ? 5 : 1) * limit; }

  /// The factor takes less than 9 GB, and up to a third more for the zeros of its dense columns. A larger one is made
  /// only where the user asks for it.
  bool moderate() const { return numbers < 0x1.0p30; }

  /// @param enough  operations: an order that no other one brings down to as few may be rough
  static EliminationOrder of(const BlockMatrix& pattern, const DofFilter& filter,
                             double enough = std::numeric_limits<double>::infinity());
};

/// The lower triangle, by columns, of the graph of those nodes of a matrix that have free degrees of freedom.
struct NodeGraph {
  std::vector<int> node, free;  ///< of each column, and how many degrees of freedom of it are free
  std::vector<int> column_begin, row;

  NodeGraph(const BlockMatrix& pattern, const DofFilter& filter);
  int size() const { return static_cast<int>(node.size()); }
  /// @param order  columns in the order in which they are eliminated
  EliminationOrder counted(const std::vector<int>& order) const;
};

}  // namespace fascia
