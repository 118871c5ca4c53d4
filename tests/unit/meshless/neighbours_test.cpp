#include "meshless/scattered/neighbours.hpp"

#include "core/base/index.hpp"
#include "meshless/scattered/block_search.hpp"
#include "meshless/scattered/point_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace fascia::neighbours_test {
namespace {

std::vector<Vec3d> lattice(int n) {
  std::vector<Vec3d> points;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        points.push_back({{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}});
  return points;
}

std::vector<Vec3d> scattered(int count) {
  std::mt19937 random(7);
  std::vector<Vec3d> points(at(count));
  for (Vec3d& x : points)
    for (int a = 0; a < 3; ++a) x[a] = static_cast<double>(random()) * 0x1p-32;
  return points;
}

std::vector<int> sorted_by_distance(const std::vector<Vec3d>& points, const Vec3d& x) {
  std::vector<int> order;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) order.push_back(i);
  const auto squared = [&](int i) { return squared_norm(points[at(i)] - x); };
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return squared(i) < squared(j); });
  for (auto first = order.begin(), end = first; first != order.end(); first = end) {
    while (end != order.end() && squared(*end) <= squared(*first) * (1 + kTie)) ++end;
    std::sort(first, end);
  }
  return order;
}

/// Lattices have many equal distances: the lowest indices win, also at the last of k and at the very radius.
TEST(FrameSearch, AgreesWithComparingAll) {
  for (const auto& points : {lattice(7), scattered(300)}) {
    const FrameSearch search(points);
    std::vector<Vec3d> places = scattered(20);
    for (Vec3d& x : places) x = x * 6;
    places.insert(places.end(), {points[0], points[100], {{3, 3, 3}}, {{2.5, 2.5, 2.5}}, {{2.5, 3, 3}}, {{50, -9, 2}}});
    for (const Vec3d& x : places) {
      const std::vector<int> all = sorted_by_distance(points, x);
      for (const int k : {1, 2, 5, 8, 20, 1000}) {
        const auto count = static_cast<std::ptrdiff_t>(std::min(at(k), points.size()));
        EXPECT_EQ(search.nearest(x, k), std::vector<int>(all.begin(), all.begin() + count));
      }
      for (const double radius : {0.0, 0.3, 1.0, 2.0, 100.0}) {
        std::vector<int> expected;
        for (const int i : all)
          if (squared_norm(points[at(i)] - x) <= radius * radius) expected.push_back(i);
        EXPECT_EQ(search.within(x, radius), expected);
      }
    }
  }
}

/// Powers of ten round a lattice's distances, which are equal, in as many ways.
TEST(FrameSearch, FindsTheSameInEveryUnit) {
  const FrameSearch search(lattice(7));
  for (const double unit : {1e-6, 1e-3, 0.1, 1e5}) {
    std::vector<Vec3d> points = lattice(7);
    for (Vec3d& x : points) x = x * unit;
    const FrameSearch scaled(points);
    PointGrid grid(2 * unit), old(2);
    for (const Vec3d& x : points) grid.insert(x);
    for (const Vec3d& x : lattice(7)) old.insert(x);
    for (const Vec3d& x : {Vec3d{{3, 3, 3}}, Vec3d{{2.5, 2.5, 2.5}}, Vec3d{{2.1, 3.9, 4.5}}, Vec3d{{0.3, 0.7, 0.3}}}) {
      for (const int k : {1, 2, 5, 8, 20}) EXPECT_EQ(scaled.nearest(x * unit, k), search.nearest(x, k)) << unit;
      const auto any = [](int) { return true; };
      EXPECT_EQ(grid.nearest(x * unit, INFINITY, any), old.nearest(x, INFINITY, any)) << unit;
    }
  }
}

/// Points at random, on a lattice (equals), and few that lie far apart; places between them and outside.
TEST(BlockSearch, FindsTheNearestOfAll) {
  ThreadPool pool(2);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 7);
  std::vector<Vec3d> scattered(300);
  for (Vec3d& x : scattered) x = {{uniform(random), uniform(random), uniform(random)}};
  const std::vector<Vec3d> few{{{0, 0, 0}}, {{6, 6, 6}}, {{6, 0, 0}}};
  for (const double unit : {1e-4, 1.0, 1e4})
    for (std::vector<Vec3d> points : {scattered, lattice(7), few, {few[0]}}) {
      for (Vec3d& x : points) x = x * unit;
      PointGrid grid(unit);
      for (const Vec3d& x : points) grid.insert(x);
      std::vector<Vec3d> places;
      for (int k = 0; k < 500; ++k) {
        Vec3d x{{uniform(random), uniform(random), uniform(random)}};
        if (k % 3 == 0) x = {{std::round(2 * x[0]) / 2, std::round(2 * x[1]) / 2, std::round(2 * x[2]) / 2}};
        places.push_back(x * unit);
      }
      std::vector<int> nearest(places.size()), again = nearest;
      BlockSearch(places, unit, pool).nearest(points, nearest, pool);
      for (const double wider : {2.0, 8.0}) {  // blocks between the widest and the narrowest, then these
        BlockSearch(places, wider * unit, pool).nearest(points, again, pool);
        EXPECT_EQ(again, nearest) << wider;
      }
      for (std::size_t k = 0; k < places.size(); ++k) {
        EXPECT_EQ(nearest[k], grid.nearest(places[k], INFINITY, [](int) { return true; }));
        for (const Vec3d& p : points)
          EXPECT_LE(squared_norm(points[at(nearest[k])] - places[k]), squared_norm(p - places[k]) * (1 + 2 * kTie));
      }
    }
}

