#pragma once

#include "core/linear/elimination_order.hpp"

#include <vector>

namespace fascia {

/// The elimination tree of a graph of nodes in postorder (Liu, "The role of elimination trees in sparse factorization",
/// SIAM J. Matrix Anal. Appl. 11, 1990): a node's parent is the first row below the diagonal of its column of the
/// factor. All of it takes about as long as reading the graph a few times, however many numbers the factor will have.
struct EliminationTree {
  std::vector<int> order;   ///< columns of the graph in postorder; of siblings, the one with most rows comes last
  std::vector<int> parent;  ///< of each position, −1: a root
  std::vector<int> rows;    ///< degrees of freedom in its column of the factor, its own among them
  std::vector<int> free;    ///< its own degrees of freedom
  std::vector<int> earlier_begin, earlier;  ///< neighbours of each position in the graph that come before it

  /// @param order  columns of the graph as they are to be eliminated
  EliminationTree(const NodeGraph& graph, const std::vector<int>& order);
  int size() const { return static_cast<int>(order.size()); }

  double flops() const;    ///< of a factorisation: Σ of squares of the numbers in a column
  double numbers() const;  ///< of the factor

 private:
  void find_earlier(const NodeGraph& graph);
  void find_parents();
  void count_rows();
  /// @param by_rows  siblings go by their rows; else as they come
  void take_postorder(const NodeGraph& graph, bool by_rows);
};

}  // namespace fascia
