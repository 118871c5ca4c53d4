#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// Kinds of solvers and their time. The table [solver] starts at line 10 of the beam.
namespace fascia::app::dynamics_test {
namespace {

std::string solver_text(const std::string& kind, const std::string& more) {
  return "[solver]\nkind = \"" + kind + "\"\n" + more;
}
Solver solver_of(const std::string& kind, const std::string& more) {
  return test::parse_beam(solver_text(kind, more)).solver;
}
std::string errors_of(const std::string& kind, const std::string& more) {
  return test::errors_of_beam(solver_text(kind, more));
}

TEST(Dynamics, KindsOfSolvers) {
  static_assert(is_implicit_dynamics(SolverKind::newmark) && !is_implicit_dynamics(SolverKind::central_differences));
  static_assert(is_dynamic(SolverKind::central_differences) && !is_dynamic(SolverKind::statics));
  static_assert(!is_dynamic(SolverKind::modes));
  const std::string time = "time_step = \"10 ms\"\nduration = 1\n[output]\nevery = 0.1\n";
  EXPECT_EQ(solver_of("implicit-euler", time).kind, SolverKind::implicit_euler);
  EXPECT_EQ(solver_of("bdf2", time).kind, SolverKind::bdf2);
  EXPECT_EQ(solver_of("newmark", time).kind, SolverKind::newmark);
  EXPECT_EQ(solver_of("midpoint", time).kind, SolverKind::midpoint);
  EXPECT_EQ(solver_of("explicit", time).kind, SolverKind::central_differences);
  EXPECT_EQ(solver_of("newmark", time).steps, 100);
  EXPECT_EQ(solver_of("newmark", time).duration, 1.0);
  EXPECT_FALSE(solver_of("newmark", time).time_step_automatic);
  EXPECT_FALSE(solver_of("bdf2", "time_step = 1\nsteps = 3\n").duration);
}

TEST(Dynamics, AnAutomaticTimeStepLeavesTheStepsOpen) {
  const Solver solver = solver_of("explicit", "time_step = \"auto\"\nduration = \"2 s\"\n");
  EXPECT_TRUE(solver.time_step_automatic);
  EXPECT_EQ(solver.duration, 2.0);
  EXPECT_EQ(solver.time_step, 0);
  EXPECT_EQ(solver.steps, 0);
}

TEST(DynamicsErrors, UnknownKinds) {
  EXPECT_EQ(errors_of("newmrak", ""),
            "a.toml:11:8: solver.kind: \"newmrak\" is no known value; must be \"static\", \"implicit-euler\", "
            "\"bdf2\", \"newmark\", \"midpoint\", \"explicit\" or \"modes\" (did you mean \"newmark\"?)");
}

TEST(DynamicsErrors, EveryKindNeedsTime) {
  for (const std::string kind : {"implicit-euler", "bdf2", "newmark", "midpoint"})
    EXPECT_EQ(errors_of(kind, ""),
              "a.toml:10:1: solver.time_step: is missing; must be a time in s above 0; or state what the results must "
              "be worth in "
              "[need], which then chooses it\n"
              "a.toml:10:1: solver.duration: is missing; must be a time in s above 0, or give steps");
  EXPECT_EQ(errors_of("explicit", "steps = 3\n"),
            "a.toml:10:1: solver.time_step: is missing; must be a time in s above 0 or \"auto\"; or state what the "
            "results must be worth in [need], which then chooses it");
  EXPECT_EQ(errors_of("modes", "time_step = 1\nsteps = 3\n"),
            "a.toml:12:13: solver.time_step: is not used by kind = \"modes\"; remove it\n"
            "a.toml:13:9: solver.steps: is not used by kind = \"modes\"; remove it");
  EXPECT_EQ(errors_of("midpoint", "time_step = 1\nsteps = 3\nload_steps = 2\ncount = 4\n"),
            "a.toml:14:14: solver.load_steps: is not used by kind = \"midpoint\"; remove it\n"
            "a.toml:15:9: solver.count: is not used by kind = \"midpoint\"; remove it");
}

TEST(DynamicsErrors, AutomaticTimeSteps) {
  for (const std::string kind : {"implicit-euler", "bdf2", "newmark", "midpoint"})
    EXPECT_EQ(errors_of(kind, "time_step = \"auto\"\nduration = 1\n"),
              "a.toml:12:13: solver.time_step: \"auto\" is only for kind = \"explicit\"; must be a time in s above 0");
  EXPECT_EQ(errors_of("static", "time_step = \"auto\"\n"),
            "a.toml:12:13: solver.time_step: is not used by kind = \"static\"; remove it");
  EXPECT_EQ(errors_of("explicit", "time_step = \"auto\"\n"),
            "a.toml:10:1: solver.duration: is missing beside time_step = \"auto\"; must be a time in s above 0");
  EXPECT_EQ(errors_of("explicit", "time_step = \"auto\"\nsteps = 10\n"),
            "a.toml:13:9: solver.steps: is not used with time_step = \"auto\", whose steps the run counts; must be "
            "duration");
  EXPECT_EQ(errors_of("explicit", "time_step = \"auto\"\nduration = 1\nsteps = 10\n"),
            "a.toml:14:9: solver.steps: cannot stand beside duration; give only one of them");
  EXPECT_EQ(errors_of("explicit", "time_step = \"1 m\"\nduration = 1\n"),
            "a.toml:12:13: solver.time_step: \"1 m\" is a length; must be a time in s, such as \"10 ms\"");
  EXPECT_EQ(errors_of("explicit", "time_step = true\nduration = 1\n"),
            "a.toml:12:13: solver.time_step: true is of the wrong type; must be a time in s above 0 or \"auto\"");
  EXPECT_EQ(errors_of("explicit", "time_step = \"auto\"\nduration = 0\n"),
            "a.toml:13:12: solver.duration: 0 is out of range; must be above 0");
}

TEST(DynamicsErrors, ExplicitStepsSolveNothing) {
  EXPECT_EQ(errors_of("explicit",
                      "time_step = 1\nsteps = 1\nnewton = { tolerance = 0.1 }\nlinear = { kind = \"cg\" }\n"
                      "tangent = \"material\"\n"),
            "a.toml:14:10: solver.newton: is not used by kind = \"explicit\"; remove it\n"
            "a.toml:15:10: solver.linear: is not used by kind = \"explicit\"; remove it\n"
            "a.toml:16:11: solver.tangent: is not used by kind = \"explicit\"; remove it");
}

TEST(DynamicsErrors, OutputEveryNeedsTime) {
  EXPECT_EQ(errors_of("modes", "[output]\nevery = 1\n"),
            "a.toml:13:9: output.every: counts simulated time, which only dynamic kinds have; remove it");
}

}  // namespace
}  // namespace fascia::app::dynamics_test
