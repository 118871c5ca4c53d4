#include "meshless/scattered/scatter.hpp"

#include "core/base/errors.hpp"
#include "core/geometry/triangle_tree.hpp"
#include "meshless/scattered/neighbours.hpp"
#include "meshless/scattered/scatter_parts.hpp"
#include "tests/unit/meshless/matter_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fascia::scatter_test {
namespace {

using namespace test;

double spacing_for_count(const Matter& matter, int count, int seed, bool with_features) {
  return fascia::spacing_for_count(matter, count, seed, with_features, one_thread());
}

Matter square(double size, double piece) {
  Matter m;
  add_sheet(m, rectangle({}, {{size, 0, 0}}, {{0, size, 0}}, 0.1), piece);
  return m;
}

std::vector<Vec3d> positions(const std::vector<SamplePlace>& places) {
  std::vector<Vec3d> x;
  x.reserve(places.size());
  for (const SamplePlace& p : places) x.push_back(p.x);
  return x;
}

struct Distances {
  double least = INFINITY, mean = 0;
};

/// To the nearest other sample.
Distances nearest_distances(const std::vector<SamplePlace>& places) {
  const std::vector<Vec3d> x = positions(places);
  const FrameSearch search(x);
  Distances d;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::vector<int> two = search.nearest(x[i], 2);
    const double distance = norm(x[at(two[0] == static_cast<int>(i) ? two[1] : two[0])] - x[i]);
    d.least = std::min(d.least, distance);
    d.mean += distance / static_cast<double>(x.size());
  }
  return d;
}

std::array<int, 4> feature_counts(const std::vector<SamplePlace>& places) {
  std::array<int, 4> count{};
  for (const SamplePlace& p : places) ++count[at(p.feature)];
  return count;
}

TEST(PoissonDisk, RepeatsForASeedAndDiffersForAnother) {
  const Matter m = cube(5, 0.2);
  for (const bool features : {true, false}) {
    const auto first = positions(poisson_disk(m, 1, 1, features));
    EXPECT_EQ(first, positions(poisson_disk(m, 1, 1, features)));
    EXPECT_NE(first, positions(poisson_disk(m, 1, 2, features)));
  }
}

/// Places, shares and voxels of a curved solid with a fin are the same bit for bit, whatever the number of threads.
TEST(PoissonDisk, DoesNotDependOnThreads) {
  struct Sampled {
    std::vector<double> numbers;

    void add(const Vec3d& x) { numbers.insert(numbers.end(), x.v, x.v + 3); }
  };
  std::vector<Sampled> of;
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    Sampled& all = of.emplace_back();
    for (const bool features : {true, false}) {
      Matter m;
      fascia::add_solid(m, ellipsoid_domain({{5, 3, 2}}, 16), 0.2, features ? PieceUse::frames : PieceUse::points,
                        pool);
      add_sheet(m, rectangle({{-3, 0, 1.8}}, {{6, 0, 0}}, {{0, 0, 4}}, 0.1), 0.2);
      for (const Vec3d& x : m.voxels.x) all.add(x);
      for (const Vec3d& x : m.surface_parts.x) all.add(x);
      const double spacing = fascia::spacing_for_count(m, 300, 2, features, pool);
      const std::vector<SamplePlace> places = fascia::poisson_disk(m, spacing, 2, features, pool);
      for (const SamplePlace& p : places) all.add(p.x);
      if (features) continue;
      for (const Share& s : fascia::voronoi_shares(m, places, pool)) {
        all.add(s.centroid);
        all.numbers.push_back(s.volume);
      }
    }
  }
  EXPECT_GT(of[0].numbers.size(), 20000U);
  EXPECT_EQ(of[1].numbers, of[0].numbers);
  EXPECT_EQ(of[2].numbers, of[0].numbers);
}

