#include "core/base/disjoint_sets.hpp"
#include "core/base/errors.hpp"
#include "fem/from_mesh_parts.hpp"

#include <cmath>

namespace fascia::from_mesh_parts {
namespace {

using namespace element_parts;

constexpr double flat_volume = 1e-9;      // of the cube of an element's longest edge
constexpr double least_jacobian = 1e-12;  // the same

std::string number_of(const ElementMesh& mesh, int element) { return std::to_string(mesh.element_number[at(element)]); }

void check_repeated_nodes(const ElementMesh& mesh) {
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    std::vector<int> nodes(mesh.element(e).begin(), mesh.element(e).end());
    std::ranges::sort(nodes);
    const auto twice = std::ranges::adjacent_find(nodes);
    if (twice != nodes.end())
      fail(mesh.file, "element " + std::to_string(mesh.element_number[e]) + " uses node " +
                          std::to_string(mesh.node_number[at(*twice)]) + " twice; must have " +
                          std::to_string(nodes.size()) + " different nodes");
  }
}

double longest_edge(const ElementMesh& mesh, std::size_t e) {
  double longest = 0;
  const auto nodes = mesh.element(e);
  for (const auto& [a, b] : edges_of(family_of(mesh.shape)))
    longest = std::max(longest, norm(mesh.nodes[at(nodes[at(a)])] - mesh.nodes[at(nodes[at(b)])]));
  return longest;
}

/// Mirrored numbering of an element's nodes: the same edges, the other orientation.
std::vector<std::size_t> mirrored_nodes(ElementShape shape) {
  const ElementFamily family = family_of(shape);
  std::vector<std::size_t> order = family == ElementFamily::tetrahedra
                                       ? std::vector<std::size_t>{0, 2, 1, 3}
                                       : std::vector<std::size_t>{4, 5, 6, 7, 0, 1, 2, 3};
  if (order_of(shape) == 1) return order;
  const auto edges = edges_of(family);
  const std::size_t corners = order.size();
  for (const auto& [a, b] : edges) {
    const int i = static_cast<int>(order[at(a)]), j = static_cast<int>(order[at(b)]);
    const auto same = std::ranges::find_if(edges, [&](const std::array<int, 2>& edge) {
      return (edge[0] == i && edge[1] == j) || (edge[0] == j && edge[1] == i);
    });
    order.push_back(corners + static_cast<std::size_t>(same - edges.begin()));
  }
  return order;
}

void turn_over(ElementMesh& mesh) {
  const std::vector<std::size_t> order = mirrored_nodes(mesh.shape);
  const std::vector<int> before = mesh.element_nodes;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const std::size_t n = k % order.size();
    mesh.element_nodes[k] = before[k - n + order[n]];
  }
}

/// The mesh on its corners.
ElementMesh corners_only(const ElementMesh& mesh) {
  ElementMesh linear;
  linear.shape = element_shape(family_of(mesh.shape), 1);
  linear.nodes = mesh.nodes;
  for (std::size_t e = 0; e < mesh.size(); ++e)
    for (int n = 0; n < corner_count(mesh.shape); ++n) linear.element_nodes.push_back(mesh.element(e)[at(n)]);
  return linear;
}

int parts_by_nodes(const ElementMesh& mesh) {
  DisjointSets elements(static_cast<int>(mesh.size()));
  std::vector<int> owner(mesh.nodes.size(), -1);
  for (std::size_t e = 0; e < mesh.size(); ++e)
    for (const int n : mesh.element(e)) {
      if (owner[at(n)] < 0) owner[at(n)] = static_cast<int>(e);
      elements.join(owner[at(n)], static_cast<int>(e));
    }
  return elements.sets();
}

/// The same corners in opposite order around the face: elements on either side of it.
bool opposite(const std::vector<int>& a, const std::vector<int>& b) {
  const std::size_t n = a.size(), start = static_cast<std::size_t>(std::ranges::find(b, a[0]) - b.begin());
  return b[(start + n - 1) % n] == a[1];
}

}  // namespace

void fail(const std::string& file, const std::string& message) { throw InputError(file + ": " + message); }

std::string first_few(const std::vector<std::int64_t>& numbers) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, numbers.size()); ++k)
    text += (k > 0 ? ", " : "") + std::to_string(numbers[k]);
  return numbers.size() > most ? text + " and " + std::to_string(numbers.size() - most) + " more" : text;
}

void check_corners(ElementMesh& mesh) {
  check_repeated_nodes(mesh);
  const ElementMesh linear = corners_only(mesh);
  std::vector<std::int64_t> right, wrong;
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const double volume = element_volume(linear, e), length = longest_edge(linear, e);
    if (!(std::abs(volume) > flat_volume * length * length * length))
      fail(mesh.file, "element " + std::to_string(mesh.element_number[e]) + " is flat (its volume is below 1e-9 of " +
                          "its longest edge cubed); remove it or mesh again");
    (volume > 0 ? right : wrong).push_back(mesh.element_number[e]);
  }
  if (wrong.empty()) return;
  if (!right.empty()) {
    const std::vector<std::int64_t>& few = wrong.size() <= right.size() ? wrong : right;
    fail(mesh.file, std::string(few.size() > 1 ? "elements " : "element ") + first_few(few) +
                        (few.size() > 1 ? " are" : " is") +
                        (&few == &wrong ? " turned the wrong way round" : " turned against the others") + " (" +
                        std::to_string(few.size()) + " of " + std::to_string(mesh.size()) +
                        " elements); number the nodes of all elements alike");
  }
  turn_over(mesh);
  mesh.messages.push_back(mesh.file + ": all " + std::to_string(mesh.size()) +
                          " elements are turned the wrong way round; turned over");
}

