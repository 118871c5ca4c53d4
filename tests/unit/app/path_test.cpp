// The keys of static paths: what is read, and what does not go together.
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

namespace fascia::app::path_test {
namespace {

using namespace test;

/// The messages of a solver's keys, which start at line 11.
std::string errors_of_solver(const std::string& keys) { return errors_of_beam("[solver]\n" + keys); }

TEST(PathKeys, AreRead) {
  const Solver plain = parse_beam("").solver;
  EXPECT_EQ(plain.control, StaticControl::load);
  EXPECT_EQ(plain.max_steps, 500);
  EXPECT_FALSE(plain.controlled);
  EXPECT_EQ(parse_beam("[solver]\ncontrol = \"arc-length\"\nmax_steps = 20\nload_steps = 7\n").solver.max_steps, 20);
  const Solver solver =
      parse_beam(
          "[solver]\ncontrol = \"displacement\"\n"
          "controlled = { body = \"beam\", at = [4, 1, 1], direction = [0, 0, -1], to = \"30 mm\" }\n")
          .solver;
  EXPECT_EQ(solver.control, StaticControl::displacement);
  ASSERT_TRUE(solver.controlled);
  EXPECT_EQ(solver.controlled->body, "beam");
  EXPECT_EQ(solver.controlled->at, (Vec3d{{4, 1, 1}}));
  EXPECT_EQ(solver.controlled->direction, (Vec3d{{0, 0, -1}}));
  EXPECT_EQ(solver.controlled->to, 0.03);
}

TEST(PathKeys, WrongOnesAreNamed) {
  const std::string displacement = "control = \"displacement\"\n";
  EXPECT_EQ(errors_of_solver("control = \"arclength\"\n"),
            "a.toml:11:11: solver.control: \"arclength\" is no known value; must be \"load\", \"displacement\" or "
            "\"arc-length\" (did you mean \"arc-length\"?)");
  EXPECT_EQ(errors_of_solver("kind = \"modes\"\ncontrol = \"arc-length\"\nmax_steps = 3\n"),
            "a.toml:12:11: solver.control: is not used by kind = \"modes\"; remove it\n"
            "a.toml:13:13: solver.max_steps: is not used by kind = \"modes\"; remove it");
  EXPECT_EQ(errors_of_solver("kind = \"midpoint\"\ntime_step = 1\nsteps = 1\ncontrol = \"displacement\"\n"),
            "a.toml:14:11: solver.control: is not used by kind = \"midpoint\"; remove it");
  EXPECT_EQ(
      errors_of_solver("max_steps = 3\n"),
      "a.toml:11:13: solver.max_steps: is used only with control = \"displacement\" or \"arc-length\"; remove it");
  EXPECT_EQ(errors_of_solver("control = \"arc-length\"\n"
                             "controlled = { body = \"beam\", at = [0, 0, 0], direction = [0, 0, 1] }\n"),
            "a.toml:12:14: solver.controlled: is used only with control = \"displacement\"; remove it");
  EXPECT_EQ(
      errors_of_solver(displacement + "controlled = { body = \"beam\", at = [0, 0, 0], direction = [0, 0, 0] }\n"),
      "a.toml:12:59: solver.controlled.direction: has no direction; must be a vector of a length other than 0");
  EXPECT_EQ(
      errors_of_solver(displacement + "controlled = { body = \"bean\", at = [0, 0, 0], direction = [0, 0, 1] }\n"),
      "a.toml:12:23: solver.controlled.body: \"bean\" is no known body; did you mean \"beam\"?");
  EXPECT_EQ(errors_of_solver(displacement +
                             "controlled = { body = \"beam\", at = [0, 0, 0], direction = [0, 0, 1], to = 0 }\n"),
            "a.toml:12:75: solver.controlled.to: 0 is where the run starts; must be a length in m other than 0");
  EXPECT_EQ(errors_of_solver(displacement + "controlled = { body = \"beam\" }\n"),
            "a.toml:12:14: solver.controlled.at: is missing; must be a list of 3, each a length in m\n"
            "a.toml:12:14: solver.controlled.direction: is missing; must be a list of 3, each a number");
}

TEST(PathKeys, SolversThatDoNotGoWithThem) {
  EXPECT_EQ(errors_of_solver("control = \"arc-length\"\ntangent = \"material\"\nlinear = { kind = \"cg\" }\n"
                             "newton = { on_limit = \"continue\" }\n"),
            "a.toml:12:11: solver.tangent: \"material\" does not go with control = \"arc-length\", which needs the "
            "geometric stiffness; must be \"full\"\n"
            "a.toml:13:19: solver.linear.kind: \"cg\" does not go with control = \"arc-length\", which factorises the "
            "stiffness; must be \"auto\" or \"cholesky\"\n"
            "a.toml:14:23: solver.newton.on_limit: \"continue\" does not go with control = \"arc-length\"; must be "
            "\"stop\"");
}

}  // namespace
}  // namespace fascia::app::path_test
