#include "core/structure/user_block.hpp"

#include "core/base/errors.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace fascia {

UserBlock::UserBlock(int cell_nodes, std::vector<int> cells, double cell_length)
    : nodes(std::max(cell_nodes, 1)),
      count(static_cast<int>(cells.size()) / nodes),
      length(cell_length),
      cells_(std::move(cells)) {
  if (cell_nodes < 1)
    throw InputError("a cell of a user block has " + std::to_string(cell_nodes) + " nodes; it needs 1");
  if (cells_.size() % at(nodes) != 0)
    throw InputError("a user block has cells of " + std::to_string(nodes) + " nodes and " +
                     std::to_string(cells_.size()) + " nodes in all; give whole cells");
  if (!(length > 0))
    throw InputError("a user block has cells of length " + std::to_string(length) + "; it must be positive");
  for (int c = 0; c < count; ++c) {
    std::vector<int> sorted(cell(c).begin(), cell(c).end());
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] < 0)
      throw InputError("cell " + std::to_string(c) + " of a user block names node " + std::to_string(sorted[0]));
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
      throw InputError("cell " + std::to_string(c) + " of a user block names node " + std::to_string(*twice) +
                       " twice; a node may stand once in a cell");
  }
}

}  // namespace fascia