TEST(BlockSearch, AsksAroundPlaces) {
  ThreadPool pool(2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 6);
  const auto some = [&](std::size_t count) {
    std::vector<Vec3d> x(count);
    for (Vec3d& p : x) p = {{uniform(random), uniform(random), uniform(random)}};
    return x;
  };
  const std::vector<Vec3d> points = some(250), places = some(700);
  const std::vector<Vec3d> around{{{0.4, 0, 0}}, {{-0.1, 0.2, 0.9}}, {{0, -1.5, 0}}};
  std::vector<int> nearest(around.size() * places.size(), -1), of_one(places.size());
  BlockSearch(places, 1, pool).nearest(points, nearest, pool, around);
  for (std::size_t o = 0; o < around.size(); ++o) {
    std::vector<Vec3d> moved = places;
    for (Vec3d& x : moved) x += around[o];
    BlockSearch(moved, 1, pool).nearest(points, of_one, pool);
    for (std::size_t p = 0; p < places.size(); ++p) EXPECT_EQ(nearest[around.size() * p + o], of_one[p]);
  }
}

/// Of no points, no places, places all at one point, and of places so far apart that blocks must be larger.
TEST(BlockSearch, TakesAnyPlaces) {
  ThreadPool pool(1);
  const std::vector<Vec3d> points{{{1, 0, 0}}, {{5, 0, 0}}};
  const auto nearest = [&](std::span<const Vec3d> places, std::span<const Vec3d> among) {
    std::vector<int> found(places.size(), 7);
    BlockSearch(places, 1, pool).nearest(among, found, pool);
    return found;
  };
  EXPECT_TRUE(nearest({}, points).empty());
  const std::vector<Vec3d> same(5, Vec3d{{4, 0, 0}});
  EXPECT_EQ(nearest(same, {}), std::vector<int>(5, -1));
  EXPECT_EQ(nearest(same, points), std::vector<int>(5, 1));
  // Places of a flat body, a millionth of the distance of points apart: were cells as small, this would take for ever.
  std::vector<Vec3d> flat;
  std::vector<int> wanted;
  wanted.reserve(4000);
  for (int k = 0; k < 4000; ++k) {
    flat.push_back({{6.0 * k / 4000, 1e-6 * (k % 7), 1e-6 * (k % 5)}});
    wanted.push_back(flat.back()[0] <= 3 ? 0 : 1);
  }
  std::vector<int> found(flat.size(), 7);
  BlockSearch(flat, 1e-6, pool).nearest(points, found, pool);
  EXPECT_EQ(found, wanted);
  const std::vector<Vec3d> far{{{0, 0, 0}}, {{1e6, 1e6, 1e6}}, {{-1e9, 0, 3}}};
  EXPECT_EQ(nearest(far, points), (std::vector<int>{0, 1, 0}));
}

TEST(FrameSearch, OfNothingFindsNothing) {
  const FrameSearch search({});
  EXPECT_TRUE(search.nearest({}, 3).empty());
  EXPECT_TRUE(search.within({}, 3).empty());
  EXPECT_TRUE(FrameSearch(lattice(2)).nearest({}, 0).empty());
}

TEST(LocalSpacing, IsTheMeanDistanceOfNearestNeighbours) {
  const std::vector<Vec3d> points = lattice(5);
  const std::vector<double> spacing = local_spacing(points, std::vector<int>(points.size(), 3));
  EXPECT_DOUBLE_EQ(spacing[62], 1);                            // the middle
  EXPECT_DOUBLE_EQ(spacing[0], (3 + 3 * std::sqrt(2.0)) / 6);  // a corner
  EXPECT_DOUBLE_EQ(local_spacing(points, std::vector<int>(points.size(), 1))[0], 1);
}

TEST(LocalSpacing, StaysNearTheMedian) {
  std::vector<Vec3d> line;
  for (int i = 0; i < 9; ++i) line.push_back({{static_cast<double>(i), 0, 0}});
  line.push_back({{100, 0, 0}});
  line.push_back({{100.01, 0, 0}});
  line.push_back({{100.02, 0, 0}});
  const std::vector<double> spacing = local_spacing(line, std::vector<int>(line.size(), 1));
  EXPECT_DOUBLE_EQ(spacing[10], 0.5);
  EXPECT_LE(*std::max_element(spacing.begin(), spacing.end()), 2);
  EXPECT_EQ(local_spacing(std::vector<Vec3d>(1), std::vector<int>{3}), std::vector<double>{0.0});
  EXPECT_EQ(local_spacing(std::vector<Vec3d>(3), std::vector<int>{3, 3, 3}), std::vector<double>(3, 0.0));
}

TEST(Coincident, ListsPairsInOrder) {
  std::vector<Vec3d> points = lattice(3);
  points.push_back(points[4] + Vec3d{{0, 1e-7, 0}});
  points.push_back(points[1]);
  points.push_back(points[4]);
  const std::vector<std::pair<int, int>> expected{{1, 28}, {4, 27}, {4, 29}, {27, 29}};
  EXPECT_EQ(coincident(points, 1e-6), expected);
  EXPECT_EQ(coincident(points, 1e-8).size(), 2U);
}

}  // namespace
}  // namespace fascia::neighbours_test
