#include "fem/locator.hpp"

#include "tests/unit/fem/fem_samples.hpp"

#include <cmath>
#include <limits>

namespace fascia::locator_test {
namespace {

using namespace samples;

const std::array<Vec3d, 8> skewed{{{{0, 0, 0}},
                                   {{2, 0.3, 0}},
                                   {{2.2, 1, 0.4}},
                                   {{-0.2, 1.2, 0}},
                                   {{0, 0.1, 1}},
                                   {{1.8, 0, 1.3}},
                                   {{2, 1.4, 1}},
                                   {{0.3, 1, 0.8}}}};

std::vector<ElementMesh> many() {
  std::vector<ElementMesh> meshes;
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2}) {
    meshes.push_back(generate_block(skewed, {4, 3, 2}, kind));
    meshes.push_back(generate_ellipsoid({{0, 0, 0}}, {{1, 0.6, 1.4}}, {8, 2}, kind));
    meshes.push_back(generate_cylinder({{0, 0, 0}}, {{0, 0, 0.01}}, 1, {1, 12}, kind));
  }
  return meshes;
}

TEST(Locator, finds_places_of_elements) {
  std::mt19937 random(6);
  for (const ElementMesh& mesh : many()) {
    const ElementLocator locator(mesh);
    for (std::size_t e = 0; e < mesh.size(); ++e) {
      const Vec3d xi = random_place(mesh.shape, random);
      const Located found = locator.locate(shape_at(mesh, e, xi).X);
      EXPECT_EQ(found.element, static_cast<int>(e));
      EXPECT_EQ(found.distance, 0);
      EXPECT_NEAR(norm(found.xi - xi), 0, 1e-8);
    }
  }
}

TEST(Locator, nodes_belong_to_their_first_element) {
  for (const ElementMesh& mesh : many()) {
    const ElementLocator locator(mesh);
    std::vector<int> first(mesh.nodes.size(), -1);
    for (std::size_t e = mesh.size(); e-- > 0;)
      for (const int n : mesh.element(e)) first[at(n)] = static_cast<int>(e);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Located found = locator.locate(mesh.nodes[n]);
      EXPECT_EQ(found.distance, 0);
      EXPECT_LE(found.element, first[n]);
      EXPECT_NEAR(norm(shape_at(mesh, at(found.element), found.xi).X - mesh.nodes[n]), 0, 1e-9);
    }
  }
}

TEST(Locator, agrees_with_brute_force) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2.5, 3);
  for (const ElementMesh& mesh : many()) {
    const ElementLocator locator(mesh);
    double worst = 0;
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3d X{{place(random), place(random), place(random)}};
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t e = 0; e < mesh.size(); ++e) least = std::min(least, nearest_in_element(mesh, e, X).distance);
      const Located found = locator.locate(X);
      worst = std::max(worst, found.distance - least);
      const Vec3d at_place = shape_at(mesh, at(found.element), found.xi).X;
      EXPECT_NEAR(norm(at_place - X), found.distance, 1e-9);
      if (mesh.shape == ElementShape::tet4) {
        EXPECT_NEAR(found.distance, least, 1e-12);
      }
    }
    EXPECT_LT(worst, 0.02);  // curved faces: the triangles' nearest place may lead to a neighbour
  }
}

TEST(Locator, nearest_place_of_one_element_is_a_minimum) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-2, 3);
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2}) {
    const ElementMesh mesh = generate_block(skewed, {1, 1, 1}, kind);
    for (int trial = 0; trial < 50; ++trial) {
      const Vec3d X{{place(random), place(random), place(random)}};
      const Located found = nearest_in_element(mesh, 0, X);
      for (int other = 0; other < 200; ++other) {
        const Vec3d xi = random_place(mesh.shape, random);
        EXPECT_GE(norm(shape_at(mesh, 0, xi).X - X), found.distance - 1e-12);
        const Vec3d near = found.xi + 1e-3 * (xi - found.xi);
        EXPECT_GE(norm(shape_at(mesh, 0, near).X - X), found.distance - 1e-12);
      }
    }
  }
}

TEST(Locator, holes_between_elements_are_outside) {
  const ElementMesh box = generate_box({{0, 0, 0}}, {{3, 1, 1}}, {3, 1, 1}, hexahedra);
  ElementMesh mesh = box;
  mesh.element_nodes.erase(mesh.element_nodes.begin() + 8, mesh.element_nodes.begin() + 16);
  mesh.element_number.resize(2);
  const Located found = ElementLocator(mesh).locate({{1.9, 0.5, 0.5}});
  EXPECT_EQ(found.element, 1);
  EXPECT_NEAR(found.distance, 0.1, 1e-12);
  EXPECT_NEAR(norm(found.xi - Vec3d{{-1, 0, 0}}), 0, 1e-12);
}

TEST(Locator, no_elements) { EXPECT_EQ(ElementLocator(ElementMesh{}).locate({{1, 2, 3}}).element, -1); }

}  // namespace
}  // namespace fascia::locator_test
