#include "app/results/step_seconds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace fascia::step_seconds_test {
namespace {

using app::StepSeconds;

TEST(StepSeconds, AreZeroWithoutSteps) {
  const StepSeconds none;
  EXPECT_EQ(none.percentile(0.5), 0);
  EXPECT_EQ(none.percentile(1), 0);
}

TEST(StepSeconds, OfOneStepAreThatStep) {
  for (const double seconds : {0.0, 3e-12, 2.5e-4, 17.0, 1e12}) {
    StepSeconds one;
    one.add(seconds);
    for (const double part : {0.0, 0.5, 0.99, 1.0}) EXPECT_EQ(one.percentile(part), seconds);
  }
}

TEST(StepSeconds, AreWithinAHundredthOfWhatSortingGives) {
  std::mt19937 random(7);
  std::normal_distribution<double> logarithm(-9, 3);
  for (const int count : {2, 3, 10, 1000, 30000}) {
    StepSeconds steps;
    std::vector<double> all;
    for (int i = 0; i < count; ++i) {
      all.push_back(std::exp(logarithm(random)));
      steps.add(all.back());
    }
    std::sort(all.begin(), all.end());
    for (const double part : {0.1, 0.5, 0.9, 0.99}) {
      const double exact = all[static_cast<std::size_t>(std::ceil(part * (count - 1)))];
      EXPECT_NEAR(steps.percentile(part), exact, 0.0051 * exact) << count << " steps, part " << part;
    }
    EXPECT_EQ(steps.percentile(1), all.back());
    EXPECT_EQ(steps.percentile(0), all.front());
  }
}

TEST(StepSeconds, OutsideTheClassesStayWithinWhatWasSeen) {
  StepSeconds steps;
  for (const double seconds : {0.0, 0.0, 1e-13, 4e9, 5e9, 5e9}) steps.add(seconds);
  EXPECT_GE(steps.percentile(0.5), 0);
  EXPECT_LE(steps.percentile(0.9), 5e9);
  EXPECT_EQ(steps.percentile(1), 5e9);
}

}  // namespace
}  // namespace fascia::step_seconds_test
