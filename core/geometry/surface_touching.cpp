#include "core/geometry/surface_touching.hpp"

#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace fascia::surface_parts {
namespace {

/// A triangle at an edge: its angle about it, and whether what the surface bounds lies behind it as the angle grows.
struct Side {
  double angle = 0;
  bool opens = false;
  int triangle = 0;
};

int third_node(const Triangle& t, const Edge& edge) {
  for (const int node : t.nodes)
    if (node != edge.low && node != edge.high) return node;
  return edge.low;
}

std::vector<Side> sides_of(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles,
                           std::span<const Edge> edges) {
  const Vec3d from = points[at(edges[0].low)], axis = normalized(points[at(edges[0].high)] - from);
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(axis[a]) < std::abs(axis[least])) least = a;
  Vec3d e{};
  e[least] = 1;
  const Vec3d u = normalized(cross(axis, e)), v = cross(axis, u);
  std::vector<Side> sides;
  for (const Edge& edge : edges) {
    const Vec3d d = points[at(third_node(triangles[at(edge.triangle)], edge))] - from;
    // A triangle that runs along the axis faces the way in which the angle grows: it closes a wedge.
    sides.push_back({std::atan2(dot(d, v), dot(d, u)), !edge.forward, edge.triangle});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.angle != b.angle ? a.angle < b.angle : std::pair(!a.opens, a.triangle) < std::pair(!b.opens, b.triangle);
  });
  return sides;
}

/// Each side that opens a wedge with the next one that closes it, inner pairs first.
std::vector<std::array<int, 2>> pair_up(const std::vector<Side>& sides) {
  std::vector<std::array<int, 2>> pairs;
  std::vector<int> opened, closing;  // the triangles that wait: those that close pair with what opens last of all
  for (const Side& side : sides) {
    if (side.opens) {
      opened.push_back(side.triangle);
    } else if (opened.empty()) {
      closing.push_back(side.triangle);
    } else {
      pairs.push_back({opened.back(), side.triangle});
      opened.pop_back();
    }
  }
  for (const int triangle : closing) {
    pairs.push_back({opened.back(), triangle});  // balanced: there is one
    opened.pop_back();
  }
  return pairs;
}

/// Corners of triangles (three a triangle) that stay joined.
class JoinedCorners {
 public:
  explicit JoinedCorners(const std::vector<Triangle>& triangles)
      : triangles_(triangles), joined_(static_cast<int>(3 * triangles.size())) {}
  int root(int triangle, int node) { return joined_.root(corner(triangle, node)); }
  void join(int a, int b, int node) { joined_.join(corner(a, node), corner(b, node)); }

 private:
  int corner(int triangle, int node) const {
    const auto& nodes = triangles_[at(triangle)].nodes;
    return 3 * triangle + static_cast<int>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  }
  const std::vector<Triangle>& triangles_;
  DisjointSets joined_;
};

/// Joins the corners at one end of an edge where the wedges that met there would be parts of their own. Returns how
/// often.
std::size_t keep_parts_joined(const std::vector<TouchingEdge>& touching, const std::vector<Triangle>& triangles,
                              const std::vector<bool>& touched, JoinedCorners& corners) {
  DisjointSets parts(static_cast<int>(triangles.size()));
  std::map<int, int> of_node, of_corner;  // a triangle
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const int node : triangles[t].nodes) {
      const int triangle = static_cast<int>(t);
      const auto place = touched[at(node)] ? of_corner.try_emplace(corners.root(triangle, node), triangle).first
                                           : of_node.try_emplace(node, triangle).first;
      parts.join(triangle, place->second);
    }
  std::size_t count = 0;
  for (const TouchingEdge& edge : touching)
    for (std::size_t p = 1; p < edge.pairs.size(); ++p) {
      const int a = edge.pairs[0][0], b = edge.pairs[p][0];
      if (parts.root(a) == parts.root(b)) continue;
      corners.join(a, b, edge.low);
      parts.join(a, b);
      ++count;
    }
  return count;
}

}  // namespace

bool balanced(std::span<const Edge> edges) {
  const auto forward = std::count_if(edges.begin(), edges.end(), [](const Edge& e) { return e.forward; });
  return 2 * static_cast<std::size_t>(forward) == edges.size();
}

bool encloses(const std::vector<Triangle>& triangles) {
  bool all = true;
  for_each_edge(sorted_edges(triangles), [&](std::span<const Edge> run) { all = all && balanced(run); });
  return all;
}

bool branches(const std::vector<Triangle>& triangles) {
  bool any = false;
  for_each_edge(sorted_edges(triangles),
                [&](std::span<const Edge> run) { any = any || (run.size() > 2 && !balanced(run)); });
  return any;
}

