#include "core/base/index.hpp"
#include "core/linear/elimination_order.hpp"

#include <amd.h>
#include <metis.h>

#include <new>
#include <optional>
#include <type_traits>
#include <vector>

namespace fascia {

namespace {

static_assert(std::is_same_v<idx_t, int>);

EliminationOrder by_minimum_degree(const NodeGraph& graph) {
  std::vector<int> order(at(graph.size()));
  if (order.empty()) return {};
  if (amd_order(graph.size(), graph.column_begin.data(), graph.row.data(), order.data(), nullptr, nullptr) < AMD_OK)
    throw std::bad_alloc();
  return graph.counted(order);
}

/// None where METIS finds no order.
std::optional<EliminationOrder> by_nested_dissection(const NodeGraph& graph) {
  int count = graph.size();
  std::vector<int> begin(at(count) + 1, 0), neighbour, order(at(count)), place(at(count));
  const auto for_edges = [&](const auto& act) {
    for (int column = 0; column < count; ++column)
      for (int k = graph.column_begin[at(column)]; k < graph.column_begin[at(column + 1)]; ++k)
        if (const int row = graph.row[at(k)]; row != column) act(column, row);
  };
  for_edges([&](int a, int b) { ++begin[at(a + 1)], ++begin[at(b + 1)]; });
  for (int k = 0; k < count; ++k) begin[at(k + 1)] += begin[at(k)];
  neighbour.resize(at(begin.back()));
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for_edges([&](int a, int b) { neighbour[at(next[at(a)]++)] = b, neighbour[at(next[at(b)]++)] = a; });
  if (METIS_NodeND(&count, begin.data(), neighbour.data(), nullptr, nullptr, order.data(), place.data()) != METIS_OK)
    return std::nullopt;
  return graph.counted(order);
}

}  // namespace

/// Minimum degree; where the factor fills much, nested dissection too, which takes several times as long: by the
/// measures that CHOLMOD of SuiteSparse has for it (its Common->method), though of the graph of nodes.
EliminationOrder EliminationOrder::of(const BlockMatrix& pattern, const DofFilter& filter, double enough) {
  const NodeGraph graph(pattern, filter);
  EliminationOrder order = by_minimum_degree(graph);
  const double entries = 0.5 * static_cast<double>(pattern.value_count()) * (pattern.fills_upper() ? 2 : 1);
  if (order.flops < 500 * order.numbers || order.numbers < 5 * entries) return order;
  order.rough = true;
  if (order.exceeds(enough)) return order;
  order.rough = false;
  const std::optional<EliminationOrder> dissected = by_nested_dissection(graph);
  return dissected && dissected->numbers < order.numbers ? *dissected : order;
}

}  // namespace fascia
