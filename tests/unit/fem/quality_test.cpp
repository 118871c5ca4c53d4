#include "fem/quality.hpp"

#include "tests/unit/fem/fem_samples.hpp"

#include <cmath>

namespace fascia::quality_test {
namespace {

using namespace samples;

TEST(Quality, regular_tetrahedron) {
  ElementMesh mesh;
  mesh.shape = ElementShape::tet4;
  mesh.nodes = {{{1, 1, 1}}, {{-1, 1, -1}}, {{1, -1, -1}}, {{-1, -1, 1}}};
  mesh.element_nodes = {0, 1, 2, 3};
  mesh.element_number = {7};
  const MeshQuality q = mesh_quality(mesh);
  const double angle = std::acos(1.0 / 3) * 180 / std::acos(-1.0);
  EXPECT_NEAR(q.least_dihedral.value, angle, 1e-9);
  EXPECT_NEAR(q.greatest_dihedral.value, angle, 1e-9);
  EXPECT_NEAR(q.least_jacobian.value, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(q.shortest_height.value, 4 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(q.least_ratio.value, 1, 1e-12);  // a regular one
  EXPECT_NEAR(q.volume, 8.0 / 3, 1e-12);
  EXPECT_NEAR(q.least_volume.value, 1, 1e-12);
  EXPECT_EQ(q.least_volume.number, 7);
  EXPECT_TRUE(q.messages.empty());
}

TEST(Quality, bricks) {
  const MeshQuality q = mesh_quality(generate_box({{0, 0, 0}}, {{1, 2, 0.1}}, {2, 2, 1}, hexahedra_2));
  EXPECT_NEAR(q.least_dihedral.value, 90, 1e-9);
  EXPECT_NEAR(q.greatest_dihedral.value, 90, 1e-9);
  EXPECT_NEAR(q.least_jacobian.value, 1, 1e-12);
  EXPECT_NEAR(q.shortest_height.value, 0.1, 1e-12);
  EXPECT_EQ(
      q.sentence,
      "4 quadratic hexahedra on 51 nodes: dihedral angles from 90 (element 1) to 90 degrees (element 1), smallest "
      "volume 1 (element 1) of the mean, smallest scaled Jacobian 1 (element 1), shortest height 0.1 m "
      "(element 1), least mean ratio 0.323 (element 1 at (0.25, 0.5, 0.05))");
  // Edges 0.5, 1, 0.1, and the same at any size.
  EXPECT_NEAR(q.least_ratio.value, 3 * std::pow(0.05, 2.0 / 3) / 1.26, 1e-12);
}

TEST(Quality, slivers_and_folded_corners) {
  ElementMesh mesh = generate_box({{0, 0, 0}}, {{1, 1, 1}}, {1, 1, 1}, hexahedra);
  mesh.nodes[7] = {{0.2, 0.2, 1}};
  MeshQuality q = mesh_quality(mesh);
  EXPECT_LT(q.least_jacobian.value, 0);
  expect_contains(q.messages.back(), "1 of 1 elements are folded at a corner (the first: element 1)");
  q = mesh_quality(generate_box({{0, 0, 0}}, {{1, 1, 0.01}}, {2, 1, 1}, tetrahedra));
  EXPECT_GT(q.slivers, 0u);
  EXPECT_LT(q.least_dihedral.value, 5);
  expect_contains(q.messages.at(0), "elements are slivers");
}

TEST(Quality, round_solids_have_sound_cells) {
  for (const int around : {4, 8, 12, 16, 24}) {
    const MeshQuality cylinder = mesh_quality(generate_cylinder({{0, 0, 0}}, {{0, 0, 2}}, 1, {5, around}, hexahedra));
    EXPECT_GT(cylinder.least_jacobian.value, 0.5) << cylinder.sentence;
    EXPECT_LT(cylinder.greatest_dihedral.value, 150);
    EXPECT_GT(cylinder.least_volume.value, 0.3);
    const MeshQuality ball =
        mesh_quality(generate_ellipsoid({{0, 0, 0}}, {{1, 1, 1}}, {around, std::max(1, around / 8)}, hexahedra));
    EXPECT_GT(ball.least_jacobian.value, 0.3) << ball.sentence;
    EXPECT_GT(ball.least_volume.value, 0.25) << ball.sentence;
  }
}

}  // namespace
}  // namespace fascia::quality_test