/// Darts that threads sort out beforehand, in the order of their pieces, are those that meet none when they are thrown
/// one after the other and held against all samples.
TEST(Darts, AreTakenAsIfThrownInTurn) {
  constexpr double least = 0.45;
  for (const bool solid : {true, false}) {
    const Matter m = solid ? cube(3, 0.1) : square(6, 0.05);
    const PieceList pieces = solid
                                 ? PieceList::of_solids(m)
                                 : PieceList::of_thin(m, select_pieces(m, [](const auto& p) { return p.volume > 0; }));
    ThreadPool pool(3);
    std::mt19937 random(7);
    const Darts darts = random_darts(pieces, random, pool);
    std::vector<Vec3d> wanted, taken;
    const auto meets_one = [&](const Vec3d& x) {
      return std::any_of(wanted.begin(), wanted.end(),
                         [&](const Vec3d& y) { return squared_norm(y - x) <= least * least * (1 + kTie); });
    };
    for (const int piece : darts.order.span())
      if (!meets_one(darts.x[at(piece)])) wanted.push_back(darts.x[at(piece)]);
    PointGrid grid(least * (1 + kTie));
    throw_darts(
        m, pieces, darts, pool, grid, least, [](std::size_t, int, double) { return true; },
        [&](const SamplePlace& place) {
          taken.push_back(place.x);
          grid.insert(place.x);
          return true;
        });
    EXPECT_GT(darts.size(), 10000U);
    EXPECT_GT(wanted.size(), 80U);
    EXPECT_EQ(taken, wanted);
  }
}

/// A grid of the same spacing has 1331 frames: 8 corners, 108 on edges, 486 on faces, 729 inside.
TEST(PoissonDisk, SpreadsFramesInACubeLikeAGrid) {
  for (const int seed : {1, 2, 3}) {
    const auto frames = poisson_disk(cube(10, 1 / 6.0), 1, seed, true);
    const std::array<int, 4> count = feature_counts(frames);
    EXPECT_EQ(count[0], 8);
    EXPECT_EQ(count[1], 108);
    EXPECT_NEAR(count[2], 486, 0.1 * 486);
    EXPECT_NEAR(count[3], 729, 0.08 * 729);
    const Distances d = nearest_distances(frames);
    EXPECT_GT(d.least, 0.65);
    EXPECT_NEAR(d.mean, 0.93, 0.04);
  }
}

TEST(PoissonDisk, PutsFramesExactlyOnTheirFeatures) {
  const auto frames = poisson_disk(cube(10, 0.2), 1, 1, true);
  for (const SamplePlace& f : frames) {
    int on_planes = 0;
    for (int a = 0; a < 3; ++a) {
      EXPECT_GE(f.x[a], -1e-14);
      EXPECT_LE(f.x[a], 10 + 1e-14);
      if (std::abs(f.x[a]) < 1e-13 || std::abs(f.x[a] - 10) < 1e-13) ++on_planes;
      if (f.feature == 1) {
        EXPECT_NEAR(f.x[a], std::round(f.x[a]), 1e-13);
      }
    }
    EXPECT_EQ(on_planes, 3 - f.feature);
  }
}

TEST(PoissonDisk, SpreadsFramesAndPointsOnARectangle) {
  const Matter m = square(10, 1 / 6.0);
  const auto frames = poisson_disk(m, 1, 1, true);
  const std::array<int, 4> count = feature_counts(frames);
  EXPECT_EQ(count[0], 4);
  EXPECT_EQ(count[1], 36);
  EXPECT_NEAR(count[2], 81, 12);
  EXPECT_GT(nearest_distances(frames).least, 0.7);

  const auto points = poisson_disk(m, 1, 1, false);
  EXPECT_EQ(points.size(), 100U);
  EXPECT_GT(nearest_distances(points).least, 0.5);
  for (const SamplePlace& p : points) EXPECT_EQ(p.x[2], 0);
}

TEST(PoissonDisk, GivesPointsEvenShares) {
  const Matter m = cube(10, 1 / 6.0);
  const auto points = poisson_disk(m, 1, 1, false);
  EXPECT_EQ(points.size(), 1000U);
  const std::vector<Share> shares = voronoi_shares(m, points);
  EXPECT_NEAR(volume_of(shares) / m.volume, 1, 1e-13);
  double off = 0, spread = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    off += squared_norm(shares[i].centroid - points[i].x) / static_cast<double>(points.size());
    spread += std::pow(shares[i].volume - 1, 2) / static_cast<double>(points.size());
  }
  EXPECT_LT(std::sqrt(off), 0.04);
  EXPECT_LT(std::sqrt(spread), 0.2);
}

