#include "coupling/gap_surface.hpp"

#include "core/base/disjoint_sets.hpp"
#include "core/base/index.hpp"

#include <algorithm>
#include <map>

namespace fascia::gap_parts {

namespace {

using Triangle = std::array<int, 3>;

/// Points nearer than this part of the size are one, triangles lower than it are flat.
constexpr double kSame = 1e-9;

/// Numbers of the points over the patch: top + i where the top has a point of its own.
std::vector<int> numbers_of_feet(const GapPatch& patch, const CheckedSides& sides) {
  const int top = static_cast<int>(patch.points.size());
  DisjointSets same(2 * top);
  for (const auto& edge : rim(patch))
    for (const int i : edge)
      if (patch.gap(i) < sides.touching) same.join(i, top + i);
  for (const auto& t : patch.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (norm(patch.feet[at(b)] - patch.feet[at(a)]) < kSame * sides.size) same.join(top + a, top + b);
    }
  std::vector<int> number(patch.points.size());
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = same.root(top + static_cast<int>(i));
  return number;
}

/// Triangles that lie on each other face to face enclose nothing.
void cancel(std::vector<Triangle>& triangles) {
  const auto from_lowest = [](Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  std::map<Triangle, int> count;
  for (const Triangle& t : triangles) ++count[from_lowest(t)];
  std::map<Triangle, int> left;
  for (const auto& [t, n] : count) {
    const auto other = count.find(from_lowest({t[0], t[2], t[1]}));
    left[t] = other == count.end() ? n : n - std::min(n, other->second);
  }
  std::erase_if(triangles, [&](const Triangle& t) { return left[from_lowest(t)]-- <= 0; });
}

/// Flips the longest edges of flat triangles until none is left that a flip can remove. The enclosed volume stays.
class FlatTriangles {
 public:
  FlatTriangles(TriangleMesh& mesh, double height) : mesh_(mesh), height_(height) {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) enter(static_cast<int>(t));
  }

  void remove() {
    std::vector<int> flat;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      if (is_flat(mesh_.triangles[t])) flat.push_back(static_cast<int>(t));
    for (bool changed = true; changed;) {
      changed = false;
      for (const int t : flat) changed = (is_flat(mesh_.triangles[at(t)]) && flip(t)) || changed;
      std::erase_if(flat, [&](int t) { return !is_flat(mesh_.triangles[at(t)]); });
    }
  }

 private:
  void enter(int t) {
    const Triangle& n = mesh_.triangles[at(t)];
    for (std::size_t k = 0; k < 3; ++k) across_[{n[k], n[(k + 1) % 3]}] = t;
  }

  /// The corner opposite the longest edge.
  std::size_t peak(const Triangle& t) const {
    std::size_t best = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = norm(mesh_.points[at(t[(k + 2) % 3])] - mesh_.points[at(t[(k + 1) % 3])]);
      if (length <= longest) continue;
      longest = length;
      best = k;
    }
    return best;
  }

  double longest_edge(const Triangle& t) const {
    const std::size_t k = peak(t);
    return norm(mesh_.points[at(t[(k + 2) % 3])] - mesh_.points[at(t[(k + 1) % 3])]);
  }

  bool is_flat(const Triangle& t) const {
    const Vec3d& a = mesh_.points[at(t[0])];
    const double area = norm(cross(mesh_.points[at(t[1])] - a, mesh_.points[at(t[2])] - a));
    return area <= height_ * longest_edge(t);
  }

  /// A flip leaves fewer flat triangles, or two with shorter edges of two beside each other: it comes to an end.
  bool improves(const Triangle& m, const Triangle& first, const Triangle& second, double longest) const {
    if (!is_flat(m)) return !is_flat(first) && !is_flat(second);
    constexpr double shorter = 1 - 1e-6;
    return longest_edge(first) < shorter * longest && longest_edge(second) < shorter * longest;
  }

  bool flip(int t) {
    const Triangle n = mesh_.triangles[at(t)];
    const std::size_t k = peak(n);
    const int q = n[k], r = n[(k + 1) % 3], p = n[(k + 2) % 3];
    const auto found = across_.find({p, r});
    if (found == across_.end() || found->second == t) return false;
    const int other = found->second;
    const Triangle& m = mesh_.triangles[at(other)];
    int s = -1;
    for (const int node : m)
      if (node != p && node != r) s = node;
    const Triangle first{p, q, s}, second{q, r, s};
    if (s == q || across_.contains({q, s}) || across_.contains({s, q}) ||
        norm(mesh_.points[at(s)] - mesh_.points[at(q)]) <= height_ || !improves(m, first, second, longest_edge(n)))
      return false;
    across_.erase({p, r});
    across_.erase({r, p});
    mesh_.triangles[at(t)] = first;
    mesh_.triangles[at(other)] = second;
    enter(t);
    enter(other);
    return true;
  }

  TriangleMesh& mesh_;
  double height_;
  std::map<std::pair<int, int>, int> across_;  ///< triangle of each directed edge
};

void drop_unused_points(TriangleMesh& mesh) {
  std::vector<int> number(mesh.points.size(), -1);
  std::vector<Vec3d> points;
  for (auto& t : mesh.triangles)
    for (int& node : t) {
      int& n = number[at(node)];
      if (n < 0) {
        n = static_cast<int>(points.size());
        points.push_back(mesh.points[at(node)]);
      }
      node = n;
    }
  mesh.points = std::move(points);
}

}  // namespace

TriangleMesh surface_over(const GapPatch& patch, const CheckedSides& sides) {
  const std::vector<int> foot = numbers_of_feet(patch, sides);
  TriangleMesh mesh;
  mesh.points = patch.points;
  mesh.points.insert(mesh.points.end(), patch.feet.begin(), patch.feet.end());
  const auto add = [&](const Triangle& t) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  };
  for (const auto& [a, b, c] : patch.triangles) {
    add({a, b, c});
    add({foot[at(a)], foot[at(c)], foot[at(b)]});
  }
  for (const auto& [a, b] : rim(patch)) {
    add({b, a, foot[at(a)]});
    add({b, foot[at(a)], foot[at(b)]});
  }
  cancel(mesh.triangles);
  FlatTriangles(mesh, kSame * sides.size).remove();
  drop_unused_points(mesh);
  return mesh;
}

}  // namespace fascia::gap_parts
