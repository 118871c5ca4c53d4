#include "core/math/across_lanes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace fascia::batch_test {
namespace {

/// Of numbers next to 0, next to −1 and of all sizes, against the logarithm of longer numbers.
TEST(Batch, HasTheLogarithmOfOneMoreToTwoUlp) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    const Lanes a = lanes_of([&](int) {
      const double small = std::pow(10, -16 * uniform(random));
      switch (random() % 5) {
        case 0:
          return small;
        case 1:
          return -small * (1 - 1e-15);
        case 2:
          return 2 * uniform(random) - 0.99;
        case 3:
          return std::pow(10, 299 * uniform(random));
        default:
          return std::max(small - 1, std::nextafter(-1.0, 0.0));
      }
    });
    const Lanes log = log1p(a);
    for (int lane = 0; lane < kBatchWidth; ++lane) {
      const long double exact = std::log1p(static_cast<long double>(a.v[lane]));
      const double size = std::abs(static_cast<double>(exact));
      const double ulp = std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
      worst = std::max(worst, static_cast<double>(std::abs(log.v[lane] - exact)) / ulp);
    }
  }
  EXPECT_LT(worst, 2);
}

/// A lane that has no logarithm, or that of the largest numbers, leaves the others theirs.
TEST(Batch, HasTheLogarithmsOfTheEnds) {
  const double most = std::numeric_limits<double>::max(), none = std::numeric_limits<double>::infinity();
  for (const double x : {0.0, 1e-320, -1.0, -1.5, -none, none, std::nan(""), most, 1e305}) {
    Lanes a(0.5);
    a.v[1] = x;
    const Lanes log = log1p(a);
    EXPECT_DOUBLE_EQ(log.v[0], std::log1p(0.5));
    if (std::isnan(std::log1p(x)))
      EXPECT_TRUE(std::isnan(log.v[1])) << x;
    else
      EXPECT_EQ(log.v[1], std::log1p(x)) << x;
  }
}

TEST(Batch, IsMadeOfAndSumsItsLanes) {
  const Lanes a = lanes_of([](int lane) { return 1.0 + lane; });
  for (int lane = 0; lane < kBatchWidth; ++lane) EXPECT_EQ(a.v[lane], 1.0 + lane);
  EXPECT_EQ(lane_sum(a), kBatchWidth * (kBatchWidth + 1) / 2);
}

}  // namespace
}  // namespace fascia::batch_test
