#include "core/geometry/primitives.hpp"
#include "core/geometry/surface.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace fascia::surface_orientation_test {
namespace {

using samples::input_error;
using samples::mesh_of;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TriangleMesh cube(double low, double high) { return box_surface({{low, low, low}}, {{high, high, high}}, 2, 2, 2); }

TriangleMesh inward(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh both(TriangleMesh a, const TriangleMesh& b) {
  const int shift = static_cast<int>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

TEST(SurfaceOrientation, inward_is_turned_over) {
  const ClosedSurface s = closed_surface(mesh_of(inward(cube(0, 1))));
  EXPECT_NEAR(s.volume, 1, 1e-14);
  ASSERT_EQ(s.messages.size(), 1u);
  EXPECT_TRUE(contains(s.messages[0], "turned over"));
}

TEST(SurfaceOrientation, mixture_names_the_minority) {
  TriangleMesh mesh = cube(0, 1);
  std::swap(mesh.triangles[6][0], mesh.triangles[6][1]);
  std::swap(mesh.triangles[9][0], mesh.triangles[9][1]);
  const std::string e = input_error([&] { closed_surface(mesh_of(mesh)); });
  EXPECT_TRUE(contains(e, "triangle 7 is oriented against its neighbours, as are 1 more of 48")) << e;

  mesh = inward(mesh);
  EXPECT_TRUE(contains(input_error([&] { closed_surface(mesh_of(mesh)); }), "triangle 7 is oriented")) << e;
}

TEST(SurfaceOrientation, open_surface_names_an_edge) {
  TriangleMesh mesh = cube(0, 1);
  mesh.triangles.pop_back();
  const std::string e = input_error([&] { closed_surface(mesh_of(mesh)); });
  EXPECT_TRUE(contains(e, "open: 3 edges have one triangle only, the first between nodes ")) << e;
  EXPECT_TRUE(contains(e, "close the holes")) << e;
}

TEST(SurfaceOrientation, third_triangle_at_an_edge) {
  TriangleMesh mesh = cube(0, 1);
  mesh.points.push_back({{3, 3, 3}});
  mesh.triangles.push_back({0, 1, static_cast<int>(mesh.points.size()) - 1});
  const std::string e = input_error([&] { closed_surface(mesh_of(mesh)); });
  EXPECT_TRUE(contains(e, "belongs to 3 triangles")) << e;
}

TEST(SurfaceOrientation, flat_triangle) {
  TriangleMesh mesh = cube(0, 1);
  mesh.triangles.push_back({0, 1, 1});
  const std::string e = input_error([&] { closed_surface(mesh_of(mesh)); });
  EXPECT_TRUE(contains(e, "triangle 49 is flat")) << e;
}

TEST(SurfaceOrientation, several_parts) {
  EXPECT_NEAR(closed_surface(mesh_of(both(cube(0, 1), cube(2, 4)))).volume, 9, 1e-13);
  EXPECT_NEAR(closed_surface(mesh_of(inward(both(cube(0, 1), cube(2, 4))))).volume, 9, 1e-13);
  const std::string e = input_error([&] { closed_surface(mesh_of(both(cube(0, 1), inward(cube(2, 4))))); });
  EXPECT_TRUE(contains(e, "part with triangle 49 is oriented against")) << e;
}

TEST(SurfaceOrientation, cavities) {
  EXPECT_NEAR(closed_surface(mesh_of(both(cube(0, 4), inward(cube(1, 3))))).volume, 64 - 8, 1e-12);
  // A part in a cavity, all of it inside out.
  const TriangleMesh nested = both(both(cube(0, 9), inward(cube(1, 8))), cube(3, 4));
  const ClosedSurface s = closed_surface(mesh_of(inward(nested)));
  EXPECT_NEAR(s.volume, 729 - 343 + 1, 1e-10);
  EXPECT_EQ(s.messages.size(), 1u);
  EXPECT_TRUE(contains(input_error([&] { closed_surface(mesh_of(both(cube(0, 4), cube(1, 3)))); }), "cavities"));
}

/// Matter in both would count twice. What touches does not intersect, and what hardly does is told.
TEST(SurfaceOrientation, parts_that_intersect) {
  const auto block = [](const Vec3d& low, const Vec3d& high) { return box_surface(low, high, 1, 1, 1); };
  const TriangleMesh shifted = block({{0.5, 0.25, 0.25}}, {{2, 0.75, 0.75}}),
                     along = block({{-5, -0.5, -0.5}}, {{5, 0.5, 0.5}}),
                     across = block({{-0.5, -5, -0.5}}, {{0.5, 5, 0.5}});
  for (const TriangleMesh& mesh : {both(cube(0, 1), cube(0.3, 1.3)), both(cube(0, 1), shifted),
                                   both(shifted, cube(0, 1)), inward(both(cube(0, 1), shifted)), both(along, across)}) {
    const std::string e = input_error([&] { closed_surface(mesh_of(mesh)); });
    EXPECT_TRUE(contains(e, "surface intersects itself, and about ")) << e;
    EXPECT_TRUE(contains(e, "counts twice or not; unite what overlaps")) << e;
  }
  for (const double deep : {0.0, 1e-9, 1e-6}) {
    const ClosedSurface on_it =
        closed_surface(mesh_of(both(block({{0.2, 0.3, 1 - deep}}, {{0.7, 0.8, 2}}), cube(0, 1))));
    EXPECT_NEAR(on_it.volume, 1.25, 2 * deep + 1e-12);
    EXPECT_TRUE(on_it.messages.empty());
  }
  EXPECT_NEAR(closed_surface(mesh_of(both(cube(0, 1), block({{1.1, 0, 0}}, {{2, 1, 1}})))).volume, 1.9, 1e-12);
  TriangleMesh folded = cube(0, 1);  // its lid is pushed through the bottom
  for (Vec3d& x : folded.points)
    if (x[2] == 1 && x[0] == 0.5 && x[1] == 0.5) x[2] = -1;
  const std::vector<std::string> told = closed_surface(mesh_of(folded)).messages;
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(contains(told[0], "surface intersects itself, and about ")) << told[0];
  const ClosedSurface hardly = closed_surface(mesh_of(both(cube(0, 1), block({{0.2, 0.2, 0.96}}, {{0.7, 0.7, 2}}))));
  ASSERT_EQ(hardly.messages.size(), 1u);
  EXPECT_TRUE(contains(hardly.messages[0], "surface intersects itself, and about 0.8 % of")) << hardly.messages[0];
}

/// Of parts that all face outward, as those of sheets do.
TEST(SurfaceOrientation, parts_in_others_become_cavities) {
  const auto volume = [](const TriangleMesh& mesh) { return closed_surface(mesh_of(mesh)).volume; };
  std::vector<std::string> messages;
  const auto turned = [&](TriangleMesh mesh, OfOverlap overlap = OfOverlap::is_refused) {
    messages = turn_cavities("a.stl", overlap, mesh);
    return mesh;
  };
  EXPECT_NEAR(volume(turned(both(cube(0, 4), cube(1, 3)))), 64 - 8, 1e-12);
  EXPECT_EQ(messages, std::vector<std::string>{"a.stl: 1 closed part lies inside another and bounds a cavity"});
  EXPECT_NEAR(volume(turned(both(both(cube(3, 4), cube(0, 9)), cube(1, 8)))), 729 - 343 + 1, 1e-10);
  EXPECT_NEAR(volume(turned(both(both(cube(0, 9), cube(1, 3)), cube(4, 8)))), 729 - 8 - 64, 1e-10);
  EXPECT_EQ(messages, std::vector<std::string>{"a.stl: 2 closed parts lie inside others and bound cavities"});
  const TriangleMesh apart = both(cube(0, 1), cube(2, 4)), crossed = both(cube(0, 1), cube(0.3, 1.3));
  EXPECT_EQ(turned(apart).triangles, apart.triangles);
  EXPECT_TRUE(messages.empty());
  EXPECT_TRUE(contains(input_error([&] { turned(crossed); }), "a.stl: its surface intersects itself"));
  EXPECT_EQ(turned(crossed, OfOverlap::is_told).triangles, crossed.triangles);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_TRUE(contains(messages[0], "a.stl: its surface intersects itself")) << messages[0];
}

TEST(SurfaceOrientation, one_sided_surface) {
  // Projective plane with six vertices: closed, every edge twice, not orientable.
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1, 1, 0.5}}, {{0.3, 1, 1}}};
  const Mesh mesh = mesh_of(CellType::triangle, points,
                            {0, 1, 4, 0, 1, 5, 0, 2, 3, 0, 2, 5, 0, 3, 4, 1, 2, 3, 1, 2, 4, 1, 3, 5, 2, 4, 5, 3, 4, 5});
  const std::string e = input_error([&] { closed_surface(mesh); });
  EXPECT_TRUE(contains(e, "one side only")) << e;
}

TEST(SurfaceOrientation, no_volume) {
  // Two triangles back to back, made of different nodes that do not weld.
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0.25, 0.25, 0}}};
  const Mesh mesh = mesh_of(CellType::triangle, points, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3});
  const std::string e = input_error([&] { closed_surface(mesh); });
  EXPECT_TRUE(contains(e, "encloses no volume")) << e;
}

}  // namespace
}  // namespace fascia::surface_orientation_test
