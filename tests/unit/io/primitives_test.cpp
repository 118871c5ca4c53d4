#include "core/geometry/primitives.hpp"

#include "core/geometry/surface.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <cmath>
#include <numbers>

namespace fascia::primitives_test {
namespace {

using samples::mesh_of;

/// Closed, outward as it is, all points used once.
ClosedSurface checked(const TriangleMesh& mesh) {
  const ClosedSurface s = closed_surface(mesh_of(mesh));
  EXPECT_TRUE(s.messages.empty()) << s.messages[0];
  EXPECT_EQ(s.mesh.points.size(), mesh.points.size());
  return s;
}

TEST(Primitives, box) {
  const Vec3d min{{0.1, -0.3, 7}}, max{{0.7, 0.9, 7.3}};
  const TriangleMesh mesh = box_surface(min, max, 3, 7, 11);
  EXPECT_EQ(mesh.triangles.size(), 4u * (3 * 7 + 7 * 11 + 11 * 3));
  EXPECT_NEAR(checked(mesh).volume, 0.6 * 1.2 * 0.3, 1e-14);
  for (const Vec3d& x : mesh.points) {
    bool on_a_face = false;
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(x[c], min[c]);
      EXPECT_LE(x[c], max[c]);
      on_a_face = on_a_face || x[c] == min[c] || x[c] == max[c];
    }
    EXPECT_TRUE(on_a_face);
  }
}

TEST(Primitives, cylinder) {
  const Vec3d from{{1, 2, 3}}, to{{2, 4, 5}};
  const TriangleMesh mesh = cylinder_surface(from, to, 0.5, 24, 5);
  const double polygon = 0.5 * 24 * 0.25 * std::sin(2 * std::numbers::pi / 24);
  EXPECT_NEAR(checked(mesh).volume, 3 * polygon, 1e-13);
  const Vec3d axis = normalized(to - from);
  for (std::size_t i = 0; i + 2 < mesh.points.size(); ++i)
    EXPECT_NEAR(norm(cross(mesh.points[i] - from, axis)), 0.5, 1e-14);
}

TEST(Primitives, ellipsoid) {
  const Vec3d center{{1, 0, -1}}, radii{{0.3, 0.2, 0.1}};
  const double exact = 4 * std::numbers::pi / 3 * radii[0] * radii[1] * radii[2];
  double former = 1;
  for (const int n : {1, 2, 4, 8, 16}) {
    const TriangleMesh mesh = ellipsoid_surface(center, radii, n);
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(8 * n * n));
    const double error = 1 - checked(mesh).volume / exact;
    EXPECT_GT(error, 0);
    EXPECT_LT(error, former);
    former = error;
    for (const Vec3d& x : mesh.points) {
      const Vec3d d = x - center;
      EXPECT_NEAR(std::hypot(d[0] / radii[0], d[1] / radii[1], d[2] / radii[2]), 1, 1e-14);
    }
  }
  EXPECT_LT(former, 0.01);
}

}  // namespace
}  // namespace fascia::primitives_test
