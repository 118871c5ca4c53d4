#include "core/geometry/inside.hpp"
#include "core/geometry/mesh_parts.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/surface.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <array>
#include <cmath>
#include <random>

// Solids that touch themselves along edges and in points, and triangles that a file has twice.
namespace fascia::touching_surface_test {
namespace {

using samples::input_error;
using samples::mesh_of;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Unit cubes of a grid, each with the corners of its neighbours, as hexahedra.
Mesh cubes(int size, const std::vector<std::array<int, 3>>& places) {
  const int n = size + 1;
  std::vector<Vec3d> points;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) points.push_back({{1.0 * i, 1.0 * j, 1.0 * k}});
  std::vector<int> nodes;
  for (const auto& [i, j, k] : places) {
    const int a = i + n * (j + n * k), c = a + n, up = n * n;
    nodes.insert(nodes.end(), {a, a + 1, c + 1, c, a + up, a + 1 + up, c + 1 + up, c + up});
  }
  return mesh_of(CellType::hexahedron, points, nodes);
}

const std::vector<std::array<int, 3>> kAlongAnEdge{{0, 0, 0}, {1, 1, 0}};

TriangleMesh turned(TriangleMesh mesh, std::size_t from = 0) {
  for (std::size_t t = from; t < mesh.triangles.size(); ++t) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return mesh;
}

TEST(TouchingSurface, two_cubes_along_an_edge) {
  const ClosedSurface s = closed_surface(cubes(2, kAlongAnEdge));
  EXPECT_NEAR(s.volume, 2, 1e-14);
  const InsideTest inside(s.mesh);
  EXPECT_TRUE(inside.contains({{0.5, 0.5, 0.5}}) && inside.contains({{1.5, 1.5, 0.5}}));
  EXPECT_FALSE(inside.contains({{1.5, 0.5, 0.5}}) || inside.contains({{0.5, 1.5, 0.5}}));
  const std::string said = "its surface touches itself along 1 edge, between nodes 5 and 14; the solid hangs together";
  ASSERT_FALSE(s.messages.empty());
  EXPECT_TRUE(contains(s.messages.back(), said)) << s.messages.back();
  EXPECT_NEAR(mesh_parts(cubes(2, kAlongAnEdge)).solid->volume, 2, 1e-14);

  // The same as a surface, also all inside out; and with one cube inside out.
  EXPECT_NEAR(closed_surface(mesh_of(s.mesh)).volume, 2, 1e-14);
  EXPECT_NEAR(closed_surface(mesh_of(turned(s.mesh))).volume, 2, 1e-14);
  TriangleMesh mixed = s.mesh;
  for (auto& t : mixed.triangles) {
    bool first = true;
    for (const int node : t) {
      const Vec3d& x = s.mesh.points[static_cast<std::size_t>(node)];
      first = first && x[0] <= 1 && x[1] <= 1;
    }
    if (first) std::swap(t[1], t[2]);
  }
  const std::string e = input_error([&] { closed_surface(mesh_of(mixed)); });
  EXPECT_TRUE(contains(e, "is oriented against the others (1 of 2 parts)")) << e;
}

/// Surfaces side by side in one mesh, each on points of its own.
TriangleMesh together(const std::vector<TriangleMesh>& surfaces) {
  TriangleMesh all;
  for (const TriangleMesh& surface : surfaces) {
    const int shift = static_cast<int>(all.points.size());
    all.points.insert(all.points.end(), surface.points.begin(), surface.points.end());
    for (const auto& t : surface.triangles) all.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  }
  return all;
}

TEST(TouchingSurface, cavities_that_touch_must_face_inward) {
  // Two cubes along an edge within a larger one.
  const TriangleMesh box = box_surface({{-1, -1, -1}}, {{3, 3, 3}}, 1, 1, 1);
  const TriangleMesh pair = closed_surface(cubes(2, kAlongAnEdge)).mesh;
  EXPECT_NEAR(closed_surface(mesh_of(together({box, turned(pair)}))).volume, 64 - 2, 1e-12);
  const std::string e = input_error([&] { closed_surface(mesh_of(together({box, pair}))); });
  EXPECT_TRUE(contains(e, "is oriented against the others (2 of 3 parts)")) << e;

  // A tetrahedron within a cube, along one of its edges.
  std::vector<Vec3d> points = samples::cube_points();
  points.insert(points.end(), {{{0.8, 0.3, 0.5}}, {{0.3, 0.8, 0.5}}});
  const std::vector<int> cube{0, 3, 2, 0, 2, 1, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                              1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
  std::vector<int> solid{0, 8, 4, 0, 9, 8, 4, 8, 9, 0, 4, 9}, cavity{0, 4, 8, 0, 8, 9, 4, 9, 8, 0, 9, 4};
  for (std::vector<int>* inner : {&solid, &cavity}) inner->insert(inner->end(), cube.begin(), cube.end());
  const std::string twice = input_error([&] { closed_surface(mesh_of(CellType::triangle, points, solid)); });
  EXPECT_TRUE(contains(twice, "is oriented against the others (1 of 2 parts)")) << twice;
  EXPECT_NEAR(closed_surface(mesh_of(CellType::triangle, points, cavity)).volume, 1 - 0.55 / 6, 1e-14);
}

TEST(TouchingSurface, cells_at_random_say_what_is_inside) {
  std::mt19937 random(11);
  constexpr int size = 4;
  int touching = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<std::array<int, 3>> places;
    std::vector<bool> full;
    for (int k = 0; k < size; ++k)
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
          full.push_back(random() % 5 < 2);
          if (full.back()) places.push_back({i, j, k});
        }
    const ClosedSurface s = closed_surface(cubes(size, places));
    touching += s.messages.empty() || !contains(s.messages.back(), "touches itself") ? 0 : 1;
    for (const TriangleMesh& skin : {s.mesh, turned(s.mesh)}) {
      const ClosedSurface again = closed_surface(mesh_of(skin));
      EXPECT_NEAR(again.volume, static_cast<double>(places.size()), 1e-11);
      const InsideTest inside(again.mesh);
      for (int c = 0; c < size * size * size; ++c) {
        const Vec3d middle{{c % size + 0.53, c / size % size + 0.48, c / (size * size) + 0.51}};
        EXPECT_EQ(inside.winding_number(middle), full[static_cast<std::size_t>(c)] ? 1 : 0) << "round " << round;
      }
    }
  }
  EXPECT_GT(touching, 190);
}

