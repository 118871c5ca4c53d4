// Sheets and strands between two surfaces.
#include "core/geometry/bounds.hpp"
#include "coupling/rigid_body.hpp"
#include "tests/unit/coupling/gap_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace fascia::gap_lines_test {
namespace {

using namespace test;

TEST(GapSheet, BetweenTwoStripsIsARectangle) {
  const GapSide low = plate("low", {{0, 0, 0}}, 2, 0.2, {10, 2}), high = plate("high", {{0, 0, 0.5}}, 2, 0.2, {7, 1});
  const TriangleMesh sheet = gap_sheet(low, high, 0.25);
  EXPECT_EQ(sheet.points.size(), 9u * 3u);
  EXPECT_EQ(sheet.triangles.size(), 8u * 2u * 2u);
  EXPECT_NEAR(properties_of_area(sheet).measure, 1, 1e-12);
  for (const Vec3d& X : sheet.points) EXPECT_NEAR(X[1], 0.1, 1e-12);
  EXPECT_GT(least_height(sheet), 0.1);
  // The triangles' edges, where no spacing is given.
  EXPECT_GT(gap_sheet(low, high, 0).triangles.size(), 8u);
}

/// Strips along a quarter of a circle, turned in space: the middle line is an arc.
TEST(GapSheet, FollowsTurnedAndBentStrips) {
  GapSide low = plate("low", {{0, 0, 0}}, 1, 0.2, {20, 4}), high = plate("high", {{0, 0, 0.5}}, 1, 0.2, {30, 2});
  const Mat3d R = Mat3d::identity() + rotation_increment({{0.7, -1.1, 2}});
  for (GapSide* side : {&low, &high})
    for_each_point(*side, [&](const Vec3d& X) {
      const double angle = 0.5 * std::numbers::pi * X[0], r = 0.9 + X[1];
      return R * Vec3d{{r * std::cos(angle), r * std::sin(angle), X[2]}};
    });
  const TriangleMesh sheet = gap_sheet(low, high, 0.1);
  double off = 0;
  for (const Vec3d& X : sheet.points) {
    const Vec3d Y = transpose(R) * X;
    off = std::max(off, std::abs(std::hypot(Y[0], Y[1]) - 1));
  }
  const double length = properties_of_area(sheet).measure / 0.5;
  std::printf("off the arc by %.1e, length %.4f of %.4f\n", off, length, 0.5 * std::numbers::pi);
  // At its ends, over half the strip's width, the line goes on straight: it leaves the arc by 0.1²/R there, twice.
  EXPECT_LT(off, 0.025);
  EXPECT_NEAR(length, 0.5 * std::numbers::pi, 0.02);
}

/// A second strip that is turned by more than a right angle keeps the sheet untwisted.
TEST(GapSheet, IsNotTwisted) {
  const GapSide low = plate("low", {{-1, -0.1, 0}}, 2, 0.2, {10, 2});
  for (const double angle : {0.4, 2.8, -2.8}) {
    GapSide high = plate("high", {{-1, -0.1, 0.5}}, 2, 0.2, {10, 2});
    const Mat3d R = Mat3d::identity() + rotation_increment({{0, 0, angle}});
    for_each_point(high, [&](const Vec3d& X) { return R * X; });
    const TriangleMesh sheet = gap_sheet(low, high, 0.1);
    EXPECT_LT(properties_of_area(sheet).measure, 1.2);
    EXPECT_GT(properties_of_area(sheet).measure, 1);
  }
}

TEST(GapSheet, ColumnsThatTouchArePoints) {
  const GapSide low = plate("low", {{0, 0, 0}}, 2, 0.2, {10, 2});
  GapSide wedge = low;
  wedge.body = "wedge";
  for_each_point(wedge, [](const Vec3d& X) { return X + Vec3d{{0, 0, 0.2 * X[0]}}; });
  const TriangleMesh sheet = gap_sheet(low, wedge, 0.1);
  EXPECT_NEAR(properties_of_area(sheet).measure, 0.5 * 2 * 0.4, 0.01);
  EXPECT_GT(least_height(sheet), 1e-6);
  std::set<int> used;
  for (const auto& t : sheet.triangles) used.insert(t.begin(), t.end());
  EXPECT_EQ(used.size(), sheet.points.size());
}

TEST(GapStrands, RunToTheNearestPoints) {
  const GapSide low = plate("low", {{0, 0, 0}}, 1, 1, {4, 4}), high = plate("high", {{-1, -1, 0.5}}, 3, 3, {5, 5});
  const GapStrands strands = gap_strands(low, high, 0);
  EXPECT_EQ(strands.points.size(), 25u * 9u);
  EXPECT_EQ(strands.segments.size(), 25u * 8u);
  for (const auto& [i, j] : strands.segments) {
    const Vec3d d = strands.points[static_cast<std::size_t>(j)] - strands.points[static_cast<std::size_t>(i)];
    EXPECT_LT(norm(d - Vec3d{{0, 0, 0.0625}}), 1e-14);
  }
}

TEST(GapStrands, KeepTheirSpacing) {
  const GapSide low = plate("low", {{0, 0, 0}}, 1, 1, {4, 4}), high = plate("high", {{-1, -1, 0.5}}, 3, 3, {5, 5});
  EXPECT_EQ(gap_strands(low, high, 0.25).segments.size(), 25u * 8u);
  EXPECT_EQ(gap_strands(low, high, 0.5).segments.size(), 9u * 8u);
  EXPECT_EQ(gap_strands(low, high, 10).segments.size(), 8u);
  EXPECT_EQ(gap_strands(low, high, 1e-300).segments.size(), 25u * 8u);
  const GapStrands some = gap_strands(low, high, 0.3);
  for (std::size_t i = 0; i < some.points.size(); i += 9)
    for (std::size_t j = 0; j < i; j += 9) EXPECT_GE(norm(some.points[i] - some.points[j]), 0.3);
}

TEST(GapStrands, LeaveOutWhatTouches) {
  const GapSide low = plate("low", {{0, 0, 0}}, 1, 1, {4, 4});
  GapSide wedge = low;
  for_each_point(wedge, [](const Vec3d& X) { return X + Vec3d{{0, 0, 0.2 * X[0]}}; });
  EXPECT_EQ(gap_strands(wedge, low, 0).segments.size(), 20u * 8u);
}

}  // namespace
}  // namespace fascia::gap_lines_test
