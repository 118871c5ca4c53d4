// Natural frequencies.
#include "tests/support/coupled_scene.hpp"
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::modes_test {
namespace {

TEST(Modes, SteelCantilever) {
  const SolvedScene run("beam_modes");
  struct Mode {
    const char* name;
    double solid;
    int copies;
  };
  const Mode modes[] = {{"bending 1", 1.5988, 2}, {"bending 2", 9.974, 2}, {"bending 3", 27.73, 2},
                        {"torsion 1", 45.08, 1},  {"bending 4", 53.77, 2}, {"axial 1", 79.19, 1},
                        {"bending 5", 87.7, 2}};
  const nlohmann::json f = run.probe("frequency");
  ASSERT_EQ(f.size(), 12u);
  std::size_t i = 0;
  std::printf("mode         f [Hz]     solid [Hz]   error\n");
  for (const Mode& m : modes)
    for (int copy = 0; copy < m.copies; ++copy, ++i) {
      const double value = f[i].get<double>();
      std::printf("%-10s %9.4f %12.4f %+7.2f %%\n", m.name, value, m.solid, 100 * (value / m.solid - 1));
      EXPECT_NEAR(value / m.solid, 1.0, 0.03) << m.name;
    }
}

TEST(Modes, FreeBlockHasSixZeros) {
  for (const char* weights : {"trilinear", "linear"}) {
    const SolvedScene run("free_modes", {std::string("bodies.block.weights.kind='") + weights + "'"});
    const nlohmann::json f = run.probe("frequency");
    ASSERT_EQ(f.size(), 10u);
    std::printf("%-10s", weights);
    for (const nlohmann::json& v : f) std::printf(" %.3g", v.get<double>());
    std::printf(" Hz\n");
    for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(f[i].get<double>(), 1e-5 * f[6].get<double>());
    EXPECT_GT(f[6].get<double>(), 0.5);
  }
}

/// A free motion is 0, however few others are asked for: six of a line are all of them, and settle at once.
TEST(Modes, FreeMotionsAloneSettle) {
  for (const char* scene : {"line_free_modes", "free_modes"})
    for (const int count : {1, 5, 6, 7}) {
      const SolvedScene run(scene, {"solver.count=" + std::to_string(count)});
      const nlohmann::json f = run.probe("frequency");
      ASSERT_EQ(f.size(), static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i)
        EXPECT_EQ(f[static_cast<std::size_t>(i)].get<double>() == 0, i < 6) << scene << " " << i << " of " << count;
    }
}

/// Rounding of a body 1e19 times as stiff hides all frequencies of the soft one on it, which is held; the next ones are
/// far above. Of a free body the six zeros are its motions.
TEST(Modes, ZerosThatNoFreeMotionExplainsAreSaid) {
  const auto body = [](const char* name, const char* young, int from) {
    return fmt::format(
        "[bodies.{}]\nmodel=\"hexahedra\"\ndensity=1000\nmaterial={{young={},poisson=0.3}}\n"
        "domain={{box={{min=[{},0,0],max=[{},1,1],cells=[2,2,2]}}}}\n",
        name, young, from, from + 1);
  };
  const auto told = [](const std::string& bodies, int count) {
    const TextRun run(bodies + fmt::format("[solver]\nkind=\"modes\"\ncount={}\n", count));
    return run.summary()["warnings"].dump().find("cannot be told from 0") != std::string::npos;
  };
  const std::string at_face = box({0.99, -1, -1}, {1.01, 2, 2});
  EXPECT_TRUE(told(body("hard", "1e15", 0) + body("soft", "1e-4", 1) +
                       coupling("join", "embed", "soft", at_face, "to=\"hard\"") +
                       fix("hard", box({-1, -1, -1}, {0.01, 2, 2})),
                   55));
  EXPECT_FALSE(told(body("soft", "1e3", 0), 8));
}

}  // namespace
}  // namespace fascia::test::modes_test
