#include "meshless/matter.hpp"

#include "core/base/errors.hpp"
#include "tests/unit/meshless/matter_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::matter_test {
namespace {

using namespace test;

TEST(Matter, FillsABoxWithEqualVoxels) {
  Matter m;
  add_solid(m, box_domain({{-1, 0, 0}}, {{1, 1, 0.5}}), 0.1);
  EXPECT_EQ(count_feature(m, 3), 20 * 10 * 5);
  EXPECT_NEAR(volume_sum(m), 1, 1e-13);
  EXPECT_EQ(m.volume, 1);
  Vec3d moment{};
  for (std::size_t p = 0; p < m.voxels.size(); ++p) moment += m.voxels.x[p] * m.voxels.volume[p];
  EXPECT_LT(norm(moment - Vec3d{{0, 0.5, 0.25}}), 1e-13);
}

TEST(Matter, FindsCornersEdgesAndFacesOfABox) {
  Matter m;
  add_solid(m, box_domain({{0, 0, 0}}, {{3, 2, 1}}), 0.25);
  EXPECT_EQ(count_feature(m, 0), 8);
  ASSERT_EQ(m.chains.size(), 12U);
  for (const FeatureChain& c : m.chains) EXPECT_FALSE(c.closed);
  double area = 0;
  for (const MatterPiece& p : m.pieces) {
    if (p.feature != 2) continue;
    area += p.measure;
    EXPECT_EQ(p.volume, 0);
    double off = 1;
    for (int a = 0; a < 3; ++a) off = std::min({off, std::abs(p.x[a]), std::abs(p.x[a] - (3 - a))});
    EXPECT_LT(off, 1e-14);
  }
  EXPECT_NEAR(area, 22, 1e-12);
}

TEST(Matter, CutsVoxelsAtACurvedSurface) {
  const Vec3d radii{{2, 1.5, 1}};
  Matter m;
  const SolidDomain domain = ellipsoid_domain(radii, 32);
  add_solid(m, domain, 0.1);
  EXPECT_NEAR(volume_sum(m) / domain.volume, 1, 1e-12);
  Vec3d moment{}, second{};
  for (std::size_t p = 0; p < m.voxels.size(); ++p) {
    const Vec3d x = m.voxels.x[p];
    EXPECT_TRUE(domain.contains(x));
    moment += x * m.voxels.volume[p];
    for (int a = 0; a < 3; ++a) second[a] += x[a] * x[a] * m.voxels.volume[p];
  }
  EXPECT_LT(norm(moment), 2e-3 * m.volume);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(second[a] / (m.volume * radii[a] * radii[a] / 5), 1, 0.01);
  EXPECT_EQ(count_feature(m, 0), 0);
  EXPECT_TRUE(m.chains.empty());
}

TEST(Matter, CutsByLinesAsByPoints) {
  SolidDomain domain = ellipsoid_domain({{2, 1.5, 1}}, 12);
  Matter by_points, by_lines;
  add_solid(by_points, domain, 0.15);
  domain.contains_on_line = [test = std::make_shared<InsideTest>(domain.surface)](
                                double y, double z, std::span<const double> x, std::span<char> inside) {
    test->contains_on_line(y, z, x, inside);
  };
  add_solid(by_lines, domain, 0.15);
  EXPECT_EQ(by_lines.voxels.x, by_points.voxels.x);
  EXPECT_EQ(by_lines.voxels.volume, by_points.voxels.volume);
}

/// A wall across a cube of edge 2, off the middles of voxels.
SolidDomain wall_in_a_cube(double thickness) {
  SolidDomain d = box_domain({{0, 0, 0.98}}, {{2, 2, 0.98 + thickness}});
  d.contains = [low = d.min, high = d.max](const Vec3d& x) { return x[2] > low[2] && x[2] < high[2]; };
  d.min = {{0, 0, 0}};
  d.max = {{2, 2, 2}};
  return d;
}

/// A wall a third as thick as a voxel, in a layer of 100, off their centres: found through its surface.
TEST(Matter, FindsWallsThinnerThanAVoxel) {
  const SolidDomain d = wall_in_a_cube(0.07);
  Matter m;
  add_solid(m, d, 0.2);
  EXPECT_GE(count_feature(m, 3), 90);
  EXPECT_NEAR(volume_sum(m) / d.volume, 1, 1e-12);
}

/// For points, of which pieces are wide, a fifth.
TEST(Matter, FindsThinnerWallsForPoints) {
  const SolidDomain d = wall_in_a_cube(0.04);
  Matter m;
  add_solid(m, d, 0.2, PieceUse::points);
  EXPECT_GE(count_feature(m, 3), 90);
  EXPECT_EQ(m.whole_voxels, 0U);
  double parts = 0;
  for (const double v : m.surface_parts.volume) parts += v;
  EXPECT_NEAR(parts / d.volume, 1, 1e-12);
}

TEST(Matter, CutsASheetByTriangleThickness) {
  Matter m;
  add_sheet(m, angle_sheet(), 0.1);
  EXPECT_NEAR(volume_sum(m), 2 * 3 * 0.1 + 1 * 3 * 0.2, 1e-13);
  EXPECT_NEAR(m.volume, 1.2, 1e-14);
  EXPECT_EQ(count_feature(m, 0), 6);
  EXPECT_EQ(m.chains.size(), 7U);  // six open edges and the crease
  for (const MatterPiece& p : m.pieces) {
    if (p.feature != 2) continue;
    const bool upright = p.x[2] > 0;
    EXPECT_EQ(p.extent, upright ? 0.2 : 0.1);
    EXPECT_NEAR(norm(p.axes.column(2) - (upright ? Vec3d{{1, 0, 0}} : Vec3d{{0, 0, 1}})), 0, 1e-14);
  }
}

TEST(Matter, TakesBranchedEdgesForFeatures) {
  SheetPart s = angle_sheet();
  s.surface.points.push_back({{-1, 0, -0.1}});
  s.surface.triangles.push_back({3, 2, 6});
  s.thickness.push_back(0.1);
  Matter m;
  add_sheet(m, s, 0.2);
  EXPECT_EQ(m.chains.size(), 9U);
  EXPECT_EQ(count_feature(m, 0), 7);
}

TEST(Matter, GivesACurvedSheetSmoothAxes) {
  const Vec3d radii{{3, 2, 2}};
  Matter m;
  add_sheet(m, sheet_of(ellipsoid_surface({}, radii, 16), 0.1), 0.1);
  EXPECT_NEAR(volume_sum(m) / m.volume, 1, 1e-12);
  EXPECT_TRUE(m.chains.empty());
  double worst = 1;
  for (const MatterPiece& p : m.pieces) {
    EXPECT_LT(norm(transpose_times(p.axes, p.axes) - Mat3d::identity()), 1e-13);
    EXPECT_NEAR(determinant(p.axes), 1, 1e-13);
    const Vec3d exact{{p.x[0] / 9, p.x[1] / 4, p.x[2] / 4}};
    worst = std::min(worst, dot(normalized(exact), p.axes.column(2)));
  }
  EXPECT_GT(worst, std::cos(0.03));
}

TEST(Matter, CutsAPolylineAndFindsItsBends) {
  Matter m;
  add_line(m, polyline({{{0, 0, 0}}, {{3, 0, 0}}, {{6, 1, 0}}, {{6, 5, 0}}}, 0.1), 0.3);
  EXPECT_NEAR(volume_sum(m) / ((3 + std::sqrt(10.0) + 4) * std::numbers::pi * 0.01), 1, 1e-13);
  EXPECT_EQ(count_feature(m, 0), 3);  // the bend of 18° is none
  ASSERT_EQ(m.chains.size(), 2U);
  EXPECT_EQ(m.chains[0].points.size(), 3U);
  for (const MatterPiece& p : m.pieces) {
    EXPECT_LT(norm(transpose_times(p.axes, p.axes) - Mat3d::identity()), 1e-14);
    EXPECT_GT(determinant(p.axes), 0);
  }
}

TEST(Matter, KeepsARingWithoutCornersClosed) {
  LinePart ring;
  ring.radius = 0.01;
  for (int i = 0; i < 24; ++i) {
    ring.points.push_back({{std::cos(i * std::numbers::pi / 12), std::sin(i * std::numbers::pi / 12), 0}});
    ring.segments.push_back({i, (i + 1) % 24});
  }
  Matter m;
  add_line(m, ring, 0.1);
  ASSERT_EQ(m.chains.size(), 1U);
  EXPECT_TRUE(m.chains[0].closed);
  EXPECT_EQ(count_feature(m, 0), 0);
}

TEST(Matter, RefusesWhatCannotBeCut) {
  Matter m;
  const SolidDomain box = box_domain({{0, 0, 0}}, {{1, 1, 1}});
  EXPECT_THROW(add_solid(m, box, 0), InputError);
  EXPECT_THROW(add_solid(m, box, NAN), InputError);
  EXPECT_THROW(add_solid(m, box, 1e-300), InputError);
  try {
    add_solid(m, box, 1e-3);
    ADD_FAILURE() << "10^9 pieces were accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("use a larger spacing"), std::string::npos) << e.what();
  }
  EXPECT_THROW(add_sheet(m, rectangle({}, {{1, 0, 0}}, {{0, 1, 0}}, 0.1), 1e-5), InputError);
  EXPECT_THROW(add_line(m, polyline({{{0, 0, 0}}, {{1, 0, 0}}}, 0.1), 1e-9), InputError);
  SolidDomain empty = box;
  empty.contains = [](const Vec3d&) { return false; };
  EXPECT_THROW(add_solid(m, empty, 0.1), InputError);
  EXPECT_THROW(add_sheet(m, rectangle({}, {{1, 0, 0}}, {{2, 0, 0}}, 0.1), 0.1), InputError);
}

}  // namespace
}  // namespace fascia::matter_test
