#include "fem/refine.hpp"

#include "core/base/index.hpp"
#include "fem/element_mesh_parts.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace fascia {
namespace {

using element_parts::make_unique;

constexpr int kWhole = 64;  // the parts of a place's weights, so that they are whole numbers

/// A place of an element by the weights of its corners, in 64ths: barycentric or trilinear.
using Weights = std::array<int, 8>;

Weights between(const Weights& a, const Weights& b) {
  Weights w{};
  for (std::size_t c = 0; c < w.size(); ++c) w[c] = (a[c] + b[c]) / 2;
  return w;
}

Weights at_corner(std::size_t corner) {
  Weights w{};
  w[corner] = kWhole;
  return w;
}

/// The corners of a child.
using Child = std::array<Weights, 8>;

double reference_volume(const std::array<Weights, 4>& corners) {
  std::array<Vec3d, 4> x;
  for (std::size_t c = 0; c < 4; ++c)
    x[c] = Vec3d{{double(corners[c][1]), double(corners[c][2]), double(corners[c][3])}};
  return dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0]));
}

/// Eight tetrahedra; `diagonal` says which of 01–23, 02–13 and 03–12 the four in the middle share.
std::vector<Child> children_of_tetrahedron(int diagonal) {
  std::array<std::array<Weights, 4>, 4> m;  // at corners and in the middle of edges
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) m[i][j] = between(at_corner(i), at_corner(j));
  std::vector<Child> children;
  for (std::size_t i = 0; i < 4; ++i) children.push_back({m[i][0], m[i][1], m[i][2], m[i][3]});
  // The ends of the diagonal, and the other four middles in a ring about it.
  const std::array<std::array<Weights, 6>, 3> cuts{{{m[0][1], m[2][3], m[0][2], m[1][2], m[1][3], m[0][3]},
                                                    {m[0][2], m[1][3], m[0][1], m[1][2], m[2][3], m[0][3]},
                                                    {m[0][3], m[1][2], m[0][1], m[0][2], m[2][3], m[1][3]}}};
  const std::array<Weights, 6>& cut = cuts[at(diagonal)];
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<Weights, 4> corners{cut[0], cut[1], cut[2 + k], cut[2 + (k + 1) % 4]};
    if (reference_volume(corners) < 0) std::swap(corners[2], corners[3]);
    children.push_back({corners[0], corners[1], corners[2], corners[3]});
  }
  return children;
}

std::vector<Child> children_of_hexahedron() {
  const std::span<const Vec3d> corners = reference_corners(ElementFamily::hexahedra);
  std::vector<Child> children;
  for (const Vec3d& part : corners) {
    Child child{};
    for (std::size_t n = 0; n < 8; ++n) {
      const Vec3d xi = 0.5 * (part + corners[n]);  // in −1, 0, 1
      for (std::size_t c = 0; c < 8; ++c) {
        double w = kWhole;
        for (int a = 0; a < 3; ++a) w *= 0.5 * (1 + corners[c][a] * xi[a]);
        child[n][c] = static_cast<int>(w);
      }
    }
    children.push_back(child);
  }
  return children;
}

/// The nodes of the finer mesh, each made when it is first asked for: places on shared edges and faces are the same.
class Nodes {
 public:
  /// Weights of corners: node · 128 + weight, descending; zero where there is none.
  using Key = std::array<std::int64_t, 8>;

  Nodes(const ElementMesh& mesh, ElementMesh& result) : mesh_(mesh), result_(result) {
    const std::size_t corners = at(corner_count(mesh.shape));
    for (std::size_t e = 0; e < mesh.size(); ++e) {
      const auto nodes = mesh.element(e);
      for (std::size_t c = 0; c < corners; ++c) known_.emplace(key_of(e, at_corner(c)), nodes[c]);
      for (std::size_t k = corners; k < nodes.size(); ++k) {
        const auto& [a, b] = edges_of(family_of(mesh.shape))[k - corners];
        known_.emplace(key_of(e, between(at_corner(at(a)), at_corner(at(b)))), nodes[k]);
      }
    }
    if (!mesh.node_number.empty()) number_ = *std::ranges::max_element(mesh.node_number);
  }

