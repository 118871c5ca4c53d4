// The same bits for any number of threads.
#include "tests/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <ostream>

namespace fascia::test::reproducible_test {
namespace {

struct Case {
  const char* name;
  std::string scene;
  Settings settings;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Threads : public ::testing::TestWithParam<Case> {};

TEST_P(Threads, OneAndTwoGiveTheSameBits) {
  const Case& c = GetParam();
  const SceneRun one(c.scene, c.settings, {"--threads", "1"}), two(c.scene, c.settings, {"--threads", "2"});
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one.summary()["threads"], 1);
  EXPECT_EQ(two.summary()["threads"], 2);
  EXPECT_EQ(one.summary()["probes"].dump(), two.summary()["probes"].dump());
  EXPECT_EQ(one.bytes("probes.csv"), two.bytes("probes.csv"));
  EXPECT_EQ(one.difference_to(two), "");
  std::printf("%s: probes and fields identical\n", c.name);
}

INSTANTIATE_TEST_SUITE_P(
    All, Threads,
    ::testing::Values(Case{"cholesky", "soft_cantilever", {"solver.linear.kind='cholesky'"}},
                      Case{"cg", "soft_cantilever", {"bodies.beam.frames.grid=[9,3,3]", "solver.linear.kind='cg'"}},
                      Case{"dynamics", "struck_beam", {"solver.steps=40"}}, Case{"immersed", "traction_free_ends", {}},
                      Case{"modes", "free_modes", {}}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace
}  // namespace fascia::test::reproducible_test
