#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/surface_edges.hpp"
#include "core/geometry/surface_parts.hpp"
#include "core/geometry/surface_touching.hpp"
#include "core/geometry/text.hpp"
#include "shells/shell_mesh.hpp"
#include "shells/surface_checks.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace fascia {
namespace {

using namespace surface_parts;
using message::text;

bool is_any(CellType) { return true; }

/// Points that are neither corners nor middle nodes of cells.
void report_unused_points(const Mesh& mesh, std::vector<std::string>& messages) {
  std::vector<char> used(mesh.points.size(), 0);
  for (const CellBlock& block : mesh.blocks)
    for (const std::vector<int>* nodes : {&block.nodes, &block.mid_nodes})
      for (const int node : *nodes) used[at(node)] = 1;
  const auto first = std::find(used.begin(), used.end(), 0);
  if (first == used.end()) return;
  messages.push_back(mesh.file + ": left out " + std::to_string(std::count(used.begin(), used.end(), 0)) +
                     " points that no cell uses (the first: node " +
                     std::to_string(mesh.point_file_number[static_cast<std::size_t>(first - used.begin())]) + ")");
}

/// What the shell takes of a mesh, where that may surprise.
void report_choice(const Mesh& mesh, std::vector<std::string>& messages) {
  const std::size_t triangles = count_cells(mesh, is_surface), volumes = count_cells(mesh, is_volume);
  if (triangles > 0 && volumes > 0)
    messages.push_back(mesh.file + ": the shell is its " + std::to_string(triangles) + " surface cells; its " +
                       std::to_string(volumes) + " volume cells are left out");
  if (triangles == 0)
    messages.push_back(mesh.file + ": has no triangles; the shell is the boundary of its " + std::to_string(volumes) +
                       " volume cells");
  for (const CellBlock& block : mesh.blocks)
    if (block.mid_nodes_per_cell > 0 && (is_surface(block.type) || triangles == 0) && block.size() > 0) {
      messages.push_back(mesh.file + ": its cells are quadratic; only their corners are used");
      break;
    }
}

/// The numbers of the triangles at an edge, the first few of many.
std::string numbers_of(const std::vector<Triangle>& triangles, std::span<const Edge> edges) {
  constexpr std::size_t most = 3;
  const std::size_t named = edges.size() > most ? most : edges.size() - 1;
  const auto number = [&](std::size_t e) { return std::to_string(triangles[at(edges[e].triangle)].file_number); };
  std::string numbers = number(0);
  for (std::size_t e = 1; e < named; ++e) numbers += ", " + number(e);
  return numbers + " and " + (edges.size() > most ? std::to_string(edges.size() - most) + " more" : number(named));
}

/// @throws InputError  an edge of three triangles or more, where no surfaces that bound something just touch
void check_edges(const Solid& sheet, const std::vector<Triangle>& triangles) {
  const std::vector<Edge> edges = sorted_edges(triangles);
  std::span<const Edge> most;  // triangles of the first that has too many
  std::size_t count = 0;
  std::vector<bool> bounds;  // of each triangle; once it is asked
  const auto bounding = [&](const Edge& edge) -> bool {
    if (bounds.empty()) bounds = bounding_triangles(triangles);
    return bounds[at(edge.triangle)];
  };
  surface_parts::for_each_edge(edges, [&](std::span<const Edge> meeting) {
    if (meeting.size() <= 2 || (balanced(meeting) && std::ranges::all_of(meeting, bounding))) return;
    if (count++ == 0) most = meeting;
  });
  if (count == 0) return;
  const auto node = [&](int n) { return std::to_string(sheet.point_file_number[at(n)]); };
  const std::string numbers = numbers_of(triangles, most);
  const Edge& edge = most[0];
  fail(sheet, "triangles " + numbers + " share the edge between nodes " + node(edge.low) + " and " + node(edge.high) +
                  ", at " + text((sheet.points[at(edge.low)] + sheet.points[at(edge.high)]) * 0.5) +
                  (count > 1 ? " (" + std::to_string(count) + " such edges)" : "") +
                  "; an edge of a shell must belong to one triangle or two: remove what overlaps, or make the parts "
                  "that branch off bodies of their own");
}

/// Triangles by their sorted nodes.
class TriangleFinder {
 public:
  explicit TriangleFinder(const std::vector<Triangle>& triangles) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      entries_.push_back({sorted(triangles[t].nodes), static_cast<int>(t)});
    std::sort(entries_.begin(), entries_.end());
  }

  /// Adds the triangle with these nodes, if there is one.
  void add(const std::array<int, 3>& nodes, std::vector<int>& to) const {
    const std::pair key{sorted(nodes), -1};
    const auto found = std::lower_bound(entries_.begin(), entries_.end(), key);
    if (found != entries_.end() && found->first == key.first) to.push_back(found->second);
  }

