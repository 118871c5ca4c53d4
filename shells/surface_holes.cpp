#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"
#include "core/geometry/surface_edges.hpp"
#include "core/geometry/text.hpp"
#include "shells/surface_checks.hpp"

#include <algorithm>

namespace fascia {
namespace {

using surface_parts::Edge;

std::vector<surface_parts::Triangle> triangles_of(const ShellMesh& mesh) {
  std::vector<surface_parts::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& nodes : mesh.triangles) triangles.push_back({nodes, 0});
  return triangles;
}

/// Edges that one triangle has.
std::vector<Edge> free_edges(const ShellMesh& mesh) {
  const std::vector<Edge> edges = surface_parts::sorted_edges(triangles_of(mesh));
  std::vector<Edge> result;
  surface_parts::for_each_edge(edges, [&](std::span<const Edge> same) {
    if (same.size() == 1) result.push_back(same[0]);
  });
  return result;
}

}  // namespace

std::vector<ShellHole> holes(const ShellMesh& mesh) {
  const std::vector<Edge> edges = free_edges(mesh);
  DisjointSets nodes(static_cast<int>(mesh.nodes.size()));
  for (const Edge& edge : edges) nodes.join(edge.low, edge.high);
  std::vector<int> hole_of(mesh.nodes.size(), -1);
  std::vector<ShellHole> result;
  for (const Edge& edge : edges) {
    int& index = hole_of[at(nodes.root(edge.low))];
    if (index < 0) {
      index = static_cast<int>(result.size());
      result.emplace_back().triangle = at(edge.triangle);
    }
    ShellHole& hole = result[at(index)];
    const Vec3d &a = mesh.nodes[at(edge.low)], &b = mesh.nodes[at(edge.high)];
    ++hole.edges;
    hole.length += norm(b - a);
    hole.middle += norm(b - a) / 2 * (a + b);
    hole.nodes.push_back(edge.low);
    hole.nodes.push_back(edge.high);
  }
  for (ShellHole& hole : result) {
    hole.middle *= 1 / hole.length;
    std::sort(hole.nodes.begin(), hole.nodes.end());
    hole.nodes.erase(std::unique(hole.nodes.begin(), hole.nodes.end()), hole.nodes.end());
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const ShellHole& a, const ShellHole& b) { return a.length > b.length; });
  return result;
}

std::string openness(const ShellMesh& mesh) {
  using message::text;
  const std::vector<ShellHole> found = holes(mesh);
  if (found.empty()) return "";
  const ShellHole& hole = found.front();
  return "is open: it has " + std::to_string(found.size()) + (found.size() > 1 ? " holes, the longest" : " hole,") +
         " of " + std::to_string(hole.edges) + " edges about " + text(hole.middle) + ", next to " +
         name_of(mesh, hole.triangle);
}

ShellParts parts_of(const ShellMesh& mesh) {
  DisjointSets nodes(static_cast<int>(mesh.nodes.size())), corners(static_cast<int>(3 * mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    nodes.join(t[0], t[1]);
    nodes.join(t[0], t[2]);
  }
  const auto corner = [&](int triangle, int node) {
    const auto& t = mesh.triangles[at(triangle)];
    return 3 * triangle + static_cast<int>(std::find(t.begin(), t.end(), node) - t.begin());
  };
  const std::vector<Edge> edges = surface_parts::sorted_edges(triangles_of(mesh));
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    if (!edges[e].same_as(edges[e + 1])) continue;
    for (const int node : {edges[e].low, edges[e].high})
      corners.join(corner(edges[e].triangle, node), corner(edges[e + 1].triangle, node));
  }
  ShellParts parts;
  parts.count = nodes.sets();
  std::vector<int> fans(mesh.nodes.size(), 0);  // triangles about a node that hang together by edges
  for (std::size_t c = 0; c < 3 * mesh.triangles.size(); ++c)
    if (corners.root(static_cast<int>(c)) == static_cast<int>(c)) ++fans[at(mesh.triangles[c / 3][c % 3])];
  for (std::size_t i = 0; i < fans.size(); ++i) {
    if (fans[i] > 1) parts.pinched.push_back(static_cast<int>(i));
  }
  return parts;
}

double enclosed_volume(const ShellMesh& mesh) { return surface_parts::enclosed_volume(mesh.nodes, triangles_of(mesh)); }

}  // namespace fascia
