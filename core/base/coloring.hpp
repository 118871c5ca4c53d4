#pragma once

#include "core/base/index.hpp"

#include <algorithm>
#include <vector>

namespace fascia {

/// Items by colour; items of one colour share no node and may be added up at the same time.
struct Coloring {
  std::vector<int> begin{0}, item;  ///< (colours + 1), (items)
};

/// Greedy colouring: the lowest colour that no item with a common node has.
/// @param nodes_of  nodes of an item, a range
template <class NodesOf>
Coloring color_items(int items, int nodes, const NodesOf& nodes_of) {
  std::vector<std::size_t> color(at(items));
  std::vector<std::vector<bool>> taken;  // colour → node is taken
  for (int item = 0; item < items; ++item) {
    const auto& own = nodes_of(item);
    std::size_t c = 0;
    while (c < taken.size() && std::any_of(own.begin(), own.end(), [&](int node) { return taken[c][at(node)]; })) ++c;
    if (c == taken.size()) taken.emplace_back(at(nodes), false);
    for (const int node : own) taken[c][at(node)] = true;
    color[at(item)] = c;
  }
  Coloring result;
  for (std::size_t c = 0; c < taken.size(); ++c) {
    for (int item = 0; item < items; ++item)
      if (color[at(item)] == c) result.item.push_back(item);
    result.begin.push_back(static_cast<int>(result.item.size()));
  }
  return result;
}

}  // namespace fascia