/// A sliver along an edge, inside the solid and outward, as a fold of the surface leaves it.
TEST(TouchingSurface, small_folds_are_left_out) {
  TriangleMesh folded = closed_surface(cubes(1, {{0, 0, 0}})).mesh;
  const auto node_at = [&](const Vec3d& x) {
    const auto found = std::find_if(folded.points.begin(), folded.points.end(),
                                    [&](const Vec3d& p) { return squared_norm(p - x) < 1e-20; });
    return static_cast<int>(found - folded.points.begin());
  };
  const int a = node_at({{0, 0, 0}}), b = node_at({{1, 0, 0}}), c = static_cast<int>(folded.points.size()), d = c + 1;
  folded.points.push_back({{0.5, 0.02, 0.01}});
  folded.points.push_back({{0.5, 0.01, 0.02}});
  for (const std::array<int, 3>& t :
       {std::array{a, c, b}, std::array{a, b, d}, std::array{a, d, c}, std::array{b, c, d}})
    folded.triangles.push_back(t);
  const ClosedSurface s = closed_surface(mesh_of(folded));
  EXPECT_NEAR(s.volume, 1, 1e-15);
  ASSERT_EQ(s.messages.size(), 2u);
  EXPECT_TRUE(contains(s.messages[1], "left out 4 triangles of folds")) << s.messages[1];
}

TEST(TouchingSurface, copies_are_left_out) {
  const ClosedSurface cube = closed_surface(cubes(1, {{0, 0, 0}}));
  TriangleMesh twice = cube.mesh;
  twice.triangles.push_back(twice.triangles[3]);
  twice.triangles.push_back({twice.triangles[7][0], twice.triangles[7][2], twice.triangles[7][1]});
  const ClosedSurface s = closed_surface(mesh_of(twice));
  EXPECT_NEAR(s.volume, 1, 1e-15);
  EXPECT_EQ(s.messages,
            std::vector<std::string>{"sample.msh: left out 2 triangles that have the nodes of others (the first: "
                                     "triangle 13, which lies on triangle 4)"});

  // A fin of two triangles back to back: both go.
  TriangleMesh fin = cube.mesh;
  fin.points.push_back({{0.5, 0.5, 3}});
  fin.triangles.push_back({4, 5, 8});
  fin.triangles.push_back({5, 4, 8});
  const ClosedSurface without = closed_surface(mesh_of(fin));
  EXPECT_EQ(without.mesh.triangles.size(), 12u);
  EXPECT_NEAR(without.volume, 1, 1e-15);
  ASSERT_EQ(without.messages.size(), 1u);
  EXPECT_TRUE(contains(without.messages[0], "left out 2 triangles")) << without.messages[0];
}

