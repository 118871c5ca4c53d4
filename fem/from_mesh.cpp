#include "fem/from_mesh.hpp"

#include "core/base/errors.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/weld.hpp"
#include "fem/from_mesh_parts.hpp"

#include <cmath>

namespace fascia {
namespace {

using namespace element_parts;
using namespace from_mesh_parts;

void check_points(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(mesh.points[i][c]) <= 1e60))
        fail(mesh.file, "node " + std::to_string(mesh.point_file_number[i]) + " has a coordinate that is no finite " +
                            "number below 1e60; correct it");
}

std::vector<char> middle_nodes(const Mesh& mesh) {
  std::vector<char> middle(mesh.points.size(), 0);
  for (const CellBlock& block : mesh.blocks)
    for (const int n : block.mid_nodes) middle[at(n)] = 1;
  return middle;
}

void append_edges(const CellBlock& block, std::size_t cell, const std::vector<int>& kept, ElementGroup& group) {
  const int n = node_count(block.type), count = mid_node_count(block.type);
  const auto node = [&](int k) { return kept[at(block.nodes[cell * at(n) + at(k % n)])]; };
  for (int k = 0; k < count; ++k) {
    const auto [low, high] = std::minmax({node(k), node(k + 1)});
    if (low >= 0 && low != high) group.edges.push_back({low, high});
  }
}

void append_face(const CellBlock& block, std::size_t cell, const std::vector<int>& kept, ElementGroup& group) {
  if (dimension_of(block.type) != 2) return;
  std::array<int, 4> face{-1, -1, -1, -1};
  const std::size_t n = at(node_count(block.type));
  for (std::size_t k = 0; k < n; ++k)
    if ((face[k] = kept[at(block.nodes[cell * n + k])]) < 0) return;
  group.faces.push_back(face);
}

/// The file's groups with the corners of their cells.
std::vector<ElementGroup> make_groups(const Mesh& mesh, const Cells& cells, const std::vector<int>& kept) {
  std::vector<ElementGroup> groups;
  for (std::size_t g = 0; g < mesh.groups.size(); ++g)
    groups.push_back(
        {mesh.groups[g].name, mesh.groups[g].number, mesh.groups[g].dimension, {}, cells.elements_of_group[g], {}, {}});
  for (const CellBlock& block : mesh.blocks) {
    const std::size_t n = at(node_count(block.type));
    for (std::size_t c = 0; c < block.size(); ++c) {
      if (block.group[c] < 0) continue;
      ElementGroup& group = groups[at(block.group[c])];
      for (std::size_t k = 0; k < n; ++k)
        if (const int node = kept[at(block.nodes[c * n + k])]; node >= 0) group.nodes.push_back(node);
      if (dimension_of(block.type) < 3) append_edges(block, c, kept, group);
      append_face(block, c, kept, group);
    }
  }
  for (ElementGroup& group : groups) {
    make_unique(group.nodes);
    make_unique(group.elements);
    make_unique(group.edges);
  }
  return groups;
}

/// Groups of a mesh that the file itself has made quadratic.
void add_file_middles(ElementMesh& mesh) {
  EdgeNumbers edges(mesh.nodes.size());
  std::vector<int> edge_node;
  const std::size_t corners = at(corner_count(mesh.shape));
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const auto nodes = mesh.element(e);
    std::size_t k = corners;
    for (const auto& [a, b] : edges_of(family_of(mesh.shape))) {
      if (at(edges.add(nodes[at(a)], nodes[at(b)])) == edge_node.size()) edge_node.push_back(nodes[k]);
      ++k;
    }
  }
  add_edge_nodes(mesh, edges, edge_node, mesh.groups);
}

void report_coincident(ElementMesh& mesh) {
  const std::vector<int> same = weld_points(mesh.nodes, 1e-9 * bounds_of(mesh.nodes).diagonal());
  std::size_t count = 0, first = 0;
  for (std::size_t i = same.size(); i-- > 0;) {
    if (same[i] == static_cast<int>(i)) continue;
    ++count;
    first = i;
  }
  if (count == 0) return;
  mesh.messages.push_back(mesh.file + ": " + std::to_string(count) + " nodes coincide with others (the first: node " +
                          std::to_string(mesh.node_number[first]) + " with node " +
                          std::to_string(mesh.node_number[at(same[first])]) +
                          "); elements there are not joined, merge the nodes if they should be");
}

}  // namespace

ElementMesh element_mesh(const Mesh& mesh, ElementFamily family, int order) {
  if (order != 1 && order != 2) throw InputError("elements of order " + std::to_string(order) + "; must be 1 or 2");
  check_points(mesh);
  Cells cells = distinct_cells(mesh, family, order);
  ElementMesh& result = cells.mesh;
  check_corners(result);
  check_faces(result);
  if (order_of(result.shape) == 2) check_middles(result);
  check_folds(result);

  std::vector<int> kept;
  drop_unused(result, middle_nodes(mesh), kept);
  report_coincident(result);
  result.groups = make_groups(mesh, cells, kept);
  if (order_of(result.shape) == 2)
    add_file_middles(result);
  else if (order == 2)
    result = quadratic(result);
  for (const ElementGroup& group : result.groups)
    if (group.nodes.empty())
      result.messages.push_back(mesh.file + ": group \"" + group.name + "\" has no nodes of elements");
  return std::move(cells.mesh);
}

}  // namespace fascia