  int node(std::size_t element, const Weights& weights) {
    const auto [found, added] = known_.emplace(key_of(element, weights), static_cast<int>(result_.nodes.size()));
    if (!added) return found->second;
    result_.nodes.push_back(place(element, weights));
    result_.node_number.push_back(++number_);
    return found->second;
  }

  /// The node in the middle of some corners that are an edge or a face; −1 where there is none.
  int middle(std::initializer_list<int> corners) const {
    Key key{};
    std::size_t k = 0;
    for (const int n : corners) key[k++] = std::int64_t{n} * 128 + kWhole / static_cast<int>(corners.size());
    std::sort(key.begin(), key.end(), std::greater<>());
    const auto found = known_.find(key);
    return found == known_.end() ? -1 : found->second;
  }

  /// Calls act(node, corners ascending) for every node.
  template <class Act>
  void for_each(Act&& act) const {
    std::vector<int> corners;
    for (const auto& [key, node] : known_) {
      corners.clear();
      for (const std::int64_t k : key)
        if (k > 0) corners.push_back(static_cast<int>(k / 128));
      std::sort(corners.begin(), corners.end());
      act(node, corners);
    }
  }

 private:
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 1469598103934665603u;
      for (const std::int64_t k : key) h = (h ^ static_cast<std::uint64_t>(k)) * 1099511628211u;
      return static_cast<std::size_t>(h);
    }
  };

  Key key_of(std::size_t element, const Weights& weights) const {
    const auto nodes = mesh_.element(element);
    Key key{};
    for (std::size_t c = 0; c < at(corner_count(mesh_.shape)); ++c)
      if (weights[c] > 0) key[c] = std::int64_t{nodes[c]} * 128 + weights[c];
    std::sort(key.begin(), key.end(), std::greater<>());
    return key;
  }

  Vec3d place(std::size_t element, const Weights& weights) const {
    const std::span<const Vec3d> corners = reference_corners(family_of(mesh_.shape));
    Vec3d xi, X;
    for (std::size_t c = 0; c < corners.size(); ++c) xi += (1.0 * weights[c] / kWhole) * corners[c];
    const ShapeValues N = shape_values(mesh_.shape, xi);
    const auto nodes = mesh_.element(element);
    for (std::size_t n = 0; n < nodes.size(); ++n) X += N[n] * mesh_.nodes[at(nodes[n])];
    return X;
  }

  const ElementMesh& mesh_;
  ElementMesh& result_;
  std::unordered_map<Key, int, Hash> known_;
  std::int64_t number_ = 0;
};

/// The shortest diagonal between middles of opposite edges.
int shortest_diagonal(const ElementMesh& mesh, std::size_t element) {
  const auto n = mesh.element(element);
  const auto X = [&](std::size_t c) { return mesh.nodes[at(n[c])]; };
  const std::array<double, 3> length{squared_norm(X(0) + X(1) - X(2) - X(3)), squared_norm(X(0) + X(2) - X(1) - X(3)),
                                     squared_norm(X(0) + X(3) - X(1) - X(2))};
  return static_cast<int>(std::ranges::min_element(length) - length.begin());
}

using Edges = std::vector<std::array<int, 2>>;
using Faces = std::vector<std::array<int, 4>>;

void add_edge(int a, int b, Edges& edges) { edges.push_back({std::min(a, b), std::max(a, b)}); }

std::size_t corners_of(const std::array<int, 4>& face) { return face[3] < 0 ? 3 : 4; }

void add_edges(const std::array<int, 4>& face, Edges& edges) {
  const std::size_t n = corners_of(face);
  for (std::size_t k = 0; k < n; ++k) add_edge(face[k], face[(k + 1) % n], edges);
}