TEST(TouchingSurface, bodies_on_a_common_face) {
  // Two boxes whose surfaces both have the face between them: it encloses nothing and goes.
  const ClosedSurface low = closed_surface(cubes(2, {{0, 0, 0}})), high = closed_surface(cubes(2, {{0, 0, 1}}));
  TriangleMesh both = low.mesh;
  const int shift = static_cast<int>(both.points.size());
  both.points.insert(both.points.end(), high.mesh.points.begin(), high.mesh.points.end());
  for (const auto& t : high.mesh.triangles) both.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  const ClosedSurface s = closed_surface(mesh_of(both));
  EXPECT_NEAR(s.volume, 2, 1e-14);
  EXPECT_EQ(s.mesh.triangles.size(), 20u);

  // Two tetrahedra, one within the other, on the same base: it is needed twice, or the surface is open.
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0.2, 0.2, 1}}, {{0.25, 0.25, 3}}};
  const Mesh nested =
      mesh_of(CellType::triangle, points, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 2, 1, 0, 1, 4, 1, 2, 4, 2, 0, 4});
  const InsideTest inside(closed_surface(nested).mesh);
  EXPECT_TRUE(inside.contains({{0.3, 0.3, 0.1}}) && inside.contains({{0.25, 0.25, 2}}));
  EXPECT_FALSE(inside.contains({{0.3, 0.3, -0.1}}));
}

TEST(TouchingSurface, wall_between_two_chambers) {
  // Two boxes side by side as closed surfaces, both with the wall between them.
  std::vector<Vec3d> points = samples::cube_points();
  points.insert(points.end(), {{{2, 0, 0}}, {{2, 1, 0}}, {{2, 0, 1}}, {{2, 1, 1}}});
  Mesh mesh = mesh_of(CellType::quadrilateral, points,
                      {0, 3, 2, 1, 4, 5,  6,  7, 0, 1, 5,  4, 1, 2, 6,  5,  2, 3, 7, 6,  3, 0, 4, 7,
                       1, 2, 9, 8, 5, 10, 11, 6, 1, 8, 10, 5, 8, 9, 11, 10, 9, 2, 6, 11, 2, 1, 5, 6});
  for (const bool grouped : {false, true}) {
    if (grouped) {
      mesh.groups = {{"first", 1, 2}, {"second", 2, 2}};
      for (std::size_t c = 0; c < 12; ++c) mesh.blocks[0].group[c] = c < 6 ? 0 : 1;
    }
    const ClosedSurface solid = closed_surface(mesh);
    EXPECT_NEAR(solid.volume, 2, 1e-14);
    EXPECT_EQ(solid.mesh.triangles.size(), 20u) << "of a solid the wall encloses nothing";
    EXPECT_EQ(mesh_parts(mesh).sheet.triangles.size(), 22u) << "of a sheet it is matter";
  }
}

TEST(TouchingSurface, cells_that_repeat_others_of_their_groups) {
  Mesh mesh = cubes(1, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  mesh.groups = {{"a", 1, 3}, {"b", 2, 3}};
  mesh.blocks[0].group = {0, 1, 0, 1};
  const ClosedSurface s = closed_surface(mesh);
  EXPECT_NEAR(s.volume, 1, 1e-15);
  EXPECT_EQ(s.messages, std::vector<std::string>{"sample.msh: left out 2 cells that repeat others (the first: cell 3, "
                                                 "which repeats cell 1)"});
}

TEST(TouchingSurface, many_triangles_at_one_edge) {
  // Tetrahedra around the z axis, each apart from its neighbours.
  const int count = 2000;
  std::vector<Vec3d> points{{{0, 0, 0}}, {{0, 0, 1}}};
  std::vector<int> nodes;
  for (int k = 0; k < count; ++k) {
    for (const double a : {6.28 * k / count, 6.28 * (k + 0.5) / count})
      points.push_back({{std::cos(a), std::sin(a), 0.5}});
    const int b = 2 + 2 * k, c = b + 1;
    nodes.insert(nodes.end(), {0, b, 1, 0, c, b, 1, b, c, 0, 1, c});
  }
  EXPECT_NEAR(closed_surface(mesh_of(CellType::triangle, points, nodes)).volume, 3.14 / 6, 1e-3);
}

TEST(TouchingSurface, cells_that_repeat_others) {
  Mesh mesh = cubes(2, {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}});
  const ClosedSurface s = closed_surface(mesh);
  EXPECT_NEAR(s.volume, 2, 1e-14);
  ASSERT_FALSE(s.messages.empty());
  EXPECT_EQ(s.messages.back(), "sample.msh: left out 1 cell that repeats another (cell 3, which repeats cell 1)");
  std::swap(mesh.blocks[0].nodes[16], mesh.blocks[0].nodes[17]);  // the same corners in another order
  const std::string e = input_error([&] { closed_surface(mesh); });
  EXPECT_TRUE(contains(e, "cells 1 and 3 have the same nodes; remove one of them")) << e;
}

}  // namespace
}  // namespace fascia::touching_surface_test
