// Steps with a budget of time. No test asserts a time: a budget that is never reached must change nothing, and one that
// holds no iteration must be refused.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <ostream>

namespace fascia::test::budget_test {
namespace {

struct Case {
  const char* name;
  const char* scene;
  Settings settings;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class AmpleBudget : public ::testing::TestWithParam<Case> {};

/// The step that is tried beforehand leaves no trace: not in what schemes, fluids, fading stresses, tethers and factors
/// keep from step to step.
TEST_P(AmpleBudget, ChangesNoBit) {
  const Case& c = GetParam();
  Settings with = c.settings;
  with.emplace_back("solver.budget=1e6");
  const SolvedScene free(c.scene, c.settings), limited(c.scene, with);
  ASSERT_TRUE(free.ok() && limited.ok());
  ASSERT_GE(free.history().size(), 2U);
  EXPECT_EQ(free.history(), limited.history());
  EXPECT_EQ(limited.status(), free.status());
  EXPECT_EQ(limited.newton_iterations(), free.newton_iterations()) << "what was tried does not count";
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, AmpleBudget,
    ::testing::Values(Case{"implicit_euler", "struck_beam", {"solver.kind=\"implicit-euler\"", "solver.steps=20"}},
                      Case{"newmark", "struck_beam", {"solver.kind=\"newmark\"", "solver.steps=20"}},
                      Case{"bdf2", "struck_beam", {"solver.kind=\"bdf2\"", "solver.steps=20"}},
                      Case{"conjugate_gradients",
                           "struck_beam",
                           {"solver.linear={kind=\"cg\", preconditioner=\"block-jacobi\"}", "solver.steps=5"}},
                      Case{"midpoint", "midpoint_spin", {"solver.duration=0.5"}},
                      Case{"tethers", "uterus_bladder", {"solver.duration=0.05"}},
                      Case{"driven", "breathing_liver", {"solver.duration=0.05"}},
                      Case{"fading_stress", "relaxing_ligament", {"solver.duration=2"}}),
    [](const auto& one) { return one.param.name; });

TEST(Budget, ThatHoldsNoIterationEndsTheRunBeforeItsFirstStep) {
  const SolvedScene run = SolvedScene::of_file("struck_beam", {"solver.budget=1e-9"});
  EXPECT_FALSE(run.ok());
  EXPECT_EQ(run.status(), "not-converged");
  EXPECT_NE(run.message().find("holds no iteration of Newton's method"), std::string::npos) << run.message();
  EXPECT_NE(run.message().find("give solver.budget more"), std::string::npos) << run.message();
  EXPECT_EQ(run.message().find("inf"), std::string::npos) << run.message();
}

/// Nothing moves at first, so that no step needs an iteration: one is measured all the same.
TEST(Budget, OfABodyAtRestIsJudgedToo) {
  const SolvedScene moving("settling_beam", {"solver.duration=0.3", "solver.budget=1e6"});
  EXPECT_EQ(moving.status(), "converged");
  const SolvedScene still("settling_beam", {"world.gravity=[0, 0, 0]", "solver.duration=0.3", "solver.budget=1e6"});
  EXPECT_EQ(still.status(), "converged");
  const SolvedScene refused =
      SolvedScene::of_file("settling_beam", {"world.gravity=[0, 0, 0]", "solver.duration=0.3", "solver.budget=1e-9"});
  EXPECT_EQ(refused.status(), "not-converged");
  EXPECT_NE(refused.message().find("holds no iteration"), std::string::npos) << refused.message();
  EXPECT_EQ(refused.message().find("inf"), std::string::npos) << refused.message();
}

}  // namespace
}  // namespace fascia::test::budget_test
