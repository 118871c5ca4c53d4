// The space between two surfaces: volumes, closedness, what lies inside.
#include "core/base/errors.hpp"
#include "core/geometry/inside.hpp"
#include "coupling/rigid_body.hpp"
#include "tests/unit/coupling/gap_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::gap_volume_test {
namespace {

using namespace test;

void expect_sound(const GapVolume& gap) {
  EXPECT_TRUE(is_closed(gap.surface));
  EXPECT_GT(gap.volume, 0);
  EXPECT_NEAR(properties_of_volume(gap.surface).measure, gap.volume, 1e-12 * gap.volume);
  EXPECT_GT(least_height(gap.surface), 1e-9);
}

TEST(GapVolume, BetweenParallelPlatesIsAreaTimesDistance) {
  const GapSide low = plate("low", {{0, 0, 0}}, 2, 1, {5, 3}), high = plate("high", {{0, 0, 0.25}}, 2, 1, {4, 7});
  for (const auto& [a, b] : {std::pair(low, high), std::pair(high, low)}) {
    const GapVolume gap = gap_volume(a, b);
    expect_sound(gap);
    EXPECT_NEAR(gap.volume, 0.5, 1e-14);
    EXPECT_DOUBLE_EQ(gap.smallest, 0.25);
    EXPECT_DOUBLE_EQ(gap.largest, 0.25);
    EXPECT_EQ(gap.touching, 0);
    const InsideTest inside(gap.surface);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> u(-0.1, 1.1);
    for (int k = 0; k < 1000; ++k) {
      const Vec3d x{{2 * u(random), u(random), 0.25 * u(random)}};
      const bool expected = x[0] > 0 && x[0] < 2 && x[1] > 0 && x[1] < 1 && x[2] > 0 && x[2] < 0.25;
      EXPECT_EQ(inside.winding_number(x), expected ? 1 : 0);
    }
  }
}

/// Over the part that lies beyond the other plate the space narrows to its edge: half the volume there.
TEST(GapVolume, BeyondTheOtherSideNarrowsToItsEdge) {
  for (const std::array<int, 2>& cells : {std::array{8, 4}, std::array{7, 3}}) {
    const GapSide low = plate("low", {{0, 0, 0}}, 2, 1, cells), high = plate("high", {{0.5, 0, 0.5}}, 2, 1, {6, 5});
    const GapVolume gap = gap_volume(low, high);
    expect_sound(gap);
    std::printf("volume %.6f of 0.875, %zu triangles\n", gap.volume, gap.surface.triangles.size());
    EXPECT_NEAR(gap.volume, 1.5 * 0.5 + 0.5 * 0.5 * 0.5, cells[0] == 8 ? 1e-12 : 0.01);
    EXPECT_DOUBLE_EQ(gap.smallest, 0.5);
    EXPECT_NEAR(gap.largest, std::sqrt(0.5), 1e-14);
  }
}

/// Meshes that fit nowhere, beyond each other at a corner.
TEST(GapVolume, ShiftedBothWays) {
  const GapSide low = plate("low", {{0, 0, 0}}, 2, 1, {7, 5}), high = plate("high", {{0.63, 0.27, 0.4}}, 2, 1, {5, 8});
  const GapVolume gap = gap_volume(low, high), other = gap_volume(high, low);
  expect_sound(gap);
  expect_sound(other);
  EXPECT_NEAR(gap.volume, other.volume, 0.01 * gap.volume);
}

GapSide ball(const std::string& body, double z, int n, double cap) {
  return closed_side(body, ellipsoid_surface({{0, 0, z}}, {{1, 1, 1}}, n), [=](const Vec3d& X) {
    return X[0] * X[0] + X[1] * X[1] < cap * cap && (z > 0 ? X[2] < z : X[2] > z);
  });
}

TEST(GapVolume, BetweenTwoBallsStaysOutsideBoth) {
  const GapSide low = ball("low", 0, 24, 0.6), high = ball("high", 2.2, 16, 0.8);
  const GapVolume gap = gap_volume(low, high);
  expect_sound(gap);
  EXPECT_NEAR(gap.smallest, 0.2, 1e-12);
  const InsideTest inside(gap.surface), in_low(low.whole), in_high(high.whole);
  const Bounds bounds = bounds_of(gap.surface.points);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  int found = 0;
  double deepest = 0;
  for (int k = 0; k < 20000; ++k) {
    Vec3d x = bounds.low;
    for (int c = 0; c < 3; ++c) x[c] += bounds.extent()[c] * u(random);
    if (inside.winding_number(x) == 0) continue;
    EXPECT_EQ(inside.winding_number(x), 1);
    ++found;
    EXPECT_FALSE(in_low.contains(x) && in_low.distance(x) > 1e-12);
    if (in_high.contains(x)) deepest = std::max(deepest, in_high.distance(x));
  }
  // Facets of the first side's grain over the second ball: edges of 0.1 lie h²/8 = 0.001 below the sphere.
  std::printf("%d points, deepest %.1e\n", found, deepest);
  EXPECT_GT(found, 1000);
  EXPECT_LT(deepest, 2e-3);
  const double sampled = bounds.extent()[0] * bounds.extent()[1] * bounds.extent()[2] * found / 20000;
  EXPECT_NEAR(gap.volume, sampled, 0.05 * sampled);
}

/// A wedge that closes along a line, two plates that lie on each other in part.
TEST(GapVolume, ThinsOutWhereTheSidesTouch) {
  const GapSide low = plate("low", {{0, 0, 0}}, 2, 1, {8, 4});
  GapSide wedge = plate("wedge", {{0, 0, 0}}, 2, 1, {5, 3});
  for_each_point(wedge, [](const Vec3d& X) { return X + Vec3d{{0, 0, 0.1 * X[0]}}; });
  const GapVolume narrow = gap_volume(wedge, low);
  expect_sound(narrow);
  EXPECT_NEAR(narrow.volume, 0.5 * 2 * 0.2, 1e-14);
  EXPECT_EQ(narrow.touching, 0);
  EXPECT_EQ(narrow.smallest, 0);

  GapSide bent = plate("bent", {{0, 0, 0}}, 2, 1, {8, 3});
  for_each_point(bent, [](const Vec3d& X) { return X + Vec3d{{0, 0, 0.1 * std::max(0.0, X[0] - 0.5)}}; });
  const GapVolume part = gap_volume(bent, low);
  expect_sound(part);
  EXPECT_NEAR(part.volume, 0.5 * 1.5 * 0.15, 1e-13);
  EXPECT_NEAR(part.touching, 0.5 / (0.5 + std::hypot(1.5, 0.15)), 1e-12);
}

/// A plate that touches along a line in its middle and in single triangles' edges: still a manifold.
TEST(GapVolume, TouchingInTheMiddleStaysClosed) {
  const GapSide low = plate("low", {{0, 0, 0}}, 2, 1, {8, 4});
  for (const std::array<int, 2>& cells : {std::array{8, 3}, std::array{8, 1}, std::array{2, 1}})
    for (const Diagonal diagonal : {Diagonal::right, Diagonal::alternating}) {
      GapSide roof = plate("roof", {{0, 0, 0}}, 2, 1, cells, diagonal);
      for_each_point(roof, [](const Vec3d& X) { return X + Vec3d{{0, 0, 0.1 * std::abs(X[0] - 1)}}; });
      const GapVolume gap = gap_volume(roof, low);
      expect_sound(gap);
      EXPECT_NEAR(gap.volume, 0.1, 1e-13);
    }
  GapSide ridge = plate("ridge", {{0, 0, 0}}, 1, 1, {1, 1}, Diagonal::right);
  for_each_point(ridge, [](const Vec3d& X) { return X + Vec3d{{0, 0, 0.1 * std::abs(X[0] - X[1])}}; });
  const GapVolume gap = gap_volume(ridge, low);
  expect_sound(gap);
  EXPECT_NEAR(gap.volume, 2 * 0.5 * 0.1 / 3, 1e-14);
}

/// A dome over a plate, from either side, against the integral of its height over the facets.
TEST(GapVolume, CurvedSideIsFollowed) {
  double before = 0;
  for (const int n : {6, 12, 24}) {
    GapSide dome = plate("dome", {{-1, -1, 0}}, 2, 2, {n, n});
    for_each_point(dome, [](const Vec3d& X) {
      return Vec3d{{X[0], X[1], 0.5 + 0.3 * (1 - X[0] * X[0]) * (1 - X[1] * X[1])}};
    });
    const double exact = 4 * 0.5 + 0.3 * 16.0 / 9;
    const GapVolume above = gap_volume(plate("plate", {{-1, -1, 0}}, 2, 2, {1, 1}), dome);
    const GapVolume below = gap_volume(dome, plate("plate", {{-1, -1, 0}}, 2, 2, {1, 1}));
    expect_sound(above);
    expect_sound(below);
    std::printf("n = %2d: from the plate %.2e, from the dome %.2e\n", n, above.volume / exact - 1,
                below.volume / exact - 1);
    EXPECT_LT(std::abs(below.volume / exact - 1), 0.5 / (n * n));
    if (before > 0) {
      EXPECT_LT(std::abs(above.volume / exact - 1), before / 3);
    }
    before = std::abs(above.volume / exact - 1);
  }
  EXPECT_LT(before, 3e-3);
}

TEST(GapVolume, PlaceAndNumberingDoNotMatter) {
  const Mat3d R = Mat3d::identity() + rotation_increment({{0.7, -1.1, 2}});
  const std::vector<std::pair<GapSide, GapSide>> pairs = {
      {ball("low", 0, 24, 0.6), ball("high", 2.2, 16, 0.8)},
      {plate("low", {{0, 0, 0}}, 2, 1, {7, 5}), plate("high", {{0.63, 0.27, 0.4}}, 2, 1, {5, 8})}};
  for (const auto& [a, b] : pairs) {
    const double volume = gap_volume(a, b).volume;
    GapSide c = a, d = b;
    for (GapSide* side : {&c, &d}) for_each_point(*side, [&](const Vec3d& X) { return R * X + Vec3d{{3, 1, -2}}; });
    const GapVolume turned = gap_volume(c, d);
    expect_sound(turned);
    EXPECT_NEAR(turned.volume, volume, 1e-12 * volume);
    for (const unsigned seed : {1U, 2U}) {
      const GapVolume other = gap_volume(shuffled(a, seed), shuffled(b, seed + 10));
      expect_sound(other);
      EXPECT_NEAR(other.volume, volume, 1e-12 * volume);
    }
  }
}

/// Bumpy sides at random, which touch here and there and have holes and pinched corners, or reach beyond each other.
TEST(GapVolume, RandomSidesAreSound) {
  int refused = 0, with_flat = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(0, 1);
    const auto cells = [&] { return 1 + static_cast<int>(random() % 8); };
    GapSide low = plate("low", {{0, 0, 0}}, 2, 1, {cells(), cells()}, static_cast<Diagonal>(seed % 3));
    const bool touch = seed % 2 == 0;
    const double shift = touch ? 0 : 0.5;
    GapSide high = plate("high", {{shift * u(random), shift * u(random), 0}}, 2, 1, {cells(), cells()});
    const double gap = touch ? 0.2 * u(random) - 0.1 : 0.1 + 0.2 * u(random), bumps = (touch ? 0.3 : 0.05) * u(random);
    for_each_point(high, [&](const Vec3d& X) {
      return Vec3d{{X[0], X[1], std::max(0.0, gap + bumps * std::sin(5 * X[0] + seed) * std::sin(4 * X[1]))}};
    });
    std::erase_if(low.faces.triangles, [&](const std::array<int, 3>&) { return touch && u(random) < 0.1; });
    if (low.faces.triangles.empty()) continue;
    for (const auto& [a, b] : {std::pair(low, high), std::pair(high, low)}) {
      GapVolume space;
      try {
        space = gap_volume(a, b);
      } catch (const InputError& e) {
        EXPECT_TRUE(std::string(e.what()).find("touch everywhere") != std::string::npos ||
                    std::string(e.what()).find("face") != std::string::npos)
            << e.what();
        ++refused;
        continue;
      }
      EXPECT_TRUE(is_closed(space.surface)) << seed << ' ' << a.body;
      EXPECT_GT(space.volume, 0);
      with_flat += least_height(space.surface) < 1e-9 ? 1 : 0;
      const InsideTest inside(space.surface);
      int wrong = 0, found = 0;
      for (int k = 0; k < 200; ++k) {
        const int winding = inside.winding_number({{2.5 * u(random), 1.5 * u(random), 0.6 * u(random)}});
        found += winding == 1 ? 1 : 0;
        wrong += winding == 0 || winding == 1 ? 0 : 1;
      }
      EXPECT_LE(wrong, found / 20 + 1) << seed << ' ' << a.body;
    }
  }
  // Flat triangles stay where two points of the other side's edge coincide that no edge joins.
  std::printf("%d of 600 refused, %d with flat triangles\n", refused, with_flat);
  EXPECT_LE(refused, 60);
  EXPECT_LE(with_flat, 12);
}

/// Two separate parts of one side.
TEST(GapVolume, PartsOfASide) {
  GapSide low = plate("low", {{0, 0, 0}}, 1, 1, {3, 3});
  const GapSide more = plate("low", {{2, 0, 0}}, 1, 1, {2, 2});
  const int first = static_cast<int>(low.faces.points.size());
  low.faces.points.insert(low.faces.points.end(), more.faces.points.begin(), more.faces.points.end());
  for (const auto& t : more.faces.triangles) low.faces.triangles.push_back({t[1] + first, t[0] + first, t[2] + first});
  low.whole = low.faces;
  const GapVolume gap = gap_volume(low, plate("high", {{-1, -1, 0.5}}, 5, 3, {4, 4}));
  expect_sound(gap);
  EXPECT_NEAR(gap.volume, 1, 1e-13);
}

}  // namespace
}  // namespace fascia::gap_volume_test
