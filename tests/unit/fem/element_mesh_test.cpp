#include "fem/element_mesh.hpp"

#include "tests/unit/fem/fem_samples.hpp"

#include <algorithm>

namespace fascia::element_mesh_test {
namespace {

using namespace samples;

std::vector<ElementMesh> curved_and_straight() {
  std::vector<ElementMesh> meshes;
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2})
    meshes.push_back(generate_ellipsoid({{100, 0, 0}}, {{1, 0.8, 1.3}}, {8, 2}, kind));
  return meshes;
}

TEST(ElementMesh, linear_fields_have_their_gradient_everywhere) {
  std::mt19937 random(4);
  const Vec3d slope{{2, -3, 0.5}};
  for (const ElementMesh& mesh : curved_and_straight())
    for (std::size_t e = 0; e < mesh.size(); ++e) {
      const ElementPoint p = shape_at(mesh, e, random_place(mesh.shape, random));
      double value = 0;
      Vec3d gradient;
      const auto nodes = mesh.element(e);
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        value += p.N[n] * dot(slope, mesh.nodes[at(nodes[n])]);
        gradient += dot(slope, mesh.nodes[at(nodes[n])]) * p.dN_dX[n];
      }
      EXPECT_NEAR(value, dot(slope, p.X), 1e-11);
      EXPECT_NEAR(norm(gradient - slope), 0, 1e-10);
    }
}

TEST(ElementMesh, straight_quadratic_elements_reproduce_quadratic_fields) {
  std::mt19937 random(5);
  const auto field = [](const Vec3d& x) { return x[0] * x[0] - 2 * x[0] * x[1] + x[2] * x[1] + 3 * x[2] * x[2]; };
  const auto slope = [](const Vec3d& x) { return Vec3d{{2 * x[0] - 2 * x[1], -2 * x[0] + x[2], x[1] + 6 * x[2]}}; };
  for (const ElementKind& kind : {hexahedra_2, tetrahedra_2, by_five_2}) {
    const ElementMesh mesh = generate_box({{0, 0, 0}}, {{2, 1, 1}}, {3, 2, 2}, kind);
    for (std::size_t e = 0; e < mesh.size(); ++e) {
      const ElementPoint p = shape_at(mesh, e, random_place(mesh.shape, random));
      Vec3d gradient;
      for (std::size_t n = 0; n < mesh.element(e).size(); ++n)
        gradient += field(mesh.nodes[at(mesh.element(e)[n])]) * p.dN_dX[n];
      EXPECT_NEAR(norm(gradient - slope(p.X)), 0, 1e-12);
    }
  }
}

TEST(ElementMesh, gradients_are_zero_where_an_element_has_no_volume) {
  ElementMesh mesh = generate_box({{0, 0, 0}}, {{1, 1, 1}}, {1, 1, 1}, tetrahedra);
  for (Vec3d& X : mesh.nodes) X[2] = 0;
  const ElementPoint p = shape_at(mesh, 0, {{0.2, 0.2, 0.2}});
  EXPECT_EQ(p.det_J, 0);
  for (const Vec3d& gradient : p.dN_dX) EXPECT_EQ(gradient, Vec3d{});
}

TEST(ElementMesh, quadratic_shares_one_node_an_edge) {
  const ElementMesh mesh = quadratic(generate_box({{0, 0, 0}}, {{2, 2, 2}}, {2, 2, 2}, hexahedra));
  EXPECT_EQ(mesh.shape, ElementShape::hex20);
  EXPECT_EQ(mesh.nodes.size(), 27u + 3 * 2 * 9);
  EXPECT_EQ(mesh.node_number.back(), 81);
  for (std::size_t e = 0; e < mesh.size(); ++e) {
    std::size_t k = 8;
    for (const auto& [a, b] : edges_of(ElementFamily::hexahedra)) {
      const auto X = [&](std::size_t n) { return mesh.nodes[at(mesh.element(e)[n])]; };
      EXPECT_EQ(X(k++), 0.5 * (X(at(a)) + X(at(b))));
    }
  }
  EXPECT_EQ(quadratic(mesh).nodes.size(), mesh.nodes.size());
}

TEST(ElementMesh, groups_receive_the_middle_nodes_of_their_own_cells_only) {
  // One tetrahedron: its nodes 0, 1, 2 as a line 01, a line 12 and a volume.
  ElementMesh mesh;
  mesh.shape = ElementShape::tet4;
  mesh.nodes = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  mesh.element_nodes = {0, 1, 2, 3};
  mesh.node_number = {1, 2, 3, 4};
  mesh.element_number = {1};
  mesh.groups = {{"lines", 1, 1, {0, 1, 2}, {}, {{0, 1}, {1, 2}}},
                 {"points", 2, 0, {0, 1, 2}, {}, {}},
                 {"volume", 3, 3, {0, 1, 2, 3}, {0}, {}}};
  const ElementMesh made = quadratic(mesh);
  EXPECT_EQ(made.groups[0].nodes, (std::vector<int>{0, 1, 2, 4, 5}));
  EXPECT_EQ(made.groups[1].nodes, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(made.groups[2].nodes.size(), 10u);
}

}  // namespace
}  // namespace fascia::element_mesh_test
