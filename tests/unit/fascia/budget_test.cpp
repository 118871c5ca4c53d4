// Steps whose budget holds no iteration: each is cut after one, whatever the machine and what else it does.
#include "fascia/scene_file.hpp"
#include "fascia/stepper.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::budget_test {
namespace {

constexpr double kNoTime = 1e-9;
constexpr SolverKind kSchemes[] = {SolverKind::implicit_euler, SolverKind::bdf2, SolverKind::newmark,
                                   SolverKind::midpoint};

Scene settling_beam(LinearMethod linear) {
  Scene scene = read_scene_file(test::source_dir() / "scenes/settling_beam.toml");
  scene.solver.linear = linear;
  return scene;
}

/// Full steps of Newton's method raise energy and residual of a slender beam at first: what is left of a step then is a
/// shorter one, and not the state that it began with.
TEST(StepsThatAreCut, ASlenderBeamFallsAllTheSame) {
  Stepper whole(settling_beam(LinearMethod::automatic));
  for (int step = 0; step < 100; ++step) ASSERT_TRUE(whole.step(0.1).converged);
  const double fallen = whole.probe("tip")[1];
  ASSERT_LT(fallen, -1);
  Scene scene = settling_beam(LinearMethod::automatic);
  scene.solver.budget = kNoTime;
  Stepper cut(std::move(scene));
  ASSERT_EQ(cut.warnings().size(), 1U);
  EXPECT_NE(cut.warnings()[0].find("holds no iteration"), std::string::npos) << cut.warnings()[0];
  EXPECT_EQ(cut.warnings()[0].find("inf"), std::string::npos) << cut.warnings()[0];
  int cuts = 0;
  for (int step = 0; step < 100; ++step) {
    const StepReport report = cut.step(0.1);
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_FALSE(report.at_limit);
    cuts += report.out_of_time ? 1 : 0;
  }
  EXPECT_GT(cuts, 50);
  std::printf("after 10 s: %.4f m, cut %.4f m; %d of 100 steps cut\n", fallen, cut.probe("tip")[1], cuts);
  EXPECT_NEAR(cut.probe("tip")[1], fallen, 0.1 * std::abs(fallen));
}

/// One iteration of conjugate gradients does next to nothing for a slender beam, but it is never none.
TEST(StepsThatAreCut, GoOnByConjugateGradients) {
  Scene scene = settling_beam(LinearMethod::cg);
  scene.solver.budget = kNoTime;
  Stepper cut(std::move(scene));
  for (int step = 0; step < 20; ++step) {
    const StepReport report = cut.step(0.1);
    ASSERT_TRUE(report.converged) << report.message;
    ASSERT_LE(report.linear_iterations, 3 * report.newton_iterations);
  }
  EXPECT_LT(cut.probe("tip")[1], 0);
  EXPECT_GT(cut.probe("tip")[1], -16);
}

/// What is prescribed arrives, however long that takes.
TEST(StepsThatAreCut, DriversArrive) {
  test::take_host_as_device();
  for (const char* backend : {"cpu", "cuda"})
    for (const SolverKind kind : kSchemes) {
      Scene scene = test::driven_block(kind);
      scene.solver.backend = backend;
      Stepper whole(scene);
      scene.solver.budget = kNoTime;
      Stepper cut(std::move(scene));
      for (int step = 1; step <= 4; ++step) {
        const RigidMotion motion{{{1e-3 * step, 0, 0}}, {{0.02 * step, 0, 0.4 * step}}, {{0.02, 0.02, 0}}};
        whole.set_motion(0, motion);
        cut.set_motion(0, motion);
        ASSERT_TRUE(whole.step(0.01).converged);
        const StepReport report = cut.step(0.01);
        ASSERT_TRUE(report.converged) << report.message;
      }
      const Rows u = whole.displacements(), of_cut = cut.displacements();
      double held = 0, apart = 0, largest = 0;
      for (int i = 0; i < u.rows; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          ASSERT_TRUE(std::isfinite(of_cut[i][k]));
          largest = std::max(largest, std::abs(u[i][k]));
          apart = std::max(apart, std::abs(u[i][k] - of_cut[i][k]));
        }
      const Rows forces = whole.forces();
      for (int i = 0; i < u.rows; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          if (forces[i][0] != 0 || forces[i][1] != 0 || forces[i][2] != 0)
            held = std::max(held, std::abs(u[i][k] - of_cut[i][k]));
      EXPECT_LE(held, 1e-12) << backend << " " << static_cast<int>(kind);
      // Directions of the processor are solved, those of a GPU have one iteration of conjugate gradients.
      const double near = cut.backend() == Backend::cuda ? 1 : 0.2;
      EXPECT_LE(apart, near * largest) << backend << " " << static_cast<int>(kind);
    }
}

}  // namespace
}  // namespace fascia::budget_test