std::vector<bool> bounding_triangles(const std::vector<Triangle>& triangles) {
  const std::vector<Edge> edges = sorted_edges(triangles);
  const Components patches(Neighbours(triangles.size(), edges));
  const auto patch_of = [&](const Edge& edge) { return patches.of[at(edge.triangle)]; };
  std::vector<int> net(at(patches.count), 0);  // of a patch at one edge: triangles forward less those backward
  std::vector<bool> open(net.size(), false), cluster_open(net.size(), false);
  DisjointSets clusters(static_cast<int>(net.size()));
  for_each_edge(edges, [&](std::span<const Edge> run) {
    for (const Edge& edge : run) {
      clusters.join(patch_of(run[0]), patch_of(edge));
      net[at(patch_of(edge))] += edge.forward ? 1 : -1;
    }
    for (const Edge& edge : run) {
      if (net[at(patch_of(edge))] != 0) open[at(patch_of(edge))] = true;
      net[at(patch_of(edge))] = 0;
    }
  });
  for_each_edge(edges, [&](std::span<const Edge> run) {
    if (!balanced(run)) cluster_open[at(clusters.root(patch_of(run[0])))] = true;
  });
  std::vector<bool> result;
  for (const int patch : patches.of) result.push_back(!open[at(patch)] || !cluster_open[at(clusters.root(patch))]);
  return result;
}

std::vector<TouchingEdge> touching_edges(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles) {
  std::vector<TouchingEdge> touching;
  for_each_edge(sorted_edges(triangles), [&](std::span<const Edge> run) {
    if (run.size() > 2 && balanced(run))
      touching.push_back({run[0].low, run[0].high, pair_up(sides_of(points, triangles, run))});
  });
  return touching;
}

PartedSurface part_at(const std::vector<TouchingEdge>& touching, std::size_t point_count,
                      std::vector<Triangle> triangles) {
  PartedSurface result;
  const std::size_t former = triangles.size();
  const std::vector<Triangle> before = triangles;
  JoinedCorners corners(before);
  for_each_edge(sorted_edges(before), [&](std::span<const Edge> run) {
    if (run.size() != 2) return;
    for (const int node : {run[0].low, run[0].high}) corners.join(run[0].triangle, run[1].triangle, node);
  });
  std::vector<bool> touched(point_count, false);
  for (const TouchingEdge& edge : touching)
    for (const int node : {edge.low, edge.high}) {
      touched[at(node)] = true;
      for (const auto& [a, b] : edge.pairs) corners.join(a, b, node);
    }

  result.joined = keep_parts_joined(touching, before, touched, corners);

  // The corners that hold the lowest triangle keep the node, others get a copy.
  std::vector<int> keeper(point_count, -1);
  std::map<int, int> copy_of_root;
  const auto add = [&](int a, int b) {
    result.added.push_back({a, b});
    return static_cast<int>(point_count + result.added.size()) - 1;
  };
  for (std::size_t t = 0; t < former; ++t)
    for (int& node : triangles[t].nodes) {
      if (!touched[at(node)]) continue;
      const int root = corners.root(static_cast<int>(t), node);
      if (keeper[at(node)] < 0) keeper[at(node)] = root;
      if (keeper[at(node)] == root) continue;
      const auto [copy, fresh] = copy_of_root.try_emplace(root, 0);
      if (fresh) copy->second = add(node, node);
      node = copy->second;
    }

  // The node of a former triangle's corner, and the piece of it that has an edge.
  const auto now = [&](int triangle, int node) {
    const auto copy = copy_of_root.find(corners.root(triangle, node));
    return copy == copy_of_root.end() ? node : copy->second;
  };
  std::map<int, std::vector<std::size_t>> halves;  // that were cut from a triangle
  const auto halve = [&](int triangle, int a, int b, int middle) {
    const auto has = [&](const Triangle& t) {
      return std::ranges::count(t.nodes, a) == 1 && std::ranges::count(t.nodes, b) == 1;
    };
    std::size_t piece = at(triangle);
    std::vector<std::size_t>& cut = halves[triangle];
    for (std::size_t h = 0; h < cut.size() && !has(triangles[piece]); ++h) piece = cut[h];
    Triangle other = triangles[piece];
    std::ranges::replace(triangles[piece].nodes, b, middle);
    std::ranges::replace(other.nodes, a, middle);
    cut.push_back(triangles.size());
    triangles.push_back(other);
    result.half_of.push_back(triangle);
  };
  for (const TouchingEdge& edge : touching) {
    std::set<std::pair<int, int>> taken;  // ends of the edge as wedges have it
    for (const auto& pair : edge.pairs) {
      const int a = now(pair[0], edge.low), b = now(pair[0], edge.high);
      if (taken.emplace(a, b).second) continue;
      const int middle = add(a, b);
      for (const int triangle : pair) halve(triangle, a, b, middle);
    }
  }
  result.triangles = std::move(triangles);
  return result;
}

}  // namespace fascia::surface_parts