/// Were points thrown at the distance that a bulky body of this volume takes, the first darts would all do.
TEST(PoissonDisk, SpreadsPointsInANeedle) {
  constexpr int count = 40;
  const double spacing = std::cbrt(0.005 * 0.005 / count);
  for (const int seed : {1, 2, 3, 4}) {
    Matter needle;
    add_solid(needle, box_domain({{0, 0, 0}}, {{1, 0.005, 0.005}}), spacing / 6, PieceUse::points);
    std::vector<double> along;
    for (const SamplePlace& p : poisson_disk(needle, spacing, seed, false)) along.push_back(p.x[0]);
    ASSERT_EQ(along.size(), at(count));
    std::sort(along.begin(), along.end());
    double widest = 0;
    for (int k = 1; k < count; ++k) widest = std::max(widest, along[at(k)] - along[at(k - 1)]);
    EXPECT_LT(widest * count, 1.45) << "seed " << seed;
  }
}

/// The voxels of a box, cut for shares, are those of half the width; at a curved surface the parts add up to the
/// voxels.
TEST(PoissonDisk, KeepsPointsOnACurvedSheetAndInACurvedSolid) {
  const Vec3d radii{{5, 3, 2}};
  Matter skin, solid;
  const SolidDomain domain = ellipsoid_domain(radii, 20);
  add_sheet(skin, sheet_of(domain.surface, 0.1), 1 / 6.0);
  add_solid(solid, domain, 1 / 6.0);
  const TriangleTree tree(domain.surface);
  for (const bool features : {true, false}) {
    for (const SamplePlace& p : poisson_disk(skin, 1, 1, features)) EXPECT_LT(tree.distance(p.x), 1e-13);
    for (const SamplePlace& p : poisson_disk(solid, 1, 1, features)) {
      if (p.feature == 2) {
        EXPECT_LT(tree.distance(p.x), 1e-13);
      } else {
        EXPECT_TRUE(domain.contains(p.x));
      }
    }
  }
}

TEST(PoissonDisk, DividesLinesEvenly) {
  Matter m;
  add_line(m, polyline({{{0, 0, 0}}, {{3, 4, 0}}, {{6, 8, 0}}}, 0.1), 0.13);
  const auto points = poisson_disk(m, 1, 5, false);
  ASSERT_EQ(points.size(), 10U);
  const std::vector<Share> shares = voronoi_shares(m, points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_LT(norm(points[k].x - Vec3d{{0.6, 0.8, 0}} * (static_cast<double>(k) + 0.5)), 1e-13);
    EXPECT_NEAR(shares[k].volume / (0.1 * m.volume), 1, 1e-12);
    EXPECT_LT(norm(shares[k].centroid - points[k].x), 1e-12);
  }
  const auto frames = poisson_disk(m, 1, 5, true);
  EXPECT_EQ(feature_counts(frames), (std::array<int, 4>{2, 9, 0, 0}));
  EXPECT_NEAR(nearest_distances(frames).least, 1, 1e-13);
}

TEST(PoissonDisk, TakesAtLeastThreeFramesOnARing) {
  LinePart ring;
  ring.radius = 0.01;
  for (int i = 0; i < 60; ++i) {
    ring.points.push_back({{std::cos(i * std::numbers::pi / 30), std::sin(i * std::numbers::pi / 30), 0}});
    ring.segments.push_back({i, (i + 1) % 60});
  }
  Matter m;
  add_line(m, ring, 0.1);
  EXPECT_EQ(poisson_disk(m, 4, 1, true).size(), 3U);
  EXPECT_EQ(poisson_disk(m, 0.5, 1, true).size(), 13U);
}

