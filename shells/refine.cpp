#include "shells/refine.hpp"

#include "core/base/index.hpp"

#include <algorithm>

namespace fascia {
namespace {

using Edge = std::array<int, 2>;

template <class T>
void make_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

Edge edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<Edge> edges_of(const ShellMesh& mesh) {
  std::vector<Edge> edges;
  for (const auto& [a, b, c] : mesh.triangles) edges.insert(edges.end(), {edge(a, b), edge(b, c), edge(c, a)});
  make_unique(edges);
  return edges;
}

}  // namespace

ShellMesh refined(const ShellMesh& mesh) {
  const std::vector<Edge> edges = edges_of(mesh);
  const int former = static_cast<int>(mesh.nodes.size());
  // −1 where the surface has no such edge.
  const auto middle = [&](int a, int b) {
    const auto found = std::ranges::lower_bound(edges, edge(a, b));
    return found != edges.end() && *found == edge(a, b) ? former + static_cast<int>(found - edges.begin()) : -1;
  };
  ShellMesh result = mesh;
  for (const auto& [a, b] : edges) result.nodes.push_back(0.5 * (mesh.nodes[at(a)] + mesh.nodes[at(b)]));
  result.triangles.clear();
  result.file_number.clear();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    result.triangles.insert(result.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    if (!mesh.file_number.empty()) result.file_number.insert(result.file_number.end(), 4, mesh.file_number[t]);
  }
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    BodyGroup& group = result.groups[g];
    group.cells.clear();
    for (const int t : mesh.groups[g].cells)
      for (int k = 0; k < 4; ++k) {
        group.cells.push_back(4 * t + k);
        const auto& nodes = result.triangles[at(4 * t + k)];
        group.nodes.insert(group.nodes.end(), nodes.begin(), nodes.end());
      }
    if (g >= mesh.lines.size()) continue;
    result.lines[g].clear();
    for (const auto& [a, b] : mesh.lines[g]) {
      const int m = middle(a, b);
      if (m < 0) continue;
      group.nodes.push_back(m);
      result.lines[g].insert(result.lines[g].end(), {edge(a, m), edge(m, b)});
    }
    make_unique(group.nodes);
    make_unique(result.lines[g]);
  }
  return result;
}

}  // namespace fascia
