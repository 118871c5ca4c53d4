// Loops on the threads of a pool are those of one thread: everything is visited once, and sums have the same bits.
#include "core/space/part_sums.hpp"
#include "core/space/pool_space.hpp"
#include "core/step/step_loops.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

namespace fascia::spaces_test {
namespace {

constexpr int kCounts[] = {0, 1, 255, 256, 257, 1024, 1025, 5000};

double value(int i) { return std::sin(1.0 + i) / (1 + i % 7); }

struct Add {
  FASCIA_HD void operator()(int i, Sums<2, 1>& sums) const {
    sums.v[0] += value(i);
    sums.v[1] += value(i) * value(i);
    sums.note(0, std::abs(value(i)));
  }
};

TEST(Spaces, SumsOnAnyThreadsAreThoseOfOne) {
  for (const int count : kCounts) {
    double expected[3];
    HostSpace::sum<2, 1>(count, Add{}, loops::StoreSums<2, 1>{expected});
    for (const int threads : {1, 2, 4}) {
      ThreadPool pool(threads);
      const PoolSpace space(pool);
      double got[3];
      space.sum<2, 1>(count, Add{}, loops::StoreSums<2, 1>{got});
      for (int k = 0; k < 3; ++k) EXPECT_EQ(got[k], expected[k]) << count << " items, " << threads << " threads";
    }
  }
}

TEST(Spaces, EachItemIsVisitedOnce) {
  ThreadPool pool(4);
  for (const int count : kCounts) {
    std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
    PoolSpace(pool).for_each(count, [&](int i) { ++visits[static_cast<std::size_t>(i)]; });
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
}

TEST(Spaces, AValueThatIsNotANumberStaysTheLargest) {
  ThreadPool pool(2);
  double largest[1];
  const auto note = [](int i, Sums<0, 1>& sums) {
    sums.note(0, i == 700 ? std::numeric_limits<double>::quiet_NaN() : 1.0 + i);
  };
  PoolSpace(pool).sum<0, 1>(2000, note, loops::StoreSums<0, 1>{largest});
  EXPECT_TRUE(std::isnan(largest[0]));
}

/// Few parts are summed one after the other, many all at once.
TEST(Spaces, SumsByPartAreThoseOfOneThread) {
  for (const int parts : {1, 5, 40}) {
    std::vector<int> part_of_item;
    for (int i = 0; i < 3000; ++i) part_of_item.push_back(i % 11 == 0 ? -1 : i * i % parts);
    ThreadPool pool(3);
    PartSums<HostSpace> one(part_of_item, parts);
    PartSums<PoolSpace> all(part_of_item, parts, PoolSpace(pool));
    std::vector<double> expected(static_cast<std::size_t>(3 * parts)), got(expected.size());
    one.sum<2, 1>(Add{}, expected.data());
    all.sum<2, 1>(Add{}, got.data());
    EXPECT_EQ(got, expected);
  }
}

}  // namespace
}  // namespace fascia::spaces_test
