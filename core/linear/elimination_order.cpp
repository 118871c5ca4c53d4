#include "core/linear/elimination_order.hpp"

#include "core/base/index.hpp"
#include "core/linear/elimination_tree.hpp"

#include <bit>

namespace fascia {

NodeGraph::NodeGraph(const BlockMatrix& pattern, const DofFilter& filter) {
  std::vector<int> number(at(pattern.rows()), -1);
  for (int i = 0; i < pattern.rows(); ++i) {
    const int left = pattern.dofs().size(i) - std::popcount(filter.fixed_of(i));
    if (left == 0) continue;
    number[at(i)] = size();
    node.push_back(i);
    free.push_back(left);
  }
  for (const int i : node) {
    column_begin.push_back(static_cast<int>(row.size()));
    for (const int j : pattern.columns(i).subspan(at(pattern.diagonal(i) - pattern.row_begin(i))))
      if (number[at(j)] >= 0) row.push_back(number[at(j)]);
  }
  column_begin.push_back(static_cast<int>(row.size()));
}

EliminationOrder NodeGraph::counted(const std::vector<int>& order) const {
  const EliminationTree tree(*this, order);
  EliminationOrder out;
  for (const int column : tree.order) out.nodes.push_back(node[at(column)]);
  out.flops = tree.flops();
  out.numbers = tree.numbers();
  return out;
}

}  // namespace fascia
