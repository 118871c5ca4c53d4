#pragma once

#include "core/geometry/bounds.hpp"
#include "core/geometry/mesh.hpp"

namespace fascia {

/// Nearest point of the triangle (a, b, c) to x.
Vec3d nearest_on_triangle(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Bounding boxes of triangles in a binary tree, for nearest-point queries.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Distance to the nearest triangle [m]; infinite where there is none. `nearest` receives the point, `triangle` its
  /// number.
  double distance(const Vec3d& x, Vec3d* nearest = nullptr, int* triangle = nullptr) const;

 private:
  struct Leaf {
    std::array<Vec3d, 3> corners;
    int number = 0;
  };

  /// A range of triangles; its children, where it has any, follow one another.
  struct Node {
    Bounds bounds;
    int begin = 0, end = 0;
    int children = -1;
  };

  void bound(Node& node) const;
  static double squared_distance(const Node& node, const Vec3d& x);

  std::vector<Leaf> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace fascia
