// Surfaces without matter: places follow the vertices of their triangle.
#include "coupling/surface_body.hpp"

#include "shells/generate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fascia::surface_body_test {
namespace {

TEST(SurfaceBody, PlacesFollowTheirTriangle) {
  const ShellMesh mesh = rectangle({{1, 0, 2}}, {{1, 0, 0}}, {{0, 2, 0}}, {3, 4}, Diagonal::alternating);
  Model model;
  model.rest_position.resize(5);  // of another body
  model.rest_orientation.resize(5);
  model.frame_kind.resize(5, FrameKind::rigid);
  model.inertia.resize(5);
  const SurfaceBody body({mesh.nodes, mesh.triangles}, model);
  EXPECT_EQ(body.first_node(), 5);
  EXPECT_EQ(body.node_count(), 20);
  EXPECT_EQ(model.node_count(), 25);
  EXPECT_EQ(model.inertia.size(), 25u);
  EXPECT_EQ(model.inertia.back().mass, 0);
  EXPECT_EQ(model.frame_kind.back(), FrameKind::vertex);
  EXPECT_EQ(body.cells().nodes.size(), 3 * mesh.triangles.size());

  // A linear displacement is reproduced, with its gradient along the surface.
  State state = State::at_rest(model);
  Mat3d H = skew(Vec3d{{0.1, 0.2, 0.3}});
  H(0, 0) = 0.7;
  for (int i = 5; i < 25; ++i) state.u[at(i)] = H * model.rest_position[at(i)];
  const Mat3d tangential = H * (Mat3d::identity() - outer(Vec3d{{0, 0, 1}}, Vec3d{{0, 0, 1}}));
  for (const Vec3d& X : {Vec3d{{1.4, 0.3, 2}}, Vec3d{{1.9, 1.99, 2.5}}, Vec3d{{1, 0, 2}}}) {
    const Attachment a = body.attach(X);
    const FieldValue f = field_at(a, state);
    EXPECT_LT(norm(f.u - H * Vec3d{{X[0], X[1], 2}}), 1e-14);
    EXPECT_LT(norm(f.H - tangential), 1e-14);
    EXPECT_TRUE(std::is_sorted(a.nodes.begin(), a.nodes.end()));
  }
  EXPECT_EQ(body.attach_surface(7).nodes, std::vector<int>{12});
  EXPECT_EQ(body.attach_surface(7).influences[0].w, 1);
  EXPECT_NEAR(body.distance({{1.5, 1, 2.25}}), 0.25, 1e-15);
  const std::vector<char> rim = body.nodes_on_boundary();
  EXPECT_EQ(std::count(rim.begin(), rim.end(), 1), 14);
  EXPECT_EQ(norm(body.strain_at(body.attach({{1.4, 0.3, 2}}), state)), 0);
}

TEST(SurfaceBody, TriangleWithoutAreaFollowsItsNearestCorner) {
  Model model;
  const SurfaceBody body({{{{0, 0, 0}}, {{1, 0, 0}}, {{2, 0, 0}}}, {{0, 1, 2}}}, model);
  const Attachment a = body.attach({{0.9, 0, 1}});
  EXPECT_EQ(a.influences[0].w, 0);
  EXPECT_EQ(a.influences[1].w, 1);
  EXPECT_EQ(a.influences[2].w, 0);
}

}  // namespace
}  // namespace fascia::surface_body_test
