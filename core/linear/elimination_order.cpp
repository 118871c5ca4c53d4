#include "core/linear/elimination_order.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

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

EliminationOrder NodeGraph::counted(const std::vector<int>& order, const std::vector<int>& counts) const {
  EliminationOrder out;
  const double mean = std::accumulate(free.begin(), free.end(), 0.0) / std::max(size(), 1);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const int own = free[at(order[k])];
    out.nodes.push_back(node[at(order[k])]);
    for (int i = 0; i < own; ++i) {
      const double column = mean * (counts[k] - 1) + own - i;
      out.numbers += column;
      out.flops += column * column;
    }
  }
  return out;
}

}  // namespace fascia
