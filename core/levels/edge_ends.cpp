#include "core/levels/edge_ends.hpp"

#include "core/base/index.hpp"

#include <limits>
#include <span>

namespace fascia {

namespace {

constexpr double kStraight = 0.05;  ///< a node farther from the middle of its edge, in parts of its length, bends it
constexpr double kClear = 4;        ///< times as far another pair of nodes is from having it in their middle
constexpr int kNodesOfLinear = 8;   ///< an element has at most, without nodes on its edges

using Ends = std::array<int, 2>;
constexpr Ends kNone{-1, -1};

/// Two nodes of an element that another one lies in the middle of: those that it does best, and far better than any
/// others. In flat elements diagonals pass close by.
Ends ends_around(std::span<const int> nodes, int middle, std::span<const Vec3d> X) {
  Ends ends = kNone;
  double best = kStraight * kStraight, second = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t b = a + 1; b < nodes.size(); ++b) {
      const Vec3d &from = X[at(nodes[a])], &to = X[at(nodes[b])];
      const double length = squared_norm(to - from);
      const double off = squared_norm(X[at(middle)] - (from + to) * 0.5) / length;
      if (!(length > 0) || off >= second) continue;
      if (off >= best) {
        second = off;
        continue;
      }
      second = ends == kNone ? second : best;
      best = off;
      ends = {nodes[a], nodes[b]};
    }
  return second > kClear * kClear * best ? ends : kNone;
}

}  // namespace

EdgeEnds find_edge_ends(const Model& model) {
  EdgeEnds ends(at(model.node_count()), kNone);
  std::vector<char> taken(ends.size(), 0);  // an end of an edge
  for (const ElementBlock& block : model.points.blocks) {
    if (block.nodes <= kNodesOfLinear) continue;
    block.for_each_element([&](std::span<const int> nodes) {
      for (const int node : nodes) {
        if (taken[at(node)] != 0 || ends[at(node)] != kNone) continue;
        ends[at(node)] = ends_around(nodes, node, model.rest_position);
        for (const int end : ends[at(node)])
          if (end >= 0) taken[at(end)] = 1;
      }
    });
  }
  std::vector<char> follows(ends.size(), 0);
  for (const DependentNode& d : model.points.dependents) follows[at(d.node)] = 1;
  const EdgeEnds found = ends;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] == kNone) continue;
    bool good = true;
    for (const int end : ends[i]) good = good && found[at(end)] == kNone && follows[at(end)] == 0;
    if (!good) ends[i] = kNone;
  }
  return ends;
}

}  // namespace fascia
