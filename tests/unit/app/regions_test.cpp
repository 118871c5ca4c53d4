#include "assembly/simulation/regions.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

// What a region selects follows from the body and the region's border, not from how large or far away the region is.
namespace fascia::app::regions_test {
namespace {

/// A lattice of 5 × 3 × 3 points on [0, 1] × [0, 0.2]², scaled and moved.
std::vector<Vec3d> lattice(double scale, const Vec3d& origin) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 45; ++i)
    points.push_back(origin + Vec3d{{0.25 * (i % 5), 0.1 * (i / 5 % 3), 0.1 * (i / 15)}} * scale);
  return points;
}

std::vector<bool> selected(const decltype(Region::shape)& shape, const std::vector<Vec3d>& points) {
  return select({{}, shape}, {points});
}

/// The points of the lattice with the first coordinate of its face, 0.
std::vector<bool> face() {
  std::vector<bool> chosen;
  for (int i = 0; i < 45; ++i) chosen.push_back(i % 5 == 0);
  return chosen;
}

constexpr std::array<double, 3> kScales{1e-6, 1, 1e6};

TEST(Regions, OfAnyWidthSelectTheFaceAlone) {
  for (const double scale : kScales) {
    const std::vector<Vec3d> points = lattice(scale, {});
    for (double far = 10 * scale; far < 2e15; far *= 10) {
      SCOPED_TRACE(std::to_string(scale) + " m, a region of " + std::to_string(far) + " m");
      const double face_at = 0.01 * scale;
      EXPECT_EQ(selected(BoxRegion{{{-far, -far, -far}}, {{face_at, far, far}}}, points), face());
      EXPECT_EQ(selected(HalfspaceRegion{{{0, far, -far}}, {{1, 0, 0}}}, points), face());
      EXPECT_EQ(selected(CylinderRegion{{{0, -far, 0}}, {{0, far, 0}}, 0.2001 * scale}, points), face());
      EXPECT_EQ(selected(CylinderRegion{{{-far, 0, 0}}, {{0, 0, 0}}, far}, points), face());
      const std::vector<bool> ball = selected(SphereRegion{{{-far, 0, 0}}, far}, points);
      EXPECT_TRUE(ball[0]);
      for (std::size_t i = 0; i < ball.size(); ++i) EXPECT_FALSE(ball[i] && i % 5 != 0) << "off the face it touches";
    }
  }
}

TEST(Regions, ObliqueOnesKeepTheDigitsOfTheirNumbers) {
  const std::vector<Vec3d> points = lattice(1e-3, {});
  std::vector<bool> low, edge;
  for (const Vec3d& x : points) {
    low.push_back(x[0] <= x[1] * (1 + 1e-9));
    edge.push_back(x[0] == 0 && x[1] == 0);
  }
  const double far = 0x1p50;
  EXPECT_EQ(selected(HalfspaceRegion{{{far, far, 0}}, {{1, -1, 0}}}, points), low);
  EXPECT_EQ(selected(CylinderRegion{{{-far, far, 0}}, {{far, -far, 0}}, 1e-5}, points), [&] {
    std::vector<bool> on_axis;
    for (const Vec3d& x : points) on_axis.push_back(x[0] == 0 && x[1] == 0 && x[2] == 0);
    return on_axis;
  }());
  EXPECT_EQ(selected(SphereRegion{{{-3 * far, -4 * far, 0}}, 5 * far}, points), edge);
}

TEST(Regions, FarBodiesAreSelectedAsThoseAtTheOrigin) {
  for (const double scale : kScales) {
    for (double far = 1; far < 2e9; far *= 10) {
      SCOPED_TRACE(std::to_string(scale) + " m, " + std::to_string(far) + " lengths from the origin");
      const Vec3d origin = Vec3d{{1, -2, 0.5}} * (far * scale);
      const std::vector<Vec3d> points = lattice(scale, origin);
      const Vec3d top = origin + Vec3d{{0, 0.2, 0.2}} * scale;
      EXPECT_EQ(selected(BoxRegion{origin, top}, points), face());
      EXPECT_EQ(selected(HalfspaceRegion{origin, {{3, 0, 0}}}, points), face());
      EXPECT_EQ(selected(SphereRegion{origin, 0.2829 * scale}, points)[5], true);
      EXPECT_EQ(selected(CylinderRegion{origin, origin + Vec3d{{0, 0, 1}} * scale, 0.2001 * scale}, points), face());
    }
  }
}

TEST(Regions, ForgiveABillionthOfTheBody) {
  const std::vector<Vec3d> points = lattice(1, {});
  EXPECT_EQ(selected(BoxRegion{{{-1, -1, -1}}, {{-5e-10, 1, 1}}}, points), face());
  EXPECT_EQ(selected(BoxRegion{{{-1, -1, -1}}, {{-5e-9, 1, 1}}}, points), std::vector<bool>(45, false));
  const Region region{{}, BoxRegion{{{-1, -1, -1}}, {{-5e-10, 1, 1}}}};
  EXPECT_TRUE(contains(region, {}, 1));
  EXPECT_FALSE(contains(region, {}, 0.1));
}

}  // namespace
}  // namespace fascia::app::regions_test
