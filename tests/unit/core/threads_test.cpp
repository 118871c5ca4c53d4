#include "core/base/processors.hpp"
#include "core/base/thread_pool.hpp"
#include "core/base/throwing_loops.hpp"
#include "core/run/drivers.hpp"
#include "tests/support/models.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
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

/// Chunks of very unlike cost: whoever is done takes those of others, and each is taken once.
TEST(ThreadPool, LeavesNoChunkToABusyThread) {
  ThreadPool pool(4);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::atomic<int>> visits(37);
    std::atomic<bool> others_done{false};
    std::atomic<int> light{0};
    pool.for_chunks(37, [&](int c) {
      ++visits[static_cast<std::size_t>(c)];
      if (c == 20) {  // holds its thread until all others are done, those of its own share too
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (!others_done && std::chrono::steady_clock::now() < end) std::this_thread::yield();
      } else if (++light == 36) {
        others_done = true;
      }
    });
    EXPECT_TRUE(others_done);
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
}

/// Every range is gone through, and the first of those that threw is told of.
TEST(ThrowingLoops, TellOfTheFirstRangeThatThrew) {
  for (const int threads : {1, 4}) {
    ThreadPool pool(threads);
    std::vector<std::atomic<int>> visits(100);
    const auto loop = [&] {
      for_throwing_ranges(pool, 100, 7, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
        if (begin >= 21 && begin % 2 == 1) throw std::runtime_error(std::to_string(begin));
      });
    };
    try {
      loop();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "21");
    }
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
}

/// Loops with fewer chunks than threads, and pools with more threads than processors.
TEST(ThreadPool, ManyThreadsShareFewChunks) {
  ThreadPool pool(9);
  EXPECT_EQ(pool.size(), 9);
  std::atomic<int> sum{0};
  for (int round = 0; round < 300; ++round) pool.for_chunks(2 + round % 7, [&](int c) { sum += c; });
  int expected = 0;
  for (int round = 0; round < 300; ++round)
    for (int c = 0; c < 2 + round % 7; ++c) expected += c;
  EXPECT_EQ(sum, expected);
}

/// A container that is given the time of some processors sees all of the machine's.
TEST(AvailableProcessors, AreNoMoreThanTheTimeOfAGroupAllows) {
  const test::TemporaryFolder root;
  const std::string top = root.path.string();
  const auto write = [&](const std::string& folder, const std::string& file, const std::string& text) {
    std::filesystem::create_directories(top + folder);
    std::ofstream(top + folder + "/" + file) << text;
  };
  EXPECT_EQ(processors_of_quota("0::/\n", top), 0);
  write("/job/step", "cpu.max", "250000 100000\n");
  write("/job", "cpu.max", "max 100000\n");
  EXPECT_EQ(processors_of_quota("0::/job/step\n", top), 3);
  EXPECT_EQ(processors_of_quota("0::/job\n", top), 0);
  write("/job", "cpu.max", "50000 100000\n");  // that of the group around it counts too
  EXPECT_EQ(processors_of_quota("0::/job/step\n", top), 1);
  write("/cpu/docker/x", "cpu.cfs_quota_us", "600000\n");
  write("/cpu/docker/x", "cpu.cfs_period_us", "100000\n");
  write("/cpu", "cpu.cfs_quota_us", "-1\n");
  EXPECT_EQ(processors_of_quota("5:memory:/docker/x\n4:cpuacct,cpu:/docker/x\n0::/\n", top), 6);
  write("/job", "cpu.max", "nonsense\n");
  EXPECT_EQ(processors_of_quota("0::/job\nnonsense\n", top), 0);
}

/// This is the case under taskset, and in a batch job that gives a process one core of a machine.
TEST(ThreadPool, UsesTheProcessorsThatTheProcessMayRunOn) {
  cpu_set_t before, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  EXPECT_EQ(ThreadPool(0).size(), available_processors());
  EXPECT_LE(available_processors(), CPU_COUNT(&before));  // a quota may leave fewer
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
