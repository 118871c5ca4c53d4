#include "core/geometry/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fascia {
namespace {

Vec3d nearest_on_segment(const Vec3d& x, const Vec3d& a, const Vec3d& b) {
  const Vec3d edge = b - a;
  const double length2 = squared_norm(edge);
  if (!(length2 > 0)) return a;
  return a + std::clamp(dot(x - a, edge) / length2, 0.0, 1.0) * edge;
}

}  // namespace

Vec3d nearest_on_triangle(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  // Inside the prism over the triangle the foot of the normal is nearest, elsewhere the nearest of the edges.
  const Vec3d normal = cross(b - a, c - a);
  const double n2 = squared_norm(normal);
  const bool over = n2 > 0 && dot(cross(b - a, x - a), normal) >= 0 && dot(cross(c - b, x - b), normal) >= 0 &&
                    dot(cross(a - c, x - c), normal) >= 0;
  if (over) return x - (dot(x - a, normal) / n2) * normal;
  Vec3d best = nearest_on_segment(x, a, b);
  for (const Vec3d& y : {nearest_on_segment(x, b, c), nearest_on_segment(x, c, a)})
    if (squared_norm(y - x) < squared_norm(best - x)) best = y;
  return best;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  constexpr int leaf_size = 4;
  triangles_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const auto point = [&](std::size_t n) { return mesh.points[static_cast<std::size_t>(t[n])]; };
    triangles_.push_back({{point(0), point(1), point(2)}, static_cast<int>(triangles_.size())});
  }
  if (triangles_.empty()) return;
  nodes_.push_back({{}, 0, static_cast<int>(triangles_.size()), -1});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    bound(nodes_[n]);
    const Node node = nodes_[n];
    if (node.end - node.begin <= leaf_size) continue;
    const int axis = longest_axis(node.bounds);
    const int middle = (node.begin + node.end) / 2;
    std::nth_element(triangles_.begin() + node.begin, triangles_.begin() + middle, triangles_.begin() + node.end,
                     [axis](const Leaf& first, const Leaf& second) {
                       const auto &a = first.corners, &b = second.corners;
                       return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
                     });
    nodes_[n].children = static_cast<int>(nodes_.size());
    nodes_.push_back({{}, node.begin, middle, -1});
    nodes_.push_back({{}, middle, node.end, -1});
  }
}

void TriangleTree::bound(Node& node) const {
  for (int t = node.begin; t < node.end; ++t)
    for (const Vec3d& x : triangles_[static_cast<std::size_t>(t)].corners) node.bounds.include(x);
}

double TriangleTree::squared_distance(const Node& node, const Vec3d& x) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double d = std::max({node.bounds.low[c] - x[c], 0.0, x[c] - node.bounds.high[c]});
    sum += d * d;
  }
  return sum;
}

double TriangleTree::distance(const Vec3d& x, Vec3d* nearest, int* triangle) const {
  // Of places that are equally near, to what rounding may make of it, the one of the first triangle.
  constexpr double tie = 1e-9;
  double best = std::numeric_limits<double>::infinity();
  int best_number = 0;
  std::vector<int> open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const Node& node = nodes_[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (squared_distance(node, x) > best * (1 + tie)) continue;
    if (node.children >= 0) {
      // The nearer child last, so that it is looked at first.
      const int first = node.children, second = first + 1;
      const bool first_nearer = squared_distance(nodes_[static_cast<std::size_t>(first)], x) <
                                squared_distance(nodes_[static_cast<std::size_t>(second)], x);
      open.push_back(first_nearer ? second : first);
      open.push_back(first_nearer ? first : second);
      continue;
    }
    for (int t = node.begin; t < node.end; ++t) {
      const auto& [corners, number] = triangles_[static_cast<std::size_t>(t)];
      const Vec3d y = nearest_on_triangle(x, corners[0], corners[1], corners[2]);
      const double squared = squared_norm(y - x);
      const bool nearer = squared < best * (1 - tie), first = number < best_number;
      if (squared > best * (1 + tie) || !(nearer || first)) continue;
      best = std::min(best, squared);
      best_number = number;
      if (nearest) *nearest = y;
      if (triangle) *triangle = number;
    }
  }
  return std::sqrt(best);
}

}  // namespace fascia
