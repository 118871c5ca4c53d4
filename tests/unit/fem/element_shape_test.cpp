#include "fem/element_shape.hpp"

#include "fem/quadrature.hpp"
#include "tests/unit/fem/fem_samples.hpp"

#include <cmath>
#include <numeric>

namespace fascia::element_shape_test {
namespace {

using namespace samples;

/// Reference coordinates of all nodes: corners, then the middles of edges.
std::vector<Vec3d> reference_nodes(ElementShape shape) {
  const ElementFamily family = family_of(shape);
  const auto corners = reference_corners(family);
  std::vector<Vec3d> nodes(corners.begin(), corners.end());
  for (const auto& [a, b] : edges_of(family))
    if (order_of(shape) == 2) nodes.push_back(0.5 * (corners[at(a)] + corners[at(b)]));
  return nodes;
}

TEST(ElementShape, values_are_one_at_the_own_node_and_zero_at_others) {
  for (const ElementShape shape : all_shapes) {
    const std::vector<Vec3d> nodes = reference_nodes(shape);
    ASSERT_EQ(nodes.size(), at(node_count(shape)));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const ShapeValues N = shape_values(shape, nodes[i]);
      for (std::size_t j = 0; j < N.size(); ++j) EXPECT_NEAR(N[j], i == j ? 1 : 0, 1e-15);
    }
  }
}

TEST(ElementShape, partition_of_unity_and_linear_completeness) {
  std::mt19937 random(1);
  for (const ElementShape shape : all_shapes) {
    const std::vector<Vec3d> nodes = reference_nodes(shape);
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3d xi = random_place(shape, random);
      const ShapeValues N = shape_values(shape, xi);
      const ShapeGradients dN = shape_gradients(shape, xi);
      double sum = 0;
      Vec3d place, gradient_sum;
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        sum += N[n];
        place += N[n] * nodes[n];
        gradient_sum += dN[n];
      }
      EXPECT_NEAR(sum, 1, 1e-14);
      EXPECT_NEAR(norm(place - xi), 0, 1e-14);
      EXPECT_NEAR(norm(gradient_sum), 0, 1e-14);
    }
  }
}

TEST(ElementShape, gradients_agree_with_differences) {
  std::mt19937 random(2);
  constexpr double h = 1e-6;
  for (const ElementShape shape : all_shapes) {
    const Vec3d xi = random_place(shape, random);
    const ShapeGradients dN = shape_gradients(shape, xi);
    for (int c = 0; c < 3; ++c) {
      Vec3d step;
      step[c] = h;
      const ShapeValues above = shape_values(shape, xi + step), below = shape_values(shape, xi - step);
      for (std::size_t n = 0; n < dN.size(); ++n) EXPECT_NEAR((above[n] - below[n]) / (2 * h), dN[n][c], 1e-9);
    }
  }
}

TEST(ElementShape, quadratic_shapes_reproduce_quadratic_fields) {
  std::mt19937 random(3);
  const auto field = [](const Vec3d& x) {
    return 1 + x[0] - 2 * x[1] + x[2] * x[2] - 3 * x[0] * x[0] + x[0] * x[1] + 4 * x[1] * x[2] - x[1] * x[1];
  };
  for (const ElementShape shape : {ElementShape::tet10, ElementShape::hex20}) {
    const std::vector<Vec3d> nodes = reference_nodes(shape);
    const Vec3d xi = random_place(shape, random);
    const ShapeValues N = shape_values(shape, xi);
    double value = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) value += N[n] * field(nodes[n]);
    EXPECT_NEAR(value, field(xi), 1e-13);
  }
}

TEST(ElementShape, faces_face_outward_and_neighbours_have_positive_volume) {
  for (const ElementFamily family : {ElementFamily::tetrahedra, ElementFamily::hexahedra}) {
    const auto X = reference_corners(family);
    for (const auto& f : faces_of(family)) {
      const Vec3d normal = cross(X[at(f[1])] - X[at(f[0])], X[at(f[2])] - X[at(f[0])]);
      EXPECT_GT(dot(normal, X[at(f[0])] - reference_center(family)), 0);
    }
    const auto neighbours = corner_neighbours(family);
    for (std::size_t n = 0; n < neighbours.size(); ++n) {
      const auto edge = [&](std::size_t k) { return X[at(neighbours[n][k])] - X[n]; };
      EXPECT_GT(dot(edge(0), cross(edge(1), edge(2))), 0);
    }
  }
}

/// ∫ ξ^a η^b ζ^c over the reference element.
double exact_integral(ElementFamily family, int a, int b, int c) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  if (family == ElementFamily::tetrahedra) return factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
  double product = 1;
  for (const int n : {a, b, c}) product *= n % 2 == 1 ? 0 : 2.0 / (n + 1);
  return product;
}

TEST(Quadrature, rules_are_exact_to_their_degree) {
  const std::array<int, 4> degree{1, 2, 3, 5};  // tetrahedra in all, hexahedra along each axis
  const std::array<std::size_t, 4> points{1, 4, 8, 27};
  for (std::size_t s = 0; s < 4; ++s) {
    const ElementFamily family = family_of(all_shapes[s]);
    const std::vector<QuadraturePoint> rule = quadrature(all_shapes[s]);
    EXPECT_EQ(rule.size(), points[s]);
    for (int a = 0; a <= degree[s]; ++a)
      for (int b = 0; b <= degree[s]; ++b)
        for (int c = 0; c <= degree[s]; ++c) {
          if (family == ElementFamily::tetrahedra && a + b + c > degree[s]) continue;
          double sum = 0;
          for (const QuadraturePoint& q : rule)
            sum += q.weight * std::pow(q.xi[0], a) * std::pow(q.xi[1], b) * std::pow(q.xi[2], c);
          EXPECT_NEAR(sum, exact_integral(family, a, b, c), 1e-14);
        }
  }
}

}  // namespace
}  // namespace fascia::element_shape_test
