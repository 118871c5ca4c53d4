#include "core/geometry/surface_edges.hpp"

#include "core/base/index.hpp"

#include <algorithm>

namespace fascia::surface_parts {

std::vector<Edge> sorted_edges(const std::vector<Triangle>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t n = 0; n < 3; ++n) {
      const int a = triangles[t].nodes[n], b = triangles[t].nodes[(n + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.triangle < b.triangle;
  });
  return edges;
}

namespace {

/// Puts a link where a triangle has none yet.
void fill(std::array<Neighbours::Link, 3>& links, const Neighbours::Link& link) {
  for (Neighbours::Link& free : links)
    if (free.triangle < 0) {
      free = link;
      return;
    }
}

}  // namespace

Neighbours::Neighbours(std::size_t triangle_count, const std::vector<Edge>& edges) : of(triangle_count) {
  for_each_edge(edges, [&](std::span<const Edge> same) {
    if (same.size() != 2) return;
    const Edge &a = same[0], &b = same[1];
    fill(of[at(a.triangle)], {b.triangle, a.forward == b.forward});
    fill(of[at(b.triangle)], {a.triangle, a.forward == b.forward});
  });
}

void Neighbours::link(int a, int b) {
  fill(of[at(a)], {b, false});
  fill(of[at(b)], {a, false});
}

Components::Components(const Neighbours& neighbours) : of(neighbours.of.size(), -1), turn(neighbours.of.size(), false) {
  for (std::size_t t = 0; t < of.size(); ++t)
    if (of[t] < 0) walk(neighbours, static_cast<int>(t), count++);
}

void Components::walk(const Neighbours& neighbours, int start, int component) {
  std::vector<int> open{start};
  of[at(start)] = component;
  while (!open.empty()) {
    const std::size_t t = at(open.back());
    open.pop_back();
    for (const Neighbours::Link& link : neighbours.of[t]) {
      if (link.triangle < 0) continue;
      const std::size_t other = at(link.triangle);
      const bool must_turn = turn[t] != link.same_direction;
      if (of[other] < 0) {
        of[other] = component;
        turn[other] = must_turn;
        open.push_back(link.triangle);
      } else if (turn[other] != must_turn) {
        orientable = false;
        twisted = link.triangle;
      }
    }
  }
}

}  // namespace fascia::surface_parts
