#include "fem/refine.hpp"

#include "core/math/mat3.hpp"
#include "fem/element_mesh_parts.hpp"
#include "fem/from_mesh.hpp"
#include "tests/unit/fem/fem_samples.hpp"

#include <algorithm>
#include <cmath>
#include <set>

// Elements that are cut into eight: shape, neighbours, groups.
namespace fascia::refine_test {
namespace {

using namespace samples;

struct Named {
  std::string name;
  ElementMesh mesh;
};

/// Straight and curved, structured and round.
std::vector<Named> meshes() {
  std::vector<Named> all;
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2}) {
    const std::string name = std::to_string(node_count(element_shape(kind.family, kind.order))) + " nodes, ";
    all.push_back({name + "box", generate_box({{-1, 2, 0}}, {{2, 3, 1}}, {3, 2, 2}, kind)});
    all.push_back({name + "ball", generate_ellipsoid({{1, 2, 3}}, {{1, 0.6, 1.5}}, {8, 2}, kind)});
  }
  return all;
}

/// ∫ det dX/dξ, exact for curved tetrahedra too, whose determinant is cubic: the program's own rule for them is not.
double volume(const ElementMesh& mesh, std::size_t e) {
  if (family_of(mesh.shape) == ElementFamily::hexahedra) return element_volume(mesh, e);
  double sum = -0.8 * shape_at(mesh, e, {{0.25, 0.25, 0.25}}).det_J;
  for (int c = 0; c < 4; ++c) {
    Vec3d xi{{1.0 / 6, 1.0 / 6, 1.0 / 6}};
    if (c > 0) xi[c - 1] = 0.5;
    sum += 0.45 * shape_at(mesh, e, xi).det_J;
  }
  return sum / 6;
}

double volume(const ElementMesh& mesh) {
  double sum = 0;
  for (std::size_t e = 0; e < mesh.size(); ++e) sum += volume(mesh, e);
  return sum;
}

std::size_t faces_of_boundary(const ElementMesh& mesh) {
  std::size_t count = 0;
  element_parts::for_each_face(element_parts::sorted_faces(mesh),
                               [&](const auto& faces) { count += faces.size() == 1 ? 1 : 0; });
  return count;
}

TEST(Refine, children_fill_their_element_and_nothing_else) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    const ElementMesh fine = refined(mesh);
    ASSERT_EQ(fine.size(), 8 * mesh.size());
    for (std::size_t e = 0; e < mesh.size(); ++e) {
      double children = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        const double part = volume(fine, 8 * e + k);
        EXPECT_GT(part, 0);
        children += part;
      }
      EXPECT_NEAR(children / volume(mesh, e), 1, 1e-13) << "element " << e;
    }
    for (std::size_t e = 0; e < fine.size(); ++e)
      for (const Vec3d& xi : reference_corners(family_of(fine.shape))) EXPECT_GT(shape_at(fine, e, xi).det_J, 0);
  }
}

/// A quarter of a face of a curved element lies on that face.
TEST(Refine, middle_nodes_follow_curved_elements) {
  for (const ElementKind& kind : {hexahedra_2, tetrahedra_2}) {
    const ElementMesh mesh = generate_ellipsoid({{0, 0, 0}}, {{1, 1, 1}}, {8, 1}, kind), fine = refined(mesh);
    for (std::size_t e = 0; e < fine.size(); ++e) {
      const Vec3d center = element_middle(fine, e);
      double nearest = 1;  // of the parent's places to the child's middle, found by Newton's method
      Vec3d xi = reference_center(family_of(mesh.shape));
      for (int i = 0; i < 20; ++i) {
        const ElementPoint p = shape_at(mesh, e / 8, xi);
        Mat3d J;
        const ShapeGradients dN = shape_gradients(mesh.shape, xi);
        for (std::size_t n = 0; n < mesh.element(e / 8).size(); ++n)
          J += outer(mesh.nodes[at(mesh.element(e / 8)[n])], dN[n]);
        xi += inverse(J) * (center - p.X);
        nearest = norm(center - p.X);
      }
      EXPECT_LT(nearest, 1e-12);
      const bool inside = kind.family == ElementFamily::tetrahedra
                              ? std::min({xi[0], xi[1], xi[2]}) > 0 && xi[0] + xi[1] + xi[2] < 1
                              : std::max({std::abs(xi[0]), std::abs(xi[1]), std::abs(xi[2])}) < 1;
      EXPECT_TRUE(inside);
    }
  }
}

TEST(Refine, neighbours_share_their_faces) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    const ElementMesh fine = refined(mesh);
    EXPECT_EQ(faces_of_boundary(fine), 4 * faces_of_boundary(mesh));
    const std::set<std::tuple<double, double, double>> places = [&] {
      std::set<std::tuple<double, double, double>> set;
      for (const Vec3d& X : fine.nodes)
        set.insert({std::round(X[0] * 1e9), std::round(X[1] * 1e9), std::round(X[2] * 1e9)});
      return set;
    }();
    EXPECT_EQ(places.size(), fine.nodes.size()) << "a node twice";
    EXPECT_TRUE(std::equal(mesh.nodes.begin(), mesh.nodes.end(), fine.nodes.begin())) << "old nodes keep their indices";
  }
}

