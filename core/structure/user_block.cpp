#include "core/structure/user_block.hpp"

#include "core/base/errors.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace fascia {

UserBlock::UserBlock(int cell_nodes, std::vector<int> cells, double cell_length)
    : nodes(std::max(cell_nodes, 1)), length(cell_length) {
  if (cell_nodes < 1)
    throw InputError("a cell of a user block has " + std::to_string(cell_nodes) + " nodes; it needs 1");
  if (!(length > 0))
    throw InputError("a user block has cells of length " + std::to_string(length) + "; it must be positive");
  check(cells);
  cells_ = std::move(cells);
}

void UserBlock::set_cells(std::vector<int> cells) {
  check(cells);
  if (cells == cells_) return;
  cells_ = std::move(cells);
  ++revision_;
}

void UserBlock::check(const std::vector<int>& cells) const {
  if (cells.size() % at(nodes) != 0)
    throw InputError("a user block has cells of " + std::to_string(nodes) + " nodes and " +
                     std::to_string(cells.size()) + " nodes in all; give whole cells");
  for (std::size_t c = 0; c * at(nodes) < cells.size(); ++c) {
    const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(c * at(nodes));
    std::vector<int> sorted(begin, begin + nodes);
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
