#include "core/base/thread_pool.hpp"
#include "core/run/drivers.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <vector>

namespace fascia::threads_test {
namespace {

using namespace test;

TEST(ThreadPool, TakesEachChunkOnce) {
  ThreadPool pool(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> visits(100, 0);
    pool.for_chunks(100, [&](int c) { ++visits[static_cast<std::size_t>(c)]; });
    for (const int v : visits) EXPECT_EQ(v, 1);
  }
}

/// This is the case under taskset, and in a batch job that gives a process one core of a machine.
TEST(ThreadPool, UsesTheProcessorsThatTheProcessMayRunOn) {
  cpu_set_t before, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  EXPECT_EQ(ThreadPool(0).size(), CPU_COUNT(&before));
  CPU_ZERO(&one);
  for (int c = 0; c < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++c)
    if (CPU_ISSET(c, &before)) CPU_SET(c, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(ThreadPool(0).size(), 1);
  ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}

TEST(ThreadPool, CoversARangeWithoutRemainder) {
  ThreadPool pool(3);
  std::vector<int> visits(1001, 0);
  pool.for_ranges(1001, 64, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
  });
  for (const int v : visits) EXPECT_EQ(v, 1);
  pool.for_ranges(0, 64, [](int, int) { FAIL(); });
}

TEST(Results, DoNotDependOnTheNumberOfThreads) {
  BlockOptions o;
  o.grid = {12, 4, 4};
  o.size = {{6, 1, 1}};
  BuiltModel built = block(o);
  hold_face(built.model);
  add_gravity(built.model, {{0, -0.01, 0}});
  for (const LinearMethod method : {LinearMethod::cholesky, LinearMethod::cg}) {
    State ends[2];
    for (int k = 0; k < 2; ++k) {
      ThreadPool pool(k + 1);
      SolverSettings settings;
      settings.linear = method;
      MechanicalSystem system(built.model, pool, settings);
      ends[k] = State::at_rest(built.model);
      const RunReport report = run_statics(system, ends[k], kRamp, settings, {}, nullptr);
      EXPECT_EQ(report.status, RunStatus::converged) << report.message;
    }
    for (std::size_t i = 0; i < ends[0].u.size(); ++i) {
      EXPECT_EQ(ends[0].u[i], ends[1].u[i]);
      EXPECT_EQ(ends[0].D[i], ends[1].D[i]);
    }
  }
}

}  // namespace
}  // namespace fascia::threads_test
