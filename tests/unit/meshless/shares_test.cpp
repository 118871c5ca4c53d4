#include "core/base/errors.hpp"
#include "meshless/scattered/scatter_parts.hpp"
#include "tests/unit/meshless/matter_samples.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fascia::shares_test {
namespace {

using namespace test;

TEST(Shares, AreOfEighthsOfVoxels) {
  const SolidDomain box = box_domain({{0, 0, 0}}, {{3, 2, 2}});
  Matter coarse, fine;
  add_solid(coarse, box, 0.25, PieceUse::points);
  add_solid(fine, box, 0.125);
  fine.whole_voxels = 0;  // are not cut again
  const auto points = poisson_disk(coarse, 0.75, 1, false);
  ASSERT_EQ(points.size(), 28U);
  const std::vector<Share> shares = voronoi_shares(coarse, points), wanted = voronoi_shares(fine, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(shares[i].volume, wanted[i].volume, 1e-13);
    EXPECT_LT(norm(shares[i].centroid - wanted[i].centroid), 1e-13);
  }

  Matter curved;
  const SolidDomain ellipsoid = ellipsoid_domain({{5, 3, 2}}, 16);
  add_solid(curved, ellipsoid, 0.3, PieceUse::points);
  EXPECT_GT(curved.whole_voxels, 1000U);
  double cut = 0, parts = 0;
  for (std::size_t p = curved.whole_voxels; p < curved.voxels.size(); ++p) cut += curved.voxels.volume[p];
  for (const double v : curved.surface_parts.volume) parts += v;
  EXPECT_NEAR(parts / cut, 1, 1e-12);
  for (const Vec3d& x : curved.surface_parts.x) EXPECT_TRUE(ellipsoid.contains(x));
  EXPECT_NEAR(volume_of(voronoi_shares(curved, poisson_disk(curved, 1, 1, false))) / ellipsoid.volume, 1, 1e-12);
}

TEST(Shares, KeepOppositeWallsApart) {
  Matter m;
  add_sheet(m, sheet_of(box_surface({{0, 0, 0}}, {{6, 6, 0.1}}, 6, 6, 1), 0.02), 1 / 6.0);
  const auto points = poisson_disk(m, 1, 1, false);
  const OwnerSearch search(m, points);
  for (const MatterPiece& p : m.pieces) {
    if (!(p.volume > 0)) continue;
    EXPECT_GE(dot(p.axes.column(2), points[at(search.owner(p))].axes.column(2)), 0.25);
  }
}

TEST(Shares, TakePositionsOfAUser) {
  Matter m = cube(2, 0.1);
  const std::vector<Vec3d> given{{{0.5, 1, 1}}, {{1.5, 1, 1}}, {{9, 9, 9}}};
  const std::vector<SamplePlace> places = places_at(m, given);
  const std::vector<Share> shares = voronoi_shares(m, places);
  EXPECT_NEAR(shares[0].volume, 4, 1e-11);
  EXPECT_LT(norm(shares[0].centroid - given[0]), 1e-11);
  EXPECT_NEAR(shares[1].volume, 4, 1e-11);
  EXPECT_EQ(shares[2].volume, 0);
  EXPECT_EQ(shares[2].centroid, given[2]);

  add_line(m, polyline({{{2, 1, 1}}, {{5, 1, 1}}}, 0.1), 0.1);
  try {
    voronoi_shares(m, places);
    ADD_FAILURE() << "a line without points was accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("line part"), std::string::npos);
  }
  EXPECT_EQ(places_at(m, std::vector<Vec3d>{{{4, 1.1, 1}}})[0].dimension, 1);
}

}  // namespace
}  // namespace fascia::shares_test
