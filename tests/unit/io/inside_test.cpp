#include "core/geometry/inside.hpp"

#include "core/geometry/primitives.hpp"
#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/support/paths.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace fascia::inside_test {
namespace {

/// Solid angle of the surface seen from x, over 4π: 1 inside, 0 outside, by brute force.
double winding_by_solid_angle(const TriangleMesh& mesh, const Vec3d& x) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t n) { return mesh.points[static_cast<std::size_t>(t[n])] - x; };
    const Vec3d a = corner(0), b = corner(1), c = corner(2);
    const double la = norm(a), lb = norm(b), lc = norm(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

double distance_by_scan(const TriangleMesh& mesh, const Vec3d& x) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t n) { return mesh.points[static_cast<std::size_t>(t[n])]; };
    best = std::min(best, norm(nearest_on_triangle(x, corner(0), corner(1), corner(2)) - x));
  }
  return best;
}

/// Compares with brute force; points within `margin` of the surface are left out.
void compare(const TriangleMesh& mesh, const std::vector<Vec3d>& queries, double margin) {
  const InsideTest test(mesh);
  std::size_t compared = 0;
  for (const Vec3d& x : queries) {
    Vec3d nearest;
    const double distance = test.distance(x, &nearest);
    ASSERT_NEAR(distance, distance_by_scan(mesh, x), 1e-12);
    ASSERT_NEAR(distance, norm(nearest - x), 1e-15);
    char on_line = 2;
    test.contains_on_line(x[1], x[2], {&x[0], 1}, {&on_line, 1});
    ASSERT_EQ(on_line, test.contains(x) ? 1 : 0);
    if (distance < margin) continue;
    ++compared;
    const double winding = winding_by_solid_angle(mesh, x);
    ASSERT_NEAR(winding, std::round(winding), 1e-6);
    ASSERT_EQ(test.winding_number(x), static_cast<int>(std::round(winding))) << x[0] << " " << x[1] << " " << x[2];
    ASSERT_EQ(test.contains(x), winding > 0.5);
  }
  EXPECT_GT(compared, queries.size() / 3);
}

std::vector<Vec3d> random_points(const Vec3d& low, const Vec3d& high, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3d> points;
  for (int i = 0; i < count; ++i) {
    Vec3d x;
    for (int c = 0; c < 3; ++c) x[c] = low[c] + (high[c] - low[c]) * unit(random);
    points.push_back(x);
  }
  return points;
}

/// Points whose ray along x meets a vertex or an edge's middle exactly.
std::vector<Vec3d> aligned_points(const TriangleMesh& mesh, std::size_t stride) {
  std::vector<Vec3d> points;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += stride) {
    const Vec3d a = mesh.points[static_cast<std::size_t>(mesh.triangles[t][0])];
    const Vec3d b = mesh.points[static_cast<std::size_t>(mesh.triangles[t][1])];
    const Vec3d middle = 0.5 * (a + b);
    for (const double x : {-0.8, -0.3, 0.01, 0.2, 0.45, 0.9}) {
      points.push_back({{x, a[1], a[2]}});
      points.push_back({{x, middle[1], middle[2]}});
    }
  }
  return points;
}

TEST(InsideTest, box) {
  const TriangleMesh mesh = box_surface({{-0.5, -0.5, -0.5}}, {{0.5, 0.5, 0.5}}, 4, 4, 4);
  compare(mesh, random_points({{-1, -1, -1}}, {{1, 1, 1}}, 2000), 1e-9);
  compare(mesh, aligned_points(mesh, 1), 1e-9);
}

TEST(InsideTest, ellipsoid_and_cylinder) {
  for (const TriangleMesh& mesh : {ellipsoid_surface({{0, 0, 0}}, {{0.9, 0.6, 0.5}}, 9),
                                   cylinder_surface({{-0.5, -0.4, -0.3}}, {{0.6, 0.4, 0.5}}, 0.4, 31, 7),
                                   cylinder_surface({{-0.5, 0, 0}}, {{0.5, 0, 0}}, 0.4, 200, 1)}) {
    compare(mesh, random_points({{-1, -1, -1}}, {{1, 1, 1}}, 500), 1e-9);
    compare(mesh, aligned_points(mesh, 3), 1e-9);
  }
}

TEST(InsideTest, liver_surface) {
  const std::filesystem::path file = fascia::test::shared_dir() / "meshes" / "liver_sofa_surface.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "absent: " << file;
  const TriangleMesh mesh = closed_surface(io::read_mesh(file)).mesh;
  Vec3d low = mesh.points[0], high = low;
  for (const Vec3d& x : mesh.points)
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], x[c]);
      high[c] = std::max(high[c], x[c]);
    }
  compare(mesh, random_points(low, high, 500), 1e-9);
  std::vector<Vec3d> aligned = aligned_points(mesh, 40);
  for (Vec3d& x : aligned) x[0] = low[0] + (high[0] - low[0]) * (0.5 * x[0] + 0.5);
  compare(mesh, aligned, 1e-9);
}

TEST(InsideTest, cavity_and_inward_surface) {
  TriangleMesh mesh = box_surface({{0, 0, 0}}, {{4, 4, 4}}, 2, 2, 2);
  const TriangleMesh hole = box_surface({{1, 1, 1}}, {{3, 3, 3}}, 2, 2, 2);
  const int shift = static_cast<int>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), hole.points.begin(), hole.points.end());
  for (const auto& t : hole.triangles) mesh.triangles.push_back({t[0] + shift, t[2] + shift, t[1] + shift});
  const InsideTest test(mesh);
  EXPECT_FALSE(test.contains({{2, 2, 2}}));
  EXPECT_TRUE(test.contains({{0.5, 2, 2}}));
  EXPECT_TRUE(test.contains({{3.5, 2, 2}}));
  EXPECT_FALSE(test.contains({{4.5, 2, 2}}));
}

/// Planes of a box that hold the line, or end where a point lies, are decided alike.
TEST(InsideTest, a_line_finds_what_its_points_find) {
  const TriangleMesh mesh = box_surface({{0, 0, 0}}, {{4, 4, 4}}, 2, 2, 2);
  const InsideTest test(mesh);
  const std::vector<double> places{-1, 0, 1e-9, 1, 2, 3, 4 - 1e-9, 4, 5};
  std::vector<char> inside(places.size());
  int found = 0;
  for (const double y : places)
    for (const double z : places) {
      test.contains_on_line(y, z, places, inside);
      for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(inside[i], test.contains({{places[i], y, z}}) ? 1 : 0) << places[i] << " " << y << " " << z;
        found += inside[i];
      }
    }
  EXPECT_GE(found, 5 * 5 * 5);
}

TEST(InsideTest, empty_surface) {
  const InsideTest test(TriangleMesh{});
  EXPECT_FALSE(test.contains({{0, 0, 0}}));
  EXPECT_TRUE(std::isinf(test.distance({{0, 0, 0}})));
}

}  // namespace
}  // namespace fascia::inside_test