void check_middles(const ElementMesh& mesh) {
  EdgeNumbers edges(mesh.nodes.size());
  std::vector<std::array<int, 2>> middle_and_element;
  const std::size_t corners = at(corner_count(mesh.shape));
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const auto nodes = mesh.element(e);
    std::size_t k = corners;
    for (const auto& [a, b] : edges_of(family_of(mesh.shape))) {
      const int i = nodes[at(a)], j = nodes[at(b)], middle = nodes[k++];
      const int edge = edges.add(i, j);
      if (at(edge) == middle_and_element.size()) middle_and_element.push_back({middle, static_cast<int>(e)});
      const auto& [other, element] = middle_and_element[at(edge)];
      if (other != middle)
        fail(mesh.file, "elements " + number_of(mesh, element) + " and " + number_of(mesh, static_cast<int>(e)) +
                            " have different nodes (" + std::to_string(mesh.node_number[at(other)]) + " and " +
                            std::to_string(mesh.node_number[at(middle)]) + ") in the middle of the edge from node " +
                            std::to_string(mesh.node_number[at(i)]) + " to node " +
                            std::to_string(mesh.node_number[at(j)]) + "; must share one");
    }
  }
}

void check_folds(const ElementMesh& mesh) {
  std::vector<std::int64_t> folded;
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const double length = longest_edge(mesh, e);
    bool sound = least_determinant(mesh, e) > least_jacobian * length * length * length;
    if (order_of(mesh.shape) == 2)
      for (const Vec3d& corner : reference_corners(family_of(mesh.shape)))
        sound = sound && shape_at(mesh, e, corner).det_J > 0;
    if (!sound) folded.push_back(mesh.element_number[e]);
  }
  if (folded.empty()) return;
  const bool curved = order_of(mesh.shape) == 2;
  fail(mesh.file, std::string(folded.size() > 1 ? "elements " : "element ") + first_few(folded) +
                      (folded.size() > 1 ? " are" : " is") +
                      " folded (the volume turns over at an integration point or a corner); " +
                      (curved ? "move their middle nodes towards the middle of their edges or use order = 1"
                              : "correct the order of their nodes or mesh again"));
}

void check_faces(ElementMesh& mesh) {
  DisjointSets elements(static_cast<int>(mesh.size()));
  const std::vector<ElementFace> faces = sorted_faces(mesh);
  for_each_face(faces, [&](std::span<const ElementFace> same) {
    if (same.size() > 2)
      fail(mesh.file, "elements " + number_of(mesh, same[0].element) + ", " + number_of(mesh, same[1].element) +
                          " and " + number_of(mesh, same[2].element) +
                          " share a face, which must belong to one or two; remove what overlaps or mesh again");
    if (same.size() < 2) return;
    if (!opposite(face_corners(mesh, same[0]), face_corners(mesh, same[1])))
      fail(mesh.file, "elements " + number_of(mesh, same[0].element) + " and " + number_of(mesh, same[1].element) +
                          " overlap: they lie on the same side of a common face; mesh again");
    elements.join(same[0].element, same[1].element);
  });
  const int by_faces = elements.sets(), by_nodes = by_faces > 1 ? parts_by_nodes(mesh) : 1;
  if (by_nodes > 1)
    mesh.messages.push_back(mesh.file + ": falls into " + std::to_string(by_nodes) + " parts that share no node");
  if (by_faces > by_nodes)
    mesh.messages.push_back(mesh.file + ": " + std::to_string(by_faces) +
                            " parts share no face; where they meet in a node or an edge only, they turn as on a hinge");
}

void drop_unused(ElementMesh& mesh, const std::vector<char>& middle, std::vector<int>& kept) {
  kept.assign(mesh.nodes.size(), -1);
  for (const int n : mesh.element_nodes) kept[at(n)] = 0;
  std::vector<std::int64_t> dropped;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] < 0) {
      if (!middle[i]) dropped.push_back(mesh.node_number[i]);
      continue;
    }
    kept[i] = static_cast<int>(count);
    mesh.nodes[count] = mesh.nodes[i];
    mesh.node_number[count++] = mesh.node_number[i];
  }
  mesh.nodes.resize(count);
  mesh.node_number.resize(count);
  for (int& n : mesh.element_nodes) n = kept[at(n)];
  if (!dropped.empty())
    mesh.messages.push_back(mesh.file + ": dropped " + std::to_string(dropped.size()) +
                            " nodes that no element uses (the first: node " + std::to_string(dropped.front()) + ")");
}

}  // namespace fascia::from_mesh_parts
