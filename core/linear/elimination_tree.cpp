#include "core/linear/elimination_tree.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <utility>

namespace fascia {

EliminationTree::EliminationTree(const NodeGraph& graph, const std::vector<int>& given) : order(given) {
  for (const int column : order) free.push_back(graph.free[at(column)]);
  find_earlier(graph);
  find_parents();
  take_postorder(graph, false);
  count_rows();
  take_postorder(graph, true);
}

void EliminationTree::find_earlier(const NodeGraph& graph) {
  std::vector<int> position(order.size());
  for (int k = 0; k < size(); ++k) position[at(order[at(k)])] = k;
  const auto for_edges = [&](const auto& act) {
    for (int column = 0; column < size(); ++column)
      for (int k = graph.column_begin[at(column)]; k < graph.column_begin[at(column + 1)]; ++k) {
        const int a = position[at(column)], b = position[at(graph.row[at(k)])];
        if (a != b) act(std::min(a, b), std::max(a, b));
      }
  };
  earlier_begin.assign(order.size() + 1, 0);
  for_edges([&](int, int later) { ++earlier_begin[at(later + 1)]; });
  for (int k = 0; k < size(); ++k) earlier_begin[at(k + 1)] += earlier_begin[at(k)];
  earlier.resize(at(earlier_begin.back()));
  std::vector<int> next(earlier_begin.begin(), earlier_begin.end() - 1);
  for_edges([&](int before, int later) { earlier[at(next[at(later)]++)] = before; });
}

/// Paths that were walked are shortened, so that each is walked nearly once.
void EliminationTree::find_parents() {
  parent.assign(order.size(), -1);
  std::vector<int> above(order.size(), -1);
  for (int k = 0; k < size(); ++k)
    for (int e = earlier_begin[at(k)]; e < earlier_begin[at(k + 1)]; ++e) {
      int walker = earlier[at(e)];
      while (above[at(walker)] >= 0 && above[at(walker)] != k) walker = std::exchange(above[at(walker)], k);
      if (above[at(walker)] >= 0) continue;
      above[at(walker)] = k;
      parent[at(walker)] = k;
    }
}

/// A row of the factor has a part of the tree below its own node, whose leaves are neighbours in the graph. Each row
/// adds its degrees of freedom at these leaves, and takes them away where branches meet and above its own node: sums
/// over descendants are what each column has (Gilbert, Ng and Peyton, "An efficient algorithm to compute row and column
/// counts for sparse Cholesky factorization", SIAM J. Matrix Anal. Appl. 15, 1994).
void EliminationTree::count_rows() {
  const std::size_t count = order.size();
  std::vector<int> first(count, -1), last_first(count, -1), last_leaf(count, -1), set(count), later_begin(count + 1, 0),
      later(earlier.size());
  rows.assign(count, 0);
  for (int k = 0; k < size(); ++k) {
    set[at(k)] = k;
    if (first[at(k)] < 0) {
      first[at(k)] = k;  // no child came before
      rows[at(k)] = free[at(k)];
    }
    if (const int above = parent[at(k)]; above >= 0 && first[at(above)] < 0) first[at(above)] = first[at(k)];
  }
  for (const int before : earlier) ++later_begin[at(before + 1)];
  for (std::size_t k = 1; k <= count; ++k) later_begin[k] += later_begin[k - 1];
  std::vector<int> next(later_begin.begin(), later_begin.end() - 1);
  for (int k = 0; k < size(); ++k)
    for (int e = earlier_begin[at(k)]; e < earlier_begin[at(k + 1)]; ++e) later[at(next[at(earlier[at(e)])]++)] = k;

  const auto meeting = [&](int k) {  // the highest node so far above k
    int top = k;
    while (set[at(top)] != top) top = set[at(top)];
    while (k != top) k = std::exchange(set[at(k)], top);
    return top;
  };
  for (int k = 0; k < size(); ++k) {
    const int above = parent[at(k)];
    if (above >= 0) rows[at(above)] -= free[at(k)];
    for (int e = later_begin[at(k)]; e < later_begin[at(k + 1)]; ++e) {
      const std::size_t row = at(later[at(e)]);
      if (first[at(k)] <= last_first[row]) continue;  // k is above a leaf that was met
      last_first[row] = first[at(k)];
      rows[at(k)] += free[row];
      const int leaf = std::exchange(last_leaf[row], k);
      if (leaf >= 0) rows[at(meeting(leaf))] -= free[row];
    }
    if (above >= 0) set[at(k)] = above;
  }
  for (int k = 0; k < size(); ++k)
    if (parent[at(k)] >= 0) rows[at(parent[at(k)])] += rows[at(k)];
}

void EliminationTree::take_postorder(const NodeGraph& graph, bool by_rows) {
  std::vector<int> child_begin(order.size() + 2, 0), child(order.size());
  const auto parent_of = [&](int k) { return parent[at(k)] < 0 ? size() : parent[at(k)]; };  // of roots: one past all
  for (int k = 0; k < size(); ++k) ++child_begin[at(parent_of(k) + 1)];
  for (std::size_t k = 1; k < child_begin.size(); ++k) child_begin[k] += child_begin[k - 1];
  std::vector<int> next(child_begin.begin(), child_begin.end() - 1);
  for (int k = 0; k < size(); ++k) child[at(next[at(parent_of(k))]++)] = k;
  for (int k = 0; by_rows && k <= size(); ++k)
    std::stable_sort(child.begin() + child_begin[at(k)], child.begin() + child_begin[at(k + 1)],
                     [&](int a, int b) { return rows[at(a)] < rows[at(b)]; });

  std::vector<int> sequence, place(order.size() + 1, -1), stack{size()};
  next.assign(child_begin.begin(), child_begin.end() - 1);
  while (!stack.empty()) {
    const int top = stack.back();
    if (next[at(top)] < child_begin[at(top + 1)]) {
      stack.push_back(child[at(next[at(top)]++)]);
      continue;
    }
    stack.pop_back();
    place[at(top)] = static_cast<int>(sequence.size());
    if (top < size()) sequence.push_back(top);
  }
  const auto placed = [&](const std::vector<int>& of) {
    std::vector<int> out;
    out.reserve(sequence.size());
    for (const int k : sequence) out.push_back(of[at(k)]);
    return out;
  };
  order = placed(order);
  free = placed(free);
  if (by_rows) rows = placed(rows);
  parent = placed(parent);
  for (int& k : parent) k = k < 0 ? -1 : place[at(k)];
  find_earlier(graph);
}

double EliminationTree::flops() const {
  double sum = 0;
  for (int k = 0; k < size(); ++k)
    for (int i = 0; i < free[at(k)]; ++i) sum += static_cast<double>(rows[at(k)] - i) * (rows[at(k)] - i);
  return sum;
}

double EliminationTree::numbers() const {
  double sum = 0;
  for (int k = 0; k < size(); ++k) sum += free[at(k)] * (rows[at(k)] - 0.5 * (free[at(k)] - 1));
  return sum;
}

}  // namespace fascia
