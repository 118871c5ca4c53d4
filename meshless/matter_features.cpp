#include "core/base/index.hpp"
#include "meshless/matter_parts.hpp"

#include <algorithm>

namespace fascia {
namespace {

constexpr double kFlat = 1e-12;  // twice the area over the squared edge: below, a triangle has no normal

/// One side of an edge: a triangle, and whether it runs from the lower to the higher vertex.
struct EdgeSide {
  std::array<int, 2> vertices{};
  int triangle = 0;
  bool ascending = true;

  bool operator<(const EdgeSide& b) const {
    return vertices != b.vertices ? vertices < b.vertices : triangle < b.triangle;
  }
};

std::vector<EdgeSide> edge_sides(const TriangleMesh& surface, const std::vector<Vec3d>& normal) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * surface.triangles.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!(squared_norm(normal[t]) > 0)) continue;
    for (std::size_t n = 0; n < 3; ++n) {
      const int a = surface.triangles[t][n], b = surface.triangles[t][(n + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, static_cast<int>(t), a < b});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

std::vector<std::vector<int>> edges_at_points(std::size_t point_count, std::span<const std::array<int, 2>> edges) {
  std::vector<std::vector<int>> at_point(point_count);
  for (std::size_t e = 0; e < edges.size(); ++e)
    for (const int v : edges[e]) at_point[at(v)].push_back(static_cast<int>(e));
  return at_point;
}

int other_end(const std::array<int, 2>& edge, int v) { return edge[0] == v ? edge[1] : edge[0]; }

}  // namespace

SurfaceFeatures find_features(const TriangleMesh& surface) {
  SurfaceFeatures features;
  for (const auto& t : surface.triangles) {
    const Vec3d &a = surface.points[at(t[0])], &b = surface.points[at(t[1])], &c = surface.points[at(t[2])];
    const Vec3d normal = cross(b - a, c - a);
    const double longest = std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)});
    features.triangle_normal.push_back(norm(normal) > kFlat * longest ? normal : Vec3d{});
  }
  features.smooth.assign(surface.points.size(), 1);

  const std::vector<EdgeSide> sides = edge_sides(surface, features.triangle_normal);
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].vertices == sides[first].vertices) ++end;
    const Vec3d n = normalized(features.triangle_normal[at(sides[first].triangle)]);
    Vec3d sum = n;
    bool feature = end - first != 2, averaged = end - first < 2;
    if (end - first == 2) {
      // Triangles that run the same way along their edge look to opposite sides.
      const bool turned = sides[first].ascending == sides[first + 1].ascending;
      const Vec3d m = normalized(features.triangle_normal[at(sides[first + 1].triangle)]) * (turned ? -1.0 : 1.0);
      feature = dot(n, m) < kSharpCosine;
      averaged = !feature && !turned;
      if (norm(n + m) > 0.1) sum = n + m;
    }
    if (feature) features.edges.push_back({sides[first].vertices, sides[first].triangle, normalized(sum)});
    if (!averaged)
      for (const int v : sides[first].vertices) features.smooth[at(v)] = 0;
  }
  return features;
}

EdgePaths trace_paths(std::span<const Vec3d> points, std::span<const std::array<int, 2>> edges) {
  const std::vector<std::vector<int>> at_point = edges_at_points(points.size(), edges);
  EdgePaths result;
  std::vector<char> corner(points.size(), 0), used(edges.size(), 0);
  for (std::size_t v = 0; v < points.size(); ++v) {
    const std::vector<int>& around = at_point[v];
    if (around.empty()) continue;
    bool is_corner = around.size() != 2;
    if (!is_corner) {
      const int vertex = static_cast<int>(v);
      const Vec3d in = normalized(points[v] - points[at(other_end(edges[at(around[0])], vertex))]);
      const Vec3d out = normalized(points[at(other_end(edges[at(around[1])], vertex))] - points[v]);
      is_corner = dot(in, out) < kSharpCosine;
    }
    if (!is_corner) continue;
    corner[v] = 1;
    result.corners.push_back(static_cast<int>(v));
    result.edge.push_back(around[0]);
  }

  const auto walk = [&](int start, int edge) {
    EdgePath path;
    path.vertices.push_back(start);
    for (int v = start; edge >= 0;) {
      used[at(edge)] = 1;
      v = other_end(edges[at(edge)], v);
      path.vertices.push_back(v);
      path.edges.push_back(edge);
      edge = -1;
      if (corner[at(v)] != 0) break;
      for (const int next : at_point[at(v)])
        if (used[at(next)] == 0) edge = next;
    }
    path.closed = path.vertices.front() == path.vertices.back() && corner[at(start)] == 0;
    result.paths.push_back(std::move(path));
  };
  for (const int v : result.corners)
    for (const int e : at_point[at(v)])
      if (used[at(e)] == 0) walk(v, e);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (used[e] == 0) walk(edges[e][0], static_cast<int>(e));
  return result;
}

void add_edges(Matter& matter, std::span<const Vec3d> points, std::span<const std::array<int, 2>> edges,
               std::span<const EdgeMatter> edge_matter, int dimension) {
  const EdgePaths traced = trace_paths(points, edges);
  for (std::size_t c = 0; c < traced.corners.size(); ++c) {
    const EdgeMatter& m = edge_matter[at(traced.edge[c])];
    matter.pieces.push_back({points[at(traced.corners[c])], 0, 0, dimension, 0, m.axes, m.extent});
  }
  for (const EdgePath& path : traced.paths) {
    FeatureChain chain;
    chain.dimension = dimension;
    chain.closed = path.closed;
    for (const int v : path.vertices) chain.points.push_back(points[at(v)]);
    for (const int e : path.edges) {
      chain.axes.push_back(edge_matter[at(e)].axes);
      chain.extent.push_back(edge_matter[at(e)].extent);
    }
    matter.chains.push_back(std::move(chain));
  }
}

}  // namespace fascia
