#pragma once

#include "core/base/index.hpp"

#include <vector>

namespace fascia {

/// The nodes that a list names, without repetition, and of each entry which of them it is.
struct NodeRows {
  std::vector<int> nodes, row;

  NodeRows(const std::vector<int>& list, int node_count) {
    std::vector<int> row_of_node(at(node_count), -1);
    for (const int node : list) {
      int& own = row_of_node[at(node)];
      if (own < 0) {
        own = static_cast<int>(nodes.size());
        nodes.push_back(node);
      }
      row.push_back(own);
    }
  }
};

}  // namespace fascia