/// The four faces of a face; those that no element has stay whole.
void cut_face(const std::array<int, 4>& face, const Nodes& nodes, Faces& faces) {
  const std::size_t n = corners_of(face);
  std::array<int, 4> m{-1, -1, -1, -1};
  for (std::size_t k = 0; k < n; ++k) m[k] = nodes.middle({face[k], face[(k + 1) % n]});
  const int center = n == 4 ? nodes.middle({face[0], face[1], face[2], face[3]}) : m[0];
  if (center < 0 || std::find(m.begin(), m.begin() + static_cast<std::ptrdiff_t>(n), -1) !=
                        m.begin() + static_cast<std::ptrdiff_t>(n))
    return faces.push_back(face);
  for (std::size_t k = 0; k < n; ++k) {
    const int before = m[(k + n - 1) % n];
    if (n == 4)
      faces.push_back({face[k], m[k], center, before});
    else
      faces.push_back({face[k], m[k], before, -1});
  }
  if (n == 3) faces.push_back({m[0], m[1], m[2], -1});
}

/// What a group has of the finer mesh. @param elements  the nodes of the finer mesh's elements are known
ElementGroup refined_group(const ElementGroup& group, const Nodes& nodes, const ElementMesh& finer) {
  ElementGroup result{group.name, group.number, group.dimension, group.nodes, {}, {}, {}};
  for (const int e : group.elements)
    for (int k = 0; k < 8; ++k) {
      result.elements.push_back(8 * e + k);
      const auto own = finer.element(at(8 * e + k));
      result.nodes.insert(result.nodes.end(), own.begin(), own.end());
    }
  Edges edges = group.edges;
  Faces faces = group.faces;
  for (const auto& face : group.faces) add_edges(face, edges);
  make_unique(edges);
  for (auto& face : faces) std::sort(face.begin(), face.end());
  make_unique(faces);
  nodes.for_each([&](int node, const std::vector<int>& corners) {
    const std::size_t n = corners.size();
    if (n == 2 && std::ranges::binary_search(edges, std::array{corners[0], corners[1]})) result.nodes.push_back(node);
    if (n == 3 && std::ranges::binary_search(faces, std::array{-1, corners[0], corners[1], corners[2]}))
      result.nodes.push_back(node);
    if (n == 4 && std::ranges::binary_search(faces, std::array{corners[0], corners[1], corners[2], corners[3]}))
      result.nodes.push_back(node);
  });
  for (const auto& [a, b] : group.edges) {
    const int m = nodes.middle({a, b});
    if (m < 0) add_edge(a, b, result.edges);
    if (m >= 0) add_edge(a, m, result.edges), add_edge(m, b, result.edges);
  }
  for (const auto& face : group.faces) cut_face(face, nodes, result.faces);
  for (const auto& face : result.faces) add_edges(face, result.edges);
  make_unique(result.nodes);
  make_unique(result.edges);
  return result;
}

}  // namespace

ElementMesh refined(const ElementMesh& mesh) {
  const ElementFamily family = family_of(mesh.shape);
  std::vector<std::vector<Child>> cuts;  // by diagonal
  for (int diagonal = 0; diagonal < 3 && family == ElementFamily::tetrahedra; ++diagonal)
    cuts.push_back(children_of_tetrahedron(diagonal));
  if (family == ElementFamily::hexahedra) cuts.push_back(children_of_hexahedron());

  ElementMesh result = mesh;
  result.element_nodes.clear();
  result.element_number.clear();
  Nodes nodes(mesh, result);
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    const int cut = family == ElementFamily::tetrahedra ? shortest_diagonal(mesh, e) : 0;
    for (const Child& child : cuts[at(cut)]) {
      for (std::size_t c = 0; c < at(corner_count(family)); ++c)
        result.element_nodes.push_back(nodes.node(e, child[c]));
      if (order_of(mesh.shape) == 2)
        for (const auto& [a, b] : edges_of(family))
          result.element_nodes.push_back(nodes.node(e, between(child[at(a)], child[at(b)])));
      result.element_number.push_back(mesh.element_number.empty() ? 0 : mesh.element_number[e]);
    }
  }
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) result.groups[g] = refined_group(mesh.groups[g], nodes, result);
  return result;
}

}  // namespace fascia
