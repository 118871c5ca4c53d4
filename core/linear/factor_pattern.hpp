#pragma once

#include "core/linear/elimination_order.hpp"
#include "core/linear/supernodes.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

/// Where the numbers of a Cholesky factor stand, by supernodes: runs of columns that share their rows below. Nodes are
/// eliminated in postorder of the elimination tree, so that each subtree is a run of supernodes; small supernodes are
/// joined with the one above them where that brings few zeros, and wide ones are cut. The numbers of one lie by
/// columns, as a dense matrix whose first rows are its own columns.
struct FactorPattern {
  static constexpr int kMostColumns = 256;  ///< of a supernode

  std::vector<int> node;      ///< of the matrix, in the order of elimination: those that have free degrees of freedom
  std::vector<int> column;    ///< of the factor that each begins with, and of the end
  std::vector<int> position;  ///< of each node of the matrix in this order, −1 where nothing is free

  std::vector<int> first_node, first_column;         ///< of each supernode, and of the end
  std::vector<std::int64_t> row_begin, value_begin;  ///< of each supernode, and of the end
  std::vector<int> row;                              ///< of the factor, ascending in each supernode
  std::vector<int> parent;                           ///< of each supernode in the elimination tree; −1: a root

  /// A supernode that has rows among the columns of another, the first of which is its row `begin`.
  struct Descendant {
    int supernode, begin;
  };
  std::vector<Descendant> descendant;          ///< ascending in each
  std::vector<std::int64_t> descendant_begin;  ///< of each supernode, and of the end

  double flops = 0;  ///< Σ of squares of the numbers in a column, without the zeros of joined supernodes

  FactorPattern(const BlockMatrix& pattern, const DofFilter& filter, const std::vector<int>& order);

  int supernodes() const { return static_cast<int>(first_column.size()) - 1; }
  int columns() const { return first_column.back(); }
  int columns(int supernode) const { return first_column[at(supernode + 1)] - first_column[at(supernode)]; }
  int rows(int supernode) const { return static_cast<int>(row_begin[at(supernode + 1)] - row_begin[at(supernode)]); }
  const int* rows_of(int supernode) const { return row.data() + row_begin[at(supernode)]; }

  /// @param value  that stand at these places
  template <class T>
  Supernodes<T> view(std::span<const T> value, std::span<const double> sign) const {
    return {first_column, row_begin, value_begin, row, value, sign};
  }
};

}  // namespace fascia
