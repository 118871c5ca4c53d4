#pragma once

#include "core/base/index.hpp"
#include "fem/element_mesh.hpp"

#include <algorithm>

/// Edges and faces of meshes of elements, found through their lowest node; for the files of this folder only.
namespace fascia::element_parts {

/// Numbers the edges of a mesh in the order in which they are first named.
class EdgeNumbers {
 public:
  explicit EdgeNumbers(std::size_t node_count) : head_(node_count, -1) {}

  std::size_t size() const { return high_.size(); }

  /// The edge between two nodes; −1 where none was added.
  int find(int a, int b) const {
    const auto [low, high] = std::minmax(a, b);
    int edge = head_[at(low)];
    while (edge >= 0 && high_[at(edge)] != high) edge = next_[at(edge)];
    return edge;
  }
  int add(int a, int b) {
    if (const int known = find(a, b); known >= 0) return known;
    const auto [low, high] = std::minmax(a, b);
    high_.push_back(high);
    next_.push_back(head_[at(low)]);
    return head_[at(low)] = static_cast<int>(high_.size()) - 1;
  }

 private:
  std::vector<int> head_;         ///< by lower node: the last edge that was added
  std::vector<int> high_, next_;  ///< of each edge
};

/// A face of an element.
struct ElementFace {
  std::array<int, 4> key{};  ///< its corners, sorted; a triangle's first is −1
  int element = 0;
  int face = 0;  ///< index into faces_of()
};

/// All faces of all elements; those with the same corners lie side by side, by element.
std::vector<ElementFace> sorted_faces(const ElementMesh& mesh);

/// Calls act(span of ElementFace) once for each set of faces with the same corners.
template <class Act>
void for_each_face(std::span<const ElementFace> sorted, Act&& act) {
  for (std::size_t f = 0, end = 0; f < sorted.size(); f = end) {
    for (end = f; end < sorted.size() && sorted[end].key == sorted[f].key;) ++end;
    act(sorted.subspan(f, end - f));
  }
}

/// The corners of a face of an element, three or four, outward.
std::vector<int> face_corners(const ElementMesh& mesh, const ElementFace& face);
/// The same with the middle nodes of the face's edges behind them, if there are any.
std::vector<int> face_nodes(const ElementMesh& mesh, const ElementFace& face);

/// Adds to each group the middle nodes of its elements' and of its own edges. `edge_node` holds the middle node of each
/// edge of the elements.
void add_edge_nodes(const ElementMesh& mesh, const EdgeNumbers& edges, std::span<const int> edge_node,
                    std::vector<ElementGroup>& groups);

/// Least det dX/dξ of an element at the points of its shape's quadrature [m³].
double least_determinant(const ElementMesh& mesh, std::size_t element);

/// Sorts and drops repetitions.
template <class T>
void make_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace fascia::element_parts
