#include "core/geometry/surface.hpp"

#include "core/geometry/primitives.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <limits>

namespace fascia::surface_test {
namespace {

using samples::input_error;
using samples::mesh_of;

const std::vector<int> hexahedron{0, 1, 2, 3, 4, 5, 6, 7};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(ClosedSurface, hexahedron) {
  const ClosedSurface s = closed_surface(mesh_of(CellType::hexahedron, samples::cube_points(), hexahedron));
  EXPECT_NEAR(s.volume, 1, 1e-15);
  EXPECT_EQ(s.mesh.triangles.size(), 12u);
  EXPECT_EQ(s.mesh.points.size(), 8u);
  EXPECT_TRUE(s.messages.empty());
}

TEST(ClosedSurface, every_kind_of_volume_cell) {
  const auto cube = samples::cube_points();
  EXPECT_NEAR(closed_surface(mesh_of(CellType::tetrahedron, cube, {0, 1, 3, 4})).volume, 1. / 6, 1e-15);
  EXPECT_NEAR(closed_surface(mesh_of(CellType::wedge, cube, {0, 1, 2, 4, 5, 6})).volume, 1. / 2, 1e-15);
  EXPECT_NEAR(closed_surface(mesh_of(CellType::pyramid, cube, {0, 1, 2, 3, 4})).volume, 1. / 3, 1e-15);
}

TEST(ClosedSurface, common_faces_vanish) {
  // The cube in two wedges: the quadrilateral between them is no boundary.
  const ClosedSurface s =
      closed_surface(mesh_of(CellType::wedge, samples::cube_points(), {0, 1, 2, 4, 5, 6, 0, 2, 3, 4, 6, 7}));
  EXPECT_NEAR(s.volume, 1, 1e-15);
  EXPECT_EQ(s.mesh.triangles.size(), 12u);
}

TEST(ClosedSurface, collapsed_hexahedron_is_a_wedge) {
  const ClosedSurface s =
      closed_surface(mesh_of(CellType::hexahedron, samples::cube_points(), {0, 1, 2, 2, 4, 5, 6, 6}));
  EXPECT_NEAR(s.volume, 0.5, 1e-15);
  EXPECT_EQ(s.mesh.triangles.size(), 8u);
}

TEST(ClosedSurface, all_inverted_is_turned_over) {
  const ClosedSurface s =
      closed_surface(mesh_of(CellType::hexahedron, samples::cube_points(), {4, 5, 6, 7, 0, 1, 2, 3}));
  EXPECT_NEAR(s.volume, 1, 1e-15);
  ASSERT_EQ(s.messages.size(), 1u);
  EXPECT_TRUE(contains(s.messages[0], "turned over"));
}

TEST(ClosedSurface, mixture_of_cells_names_the_odd_one) {
  const Mesh mesh = mesh_of(CellType::tetrahedron, samples::cube_points(),
                            {0, 1, 3, 4, 2, 1, 3, 6, 1, 4, 5, 6, 3, 4, 6, 7, 1, 3, 4, 6});
  const std::string e = input_error([&] { closed_surface(mesh); });
  EXPECT_TRUE(contains(e, "sample.msh: cell 2 is inverted, as are 0 more of 5 cells")) << e;
}

TEST(ClosedSurface, flat_cell) {
  auto points = samples::cube_points();
  points[4] = {{0.3, 0.3, 1e-14}};
  const std::string e = input_error([&] { closed_surface(mesh_of(CellType::tetrahedron, points, {0, 1, 3, 4})); });
  EXPECT_TRUE(contains(e, "cell 1 is flat")) << e;
}

TEST(ClosedSurface, overlapping_and_repeated_cells) {
  auto points = samples::cube_points();
  points.push_back({{0.2, 0.2, 2}});
  const std::string overlap = input_error([&] {
    closed_surface(mesh_of(CellType::tetrahedron, points, {0, 1, 3, 4, 0, 1, 3, 8}));
  });
  EXPECT_TRUE(contains(overlap, "cells 1 and 2 overlap")) << overlap;
  const ClosedSurface repeated = closed_surface(mesh_of(CellType::tetrahedron, points, {0, 1, 3, 4, 1, 3, 0, 4}));
  EXPECT_NEAR(repeated.volume, 1. / 6, 1e-15);
  ASSERT_EQ(repeated.messages.size(), 2u);
  EXPECT_TRUE(contains(repeated.messages[1], "left out 1 cell that repeats another (cell 2, which repeats cell 1)"))
      << repeated.messages[1];
}

TEST(ClosedSurface, a_cell_in_two_groups_counts_once) {
  Mesh mesh = mesh_of(CellType::tetrahedron, samples::cube_points(), {0, 1, 3, 4, 0, 1, 3, 4});
  mesh.groups = {{"a", 1, 3}, {"b", 2, 3}};
  mesh.blocks[0].group = {0, 1};
  EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15);
}

TEST(ClosedSurface, welds_and_drops_unused_points) {
  // Two wedges that do not share points, and a point that nothing uses.
  auto points = samples::cube_points();
  const auto copy = points;
  points.insert(points.end(), copy.begin(), copy.end());
  points[8][0] += 1e-10;
  const ClosedSurface s = closed_surface(mesh_of(CellType::wedge, points, {0, 1, 2, 4, 5, 6, 8, 10, 11, 12, 14, 15}));
  EXPECT_NEAR(s.volume, 1, 1e-9);
  EXPECT_EQ(s.mesh.points.size(), 8u);
  ASSERT_EQ(s.messages.size(), 2u);
  EXPECT_TRUE(contains(s.messages[0], "left out 4 points that no cell uses (the first: node 4)")) << s.messages[0];
  EXPECT_TRUE(contains(s.messages[1], "welded 4 points")) << s.messages[1];
}

TEST(ClosedSurface, unusable_points) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    auto points = samples::cube_points();
    points[6][1] = bad;
    const std::string e = input_error([&] { closed_surface(mesh_of(CellType::hexahedron, points, hexahedron)); });
    EXPECT_TRUE(contains(e, "node 7")) << e;
  }
  const std::string e = input_error([&] {
    closed_surface(mesh_of(CellType::triangle, std::vector<Vec3d>(3), {0, 1, 2}));
  });
  EXPECT_TRUE(contains(e, "coincide")) << e;
}

TEST(ClosedSurface, needs_triangles_or_cells) {
  const std::string e = input_error([&] { closed_surface(mesh_of(CellType::line, samples::cube_points(), {0, 1})); });
  EXPECT_TRUE(contains(e, "neither volume cells nor triangles")) << e;
}

TEST(ClosedSurface, quadrilaterals) {
  const ClosedSurface s =
      closed_surface(mesh_of(CellType::quadrilateral, samples::cube_points(),
                             {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7}));
  EXPECT_NEAR(s.volume, 1, 1e-15);
  EXPECT_EQ(s.mesh.triangles.size(), 12u);
}

TEST(ClosedSurface, far_from_the_origin) {
  const Vec3d far{{1e6, -2e6, 3e6}};
  const ClosedSurface s = closed_surface(mesh_of(box_surface(far, far + Vec3d{{1, 2, 3}}, 3, 3, 3)));
  EXPECT_NEAR(s.volume, 6, 1e-8);
}

}  // namespace
}  // namespace fascia::surface_test