/// Powers of two scale without rounding.
TEST(PoissonDisk, DoesNotDependOnTheUnit) {
  const double scale = 0x1p-10;
  for (const bool features : {true, false}) {
    const auto large = poisson_disk(cube(5, 0.2), 1, 1, features);
    const auto small = poisson_disk(cube(5 * scale, 0.2 * scale), scale, 1, features);
    ASSERT_EQ(large.size(), small.size());
    for (std::size_t i = 0; i < large.size(); ++i) EXPECT_LT(norm(small[i].x * (1 / scale) - large[i].x), 1e-9);
  }
}

TEST(PoissonDisk, DropsCornersAndEdgesThatAreCloseTogether) {
  Matter m;
  add_solid(m, box_domain({{0, 0, 0}}, {{10, 10, 0.1}}), 0.1);
  const auto frames = poisson_disk(m, 1, 1, true);
  EXPECT_EQ(feature_counts(frames)[0], 4);
  EXPECT_GE(nearest_distances(frames).least, 0.4);
}

TEST(PoissonDisk, RefusesASpacingThatIsNotPositive) {
  const Matter m = cube(1, 0.2);
  EXPECT_THROW(poisson_disk(m, 0, 1, true), InputError);
  EXPECT_THROW(poisson_disk(m, NAN, 1, true), InputError);
  EXPECT_THROW(poisson_disk({}, 1, 1, true), InputError);
  EXPECT_THROW(spacing_for_count(m, 0, 1, true), InputError);
}

/// Frames within three percent; points, of which places may be left out, as many as wanted.
TEST(SpacingForCount, IsMet) {
  Matter beam;
  add_solid(beam, box_domain({{0, -0.5, -0.5}}, {{16, 0.5, 0.5}}), 0.05);
  const Matter sheet = square(10, 0.05);
  for (const Matter* m : std::initializer_list<const Matter*>{&beam, &sheet})
    for (const bool features : {true, false})
      for (const int count : {100, 300, 1000}) {
        const double spacing = spacing_for_count(*m, count, 1, features);
        const auto found = static_cast<double>(poisson_disk(*m, spacing, 1, features).size());
        EXPECT_NEAR(found, count, features ? 0.03 * count : 0) << features;
      }
  EXPECT_EQ(poisson_disk(beam, spacing_for_count(beam, 1, 1, true), 1, true).size(), 1U);
  EXPECT_EQ(poisson_disk(beam, spacing_for_count(beam, 1, 1, false), 1, false).size(), 1U);
}

/// A block with a sheet on its top face, larger than it, and a line that leaves the sheet.

TEST(Mixture, SharesFramesButNotPoints) {
  Matter m;
  add_solid(m, box_domain({{0, 0, 0}}, {{4, 4, 2}}), 1 / 6.0);
  add_sheet(m, rectangle({{-2, -2, 2}}, {{8, 0, 0}}, {{0, 8, 0}}, 0.1), 1 / 6.0);
  add_line(m, polyline({{{6, 2, 2}}, {{12, 2, 2}}}, 0.1), 1 / 6.0);
  EXPECT_NEAR(volume_sum(m) / (32 + 6.4 + 6 * std::numbers::pi * 0.01), 1, 1e-12);

  const auto frames = poisson_disk(m, 1, 1, true);
  EXPECT_GE(nearest_distances(frames).least, 0.4);
  int on_top = 0;
  for (const SamplePlace& f : frames)
    if (f.x[2] == 2 && f.x[0] < 6 + 1e-12) ++on_top;
  EXPECT_NEAR(on_top, 81, 14);

  const auto points = poisson_disk(m, 1, 1, false);
  const std::vector<Share> shares = voronoi_shares(m, points);
  EXPECT_NEAR(volume_of(shares) / m.volume, 1, 1e-13);
  std::array<double, 4> volume{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_GT(shares[i].volume, 0);
    volume[at(points[i].dimension)] += shares[i].volume;
  }
  EXPECT_NEAR(volume[3], 32, 1e-11);
  EXPECT_NEAR(volume[2], 6.4, 1e-11);
}

}  // namespace
}  // namespace fascia::scatter_test