 private:
  static std::array<int, 3> sorted(std::array<int, 3> nodes) {
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  }
  std::vector<std::pair<std::array<int, 3>, int>> entries_;
};

/// The triangles of the surface that a cell of the file has.
void add_triangles(const Cell& cell, const TriangleFinder& finder, std::vector<int>& to) {
  const auto& n = cell.nodes;
  if (cell.type == CellType::triangle) finder.add({n[0], n[1], n[2]}, to);
  if (cell.type != CellType::quadrilateral) return;
  for (std::size_t left_out = 0; left_out < 4; ++left_out)
    finder.add({n[(left_out + 1) % 4], n[(left_out + 2) % 4], n[(left_out + 3) % 4]}, to);
}

void make_unique(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Adds to groups the triangles that are the boundary of their volume cells.
void add_boundaries(const std::vector<Cell>& volumes, const std::vector<Triangle>& triangles,
                    std::vector<BodyGroup>& groups) {
  std::vector<std::vector<int>> of_cell(volumes.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) of_cell[at(triangles[t].cell)].push_back(static_cast<int>(t));
  const std::vector<int> first = first_copies(volumes);  // it has the triangles of those that repeat it
  for (std::size_t c = 0; c < volumes.size(); ++c) {
    if (volumes[c].group < 0) continue;
    std::vector<int>& cells = groups[at(volumes[c].group)].cells;
    cells.insert(cells.end(), of_cell[at(first[c])].begin(), of_cell[at(first[c])].end());
  }
}

/// @param used  what the triangles were made of
/// @param node  of each point of `all`; −1 where it is none
std::vector<BodyGroup> groups_of(const Mesh& mesh, const Solid& all, const Solid& used,
                                 const std::vector<Triangle>& triangles, const std::vector<int>& node) {
  std::vector<BodyGroup> groups;
  for (const MeshGroup& g : mesh.groups) groups.push_back({g.name, g.number, g.dimension, {}, {}});
  const TriangleFinder finder(triangles);
  for (const Cell& cell : all.cells) {
    if (cell.group < 0) continue;
    BodyGroup& group = groups[at(cell.group)];
    for (int n = 0; n < node_count(cell.type); ++n)
      if (const int i = node[at(cell.nodes[at(n)])]; i >= 0) group.nodes.push_back(i);
    add_triangles(cell, finder, group.cells);
  }
  if (is_volume(used.cells.front().type)) add_boundaries(used.cells, triangles, groups);
  for (BodyGroup& group : groups) {
    make_unique(group.nodes);
    make_unique(group.cells);
  }
  return groups;
}

/// The edges of each group's line cells. @param node  as for groups_of
std::vector<std::vector<std::array<int, 2>>> lines_of(const Mesh& mesh, const Solid& all,
                                                      const std::vector<int>& node) {
  std::vector<std::vector<std::array<int, 2>>> lines(mesh.groups.size());
  for (const Cell& cell : all.cells) {
    if (cell.group < 0 || cell.type != CellType::line) continue;
    const auto [low, high] = std::minmax(node[at(cell.nodes[0])], node[at(cell.nodes[1])]);
    if (low >= 0) lines[at(cell.group)].push_back({low, high});
  }
  for (auto& edges : lines) {
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
  return lines;
}

/// Gives lines along which the surface was split the edges of both sides.
void part_lines(ShellMesh& mesh, const PartedSurface& parted, int former_nodes) {
  std::vector<int> original(mesh.nodes.size());
  std::iota(original.begin(), original.end(), 0);
  for (std::size_t k = 0; k < parted.added.size(); ++k)
    if (const auto& [a, b] = parted.added[k]; a == b) original[at(former_nodes) + k] = original[at(a)];
  for (auto& edges : mesh.lines) {
    const auto former = edges;
    for (const Triangle& t : parted.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t.nodes[k], b = t.nodes[(k + 1) % 3];
        const auto [low, high] = std::minmax(original[at(a)], original[at(b)]);
        if (std::max(a, b) >= former_nodes && std::ranges::binary_search(former, std::array{low, high}))
          edges.push_back({std::min(a, b), std::max(a, b)});
      }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
}

/// Gives a group the new triangles and nodes. Of a node and its copies a group has those that its triangles use; where
/// they use none of them, and in groups of points and lines, it has all.
void part_group(BodyGroup& group, const PartedSurface& parted, int former_nodes, int former_triangles) {
  const auto has = [](const std::vector<int>& members, int i) { return std::ranges::binary_search(members, i); };
  for (int t = former_triangles; const int whole : parted.half_of) {
    if (has(group.cells, whole)) group.cells.push_back(t);
    ++t;
  }
  std::vector<int> used, chosen;  // nodes that its triangles use; nodes of which they choose among the copies
  if (group.dimension >= 2)
    for (const int t : group.cells)
      for (const int node : parted.triangles[at(t)].nodes) used.push_back(node);
  make_unique(used);
  for (int added = former_nodes; const auto& [a, b] : parted.added) {
    if (a == b && (has(used, a) || has(used, added))) chosen.push_back(a);
    ++added;
  }
  make_unique(chosen);
  for (int added = former_nodes; const auto& [a, b] : parted.added) {
    const bool all = a == b ? !has(chosen, a) : used.empty();
    if (has(used, added) || (all && has(group.nodes, a) && has(group.nodes, b))) group.nodes.push_back(added);
    ++added;
  }
  std::erase_if(group.nodes, [&](int node) { return has(chosen, node) && !has(used, node); });
}

/// Gives what touches along edges nodes of its own there. Groups get the new nodes and triangles too.
void part_where_touching(ShellMesh& mesh) {
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) triangles.push_back({mesh.triangles[t], mesh.file_number[t]});
  const std::vector<TouchingEdge> touching = touching_edges(mesh.nodes, triangles);
  if (touching.empty()) return;
  const int former_nodes = static_cast<int>(mesh.nodes.size()), former = static_cast<int>(triangles.size());
  const PartedSurface parted = part_at(touching, mesh.nodes.size(), std::move(triangles));
  mesh.messages.push_back(
      mesh.file + ": touches itself along " + std::to_string(touching.size()) +
      (touching.size() == 1 ? " edge, at " : " edges, the first at ") +
      text((mesh.nodes[at(touching[0].low)] + mesh.nodes[at(touching[0].high)]) * 0.5) +
      "; split there: what met is not joined" +
      (parted.joined > 0 ? ", but in one node where a part would come loose (" + std::to_string(parted.joined) + ")"
                         : ""));
  for (const auto& [a, b] : parted.added) mesh.nodes.push_back((mesh.nodes[at(a)] + mesh.nodes[at(b)]) * 0.5);
  mesh.triangles.clear();
  mesh.file_number.clear();
  for (const Triangle& t : parted.triangles) {
    mesh.triangles.push_back(t.nodes);
    mesh.file_number.push_back(t.file_number);
  }
  for (BodyGroup& group : mesh.groups) part_group(group, parted, former_nodes, former);
  part_lines(mesh, parted, former_nodes);
}

/// The number of each point among those that triangles use, in their order; −1 for the others.
std::vector<int> number_nodes(const Solid& solid, const std::vector<Triangle>& triangles) {
  std::vector<int> number(solid.points.size(), -1);
  for (const Triangle& t : triangles)
    for (const int node : t.nodes) number[at(node)] = 0;
  int next = 0;
  for (int& n : number)
    if (n == 0) n = next++;
  return number;
}

}  // namespace

ShellMesh shell_mesh(const Mesh& mesh) {
  check_points(mesh);
  const bool of_volumes = count_cells(mesh, is_surface) == 0;
  if (of_volumes && count_cells(mesh, is_volume) == 0)
    throw InputError(mesh.file + ": has no triangles; a shell needs a surface of triangles or quadrilaterals");
  ShellMesh result;
  result.file = mesh.file;
  result.messages = mesh.messages;
  report_choice(mesh, result.messages);
  report_unused_points(mesh, result.messages);

  const Solid all = make_solid(mesh, is_any, result.messages);
  std::vector<Cell> cells;
  for (const Cell& cell : all.cells)
    if (of_volumes ? is_volume(cell.type) : is_surface(cell.type)) cells.push_back(cell);
  const Solid used = with_cells(all, std::move(cells));
  std::vector<Triangle> triangles = of_volumes ? boundary_of_cells(used, result.messages)
                                               : triangles_of_cells(used, Surface::of_sheet, result.messages);
  orient_sheet(used, triangles, result.messages);
  check_edges(used, triangles);

  TriangleMesh surface = compact(used, triangles);
  result.nodes = std::move(surface.points);
  result.triangles = std::move(surface.triangles);
  for (const Triangle& t : triangles) result.file_number.push_back(t.file_number);
  const std::vector<int> node = number_nodes(used, triangles);
  result.groups = groups_of(mesh, all, used, triangles, node);
  result.lines = lines_of(mesh, all, node);
  part_where_touching(result);
  for (const BodyGroup& group : result.groups)
    if (group.nodes.empty())
      result.messages.push_back(mesh.file + ": group \"" + group.name + "\" has no nodes of the shell");
  return result;
}

}  // namespace fascia
