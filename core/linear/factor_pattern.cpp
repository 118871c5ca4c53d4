#include "core/linear/factor_pattern.hpp"

#include "core/base/index.hpp"
#include "core/linear/elimination_tree.hpp"

#include <algorithm>

namespace fascia {

namespace {

/// Supernodes while they are joined: which nodes of the tree, and what they take.
struct Run {
  int begin, end;        ///< nodes
  double columns, rows;  ///< degrees of freedom
  double zeros;          ///< of the numbers
  double numbers() const { return columns * (rows - 0.5 * (columns - 1)); }
};

/// Runs as long as columns share their rows.
std::vector<Run> maximal(const EliminationTree& tree) {
  std::vector<Run> runs;
  for (int k = 0; k < tree.size(); ++k) {
    const int own = tree.free[at(k)];
    const bool follows =
        k > 0 && tree.parent[at(k - 1)] == k && tree.rows[at(k - 1)] == tree.rows[at(k)] + tree.free[at(k - 1)];
    if (!follows) runs.push_back({k, k, 0, static_cast<double>(tree.rows[at(k)]), 0});
    runs.back().end = k + 1;
    runs.back().columns += own;
  }
  return runs;
}

/// Dense loops over a few more columns are faster than lists of few: by these sizes of what is joined, in columns, and
/// the part of zeros that is accepted then.
bool worth_joining(double columns, double zeros, double numbers) {
  if (columns <= 8 || zeros == 0) return true;
  const double part = zeros / numbers;
  return (columns <= 24 && part < 0.5) || (columns <= 64 && part < 0.15) || part < 0.05;
}

/// Joins runs with the one that follows where that has their parent, from the last one to the first.
std::vector<Run> joined(const EliminationTree& tree, const std::vector<Run>& runs) {
  std::vector<Run> out;  // from the last one on
  for (std::size_t k = runs.size(); k-- > 0;) {
    const Run& run = runs[k];
    const int parent = tree.parent[at(run.end - 1)];
    if (!out.empty() && parent >= 0 && parent < out.back().end) {
      const Run& above = out.back();
      Run both{run.begin, above.end, run.columns + above.columns, run.columns + above.rows, 0};
      both.zeros = both.numbers() - (run.numbers() - run.zeros) - (above.numbers() - above.zeros);
      if (worth_joining(both.columns, both.zeros, both.numbers())) {
        out.back() = both;
        continue;
      }
    }
    out.push_back(run);
  }
  std::reverse(out.begin(), out.end());
  return out;
}

/// Cut where they have too many columns.
std::vector<Run> in_panels(const EliminationTree& tree, const std::vector<Run>& runs) {
  std::vector<Run> out;
  for (const Run& run : runs)
    for (int k = run.begin; k < run.end; ++k) {
      const int own = tree.free[at(k)];
      if (k == run.begin || out.back().columns + own > FactorPattern::kMostColumns) out.push_back({k, k, 0, 0, 0});
      out.back().end = k + 1;
      out.back().columns += own;
    }
  return out;
}

/// Which nodes of the tree are rows of each supernode, its own first.
std::vector<std::vector<int>> rows_by_nodes(const EliminationTree& tree, const std::vector<Run>& runs,
                                            const std::vector<int>& supernode_of) {
  std::vector<std::vector<int>> below(runs.size()), neighbours(runs.size()), children(runs.size());
  for (int k = 0; k < tree.size(); ++k)
    for (int e = tree.earlier_begin[at(k)]; e < tree.earlier_begin[at(k + 1)]; ++e) {
      const std::size_t s = at(supernode_of[at(tree.earlier[at(e)])]);
      if (k >= runs[s].end && (neighbours[s].empty() || neighbours[s].back() != k)) neighbours[s].push_back(k);
    }
  std::vector<int> met(at(tree.size()), -1);
  for (std::size_t s = 0; s < runs.size(); ++s) {
    std::vector<int>& rows = below[s];
    const auto add = [&](const std::vector<int>& some) {
      for (const int k : some) {
        if (k < runs[s].end || met[at(k)] == static_cast<int>(s)) continue;
        met[at(k)] = static_cast<int>(s);
        rows.push_back(k);
      }
    };
    add(neighbours[s]);
    for (const int child : children[s]) add(below[at(child)]);
    std::sort(rows.begin(), rows.end());
    if (!rows.empty()) children[at(supernode_of[at(rows.front())])].push_back(static_cast<int>(s));
  }
  return below;
}

}  // namespace

FactorPattern::FactorPattern(const BlockMatrix& pattern, const DofFilter& filter, const std::vector<int>& nodes) {
  const NodeGraph graph(pattern, filter);
  std::vector<int> column_of(at(pattern.rows()), -1), given;
  for (int k = 0; k < graph.size(); ++k) column_of[at(graph.node[at(k)])] = k;
  for (const int n : nodes) given.push_back(column_of[at(n)]);
  const EliminationTree tree(graph, given);
  flops = tree.flops();

  position.assign(at(pattern.rows()), -1);
  column.push_back(0);
  for (int k = 0; k < tree.size(); ++k) {
    node.push_back(graph.node[at(tree.order[at(k)])]);
    position[at(node.back())] = k;
    column.push_back(column.back() + tree.free[at(k)]);
  }
  const std::vector<Run> runs = in_panels(tree, joined(tree, maximal(tree)));
  std::vector<int> supernode_of(at(tree.size()));
  for (std::size_t s = 0; s < runs.size(); ++s)
    std::fill(supernode_of.begin() + runs[s].begin, supernode_of.begin() + runs[s].end, static_cast<int>(s));
  const std::vector<std::vector<int>> below = rows_by_nodes(tree, runs, supernode_of);

  constexpr std::int64_t kLine = 8;  // a supernode begins on a line of the cache
  row_begin.push_back(0);
  value_begin.push_back(0);
  std::vector<int> ties(runs.size() + 1, 0);  // descendants of each
  for (std::size_t s = 0; s < runs.size(); ++s) {
    first_node.push_back(runs[s].begin);
    first_column.push_back(column[at(runs[s].begin)]);
    parent.push_back(below[s].empty() ? -1 : supernode_of[at(below[s].front())]);
    for (int k = runs[s].begin; k < runs[s].end; ++k)
      for (int r = column[at(k)]; r < column[at(k + 1)]; ++r) row.push_back(r);
    for (const int k : below[s])
      for (int r = column[at(k)]; r < column[at(k + 1)]; ++r) row.push_back(r);
    const auto rows = static_cast<std::int64_t>(row.size()) - row_begin.back();
    row_begin.push_back(static_cast<std::int64_t>(row.size()));
    const std::int64_t values = rows * (column[at(runs[s].end)] - column[at(runs[s].begin)]);
    value_begin.push_back(value_begin.back() + (values + kLine - 1) / kLine * kLine);
    for (int last = -1; const int k : below[s])
      if (supernode_of[at(k)] != last) ++ties[at(last = supernode_of[at(k)]) + 1];
  }
  first_node.push_back(tree.size());
  first_column.push_back(column.back());

  descendant_begin.assign(runs.size() + 1, 0);
  for (std::size_t s = 0; s < runs.size(); ++s) descendant_begin[s + 1] = descendant_begin[s] + ties[s + 1];
  descendant.resize(static_cast<std::size_t>(descendant_begin.back()));
  std::vector<std::int64_t> next(descendant_begin.begin(), descendant_begin.end() - 1);
  for (std::size_t s = 0; s < runs.size(); ++s) {
    int begin = columns(static_cast<int>(s));
    for (int last = -1; const int k : below[s]) {
      if (supernode_of[at(k)] != last) {
        last = supernode_of[at(k)];
        descendant[static_cast<std::size_t>(next[at(last)]++)] = {static_cast<int>(s), begin};
      }
      begin += tree.free[at(k)];
    }
  }
}

}  // namespace fascia
