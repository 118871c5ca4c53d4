#pragma once

#include "core/base/index.hpp"

#include <numeric>
#include <vector>

namespace fascia {

/// Lists of what lies about each node, ascending. @param for_each  calls act(node, value) for all, in the same order
template <class ForEach>
void list_by_node(int nodes, const ForEach& for_each, std::vector<int>& begin, std::vector<int>& value) {
  begin.assign(at(nodes) + 1, 0);
  for_each([&](int node, int) { ++begin[at(node) + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  value.resize(at(begin.back()));
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for_each([&](int node, int what) { value[at(next[at(node)]++)] = what; });
}

}  // namespace fascia