TEST(Refine, a_box_becomes_the_box_of_twice_the_cells) {
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra_2}) {
    const ElementMesh coarse = generate_box({{0, 0, 0}}, {{4, 2, 1}}, {2, 2, 1}, kind), fine = refined(coarse);
    EXPECT_EQ(fine.nodes.size(), generate_box({{0, 0, 0}}, {{4, 2, 1}}, {4, 4, 2}, kind).nodes.size());
    EXPECT_NEAR(volume(fine), 8, 1e-12);
  }
}

/// A file of two tetrahedra or a row of hexahedra with a group of each dimension.
Mesh grouped(const ElementMesh& elements, CellType side, const std::vector<int>& face) {
  Mesh mesh = file_of(elements);
  mesh.groups = {{"matter", 1, 3}, {"wall", 2, 2}, {"rim", 3, 1}};
  mesh.blocks[0].group.assign(mesh.blocks[0].size(), -1);
  mesh.blocks[0].group[0] = 0;
  mesh.blocks.push_back({side, face, {1}, {100}});
  mesh.blocks.push_back({CellType::line, {face[0], face[1]}, {2}, {101}});
  return mesh;
}

TEST(Refine, groups_go_with_their_cells) {
  for (const int order : {1, 2}) {
    SCOPED_TRACE(order);
    const ElementMesh box = generate_box({{0, 0, 0}}, {{2, 1, 1}}, {2, 1, 1}, hexahedra);
    const auto e = box.element(0);
    ElementMesh mesh =
        element_mesh(grouped(box, CellType::quadrilateral, {e[0], e[3], e[7], e[4]}), ElementFamily::hexahedra, order);
    for (int level = 1; level <= 2; ++level) {
      mesh = refined(mesh);
      const int n = 1 << level, per_edge = order * n + 1;
      ASSERT_EQ(mesh.groups.size(), 3u);
      EXPECT_EQ(mesh.groups[0].elements.size(), static_cast<std::size_t>(n * n * n));
      for (const int node : mesh.groups[0].nodes) EXPECT_LE(mesh.nodes[at(node)][0], 1 + 1e-12);
      // Serendipity elements have no node in the middle of a face.
      const int wall = per_edge * per_edge - (order == 2 ? n * n : 0);
      EXPECT_EQ(mesh.groups[1].nodes.size(), static_cast<std::size_t>(wall));
      for (const int node : mesh.groups[1].nodes) EXPECT_EQ(mesh.nodes[at(node)][0], 0);
      EXPECT_EQ(mesh.groups[2].nodes.size(), static_cast<std::size_t>(per_edge));
      for (const int node : mesh.groups[2].nodes) EXPECT_EQ(mesh.nodes[at(node)][2], 0);
    }
  }
}

TEST(Refine, groups_of_triangles_take_no_neighbouring_face) {
  // Three faces of a tetrahedron are a group: the fourth has all of its edges in it and is none of them.
  const std::vector<Vec3d> corners{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1, 1, 1}}};
  Mesh file = mesh_of(CellType::tetrahedron, corners, {0, 1, 2, 3, 1, 4, 2, 3});
  file.groups = {{"wall", 1, 2}};
  file.blocks.push_back({CellType::triangle, {0, 2, 1, 0, 1, 3, 0, 3, 2}, {0, 0, 0}, {10, 11, 12}});
  ElementMesh mesh = element_mesh(file, ElementFamily::tetrahedra, 1);
  for (int level = 0; level < 3; ++level) mesh = refined(mesh);
  for (const int node : mesh.groups[0].nodes) {
    const Vec3d& X = mesh.nodes[at(node)];
    EXPECT_NEAR(std::min({X[0], X[1], X[2]}), 0, 1e-15);
  }
  EXPECT_EQ(mesh.groups[0].nodes.size(), 3u * 45 - 3 * 9 + 1);  // three faces of 45 nodes, three edges of 9, a corner
}

TEST(Refine, numbers_are_the_files_own_for_messages) {
  const ElementMesh mesh = refined(generate_box({{0, 0, 0}}, {{2, 1, 1}}, {2, 1, 1}, hexahedra));
  EXPECT_EQ(mesh.element_number[7], 1);
  EXPECT_EQ(mesh.element_number[8], 2);
  EXPECT_EQ(mesh.node_number.size(), mesh.nodes.size());
  EXPECT_EQ(std::set(mesh.node_number.begin(), mesh.node_number.end()).size(), mesh.nodes.size());
}

}  // namespace
}  // namespace fascia::refine_test
