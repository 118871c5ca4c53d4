// What a scene holds does not move at its start, whatever velocity its body has.
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "core/node/node_force.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fascia::app::initial_motion_test {
namespace {

/// A rigid cube that turns and flies, with constraints.
State start(const std::string& constraints) {
  return build_simulation(
             parse_scene_text("[bodies.b]\nmodel = \"rigid\"\nmass = 1\n"
                              "domain = { box = { min = [-1, -1, -1], max = [1, 1, 1], cells = [1, 1, 1] } }\n"
                              "initial = { velocity = [4, 5, 6], angular_velocity = [3, 2, 1] }\n" +
                                  constraints + "[solver]\nkind = \"newmark\"\ntime_step = 0.01\nduration = 0.1\n",
                              "scene.toml", {}))
      .initial;
}

std::string fixed(const char* axes) {
  return std::string("[[constraints]]\nbody = \"b\"\nwhere = \"all\"\nfix = ") + axes + "\n";
}

const std::string kTurned =
    "[[constraints]]\nbody = \"b\"\nwhere = \"all\"\n"
    "move = { rotate = { axis = [0, 0, 1], angle = 1, center = [0, 0, 0] }, axes = [\"rz\"] }\nover = \"1 s\"\n";

void expect(const State& state, const Vec3d& velocity, const Vec3d& spin) {
  EXPECT_LT(norm(state.v[0] - velocity), 1e-14);
  EXPECT_LT(norm(spin_of(state.Q_dot[0], Mat3d::identity() + state.D[0]) - spin), 1e-14);
}

TEST(InitialMotion, LosesWhatIsHeld) {
  expect(start(""), {{4, 5, 6}}, {{3, 2, 1}});
  expect(start(fixed("[\"y\", \"rx\"]")), {{4, 0, 6}}, {{0, 2, 1}});
  expect(start(fixed("\"all\"")), {}, {});
}

/// One axis that a motion turns leaves the held ones held.
TEST(InitialMotion, KeepsWhatAMotionTurns) {
  expect(start(fixed("[\"x\", \"y\", \"z\", \"rx\"]") + kTurned), {}, {{0, 2, 1}});
}

}  // namespace
}  // namespace fascia::app::initial_motion_test
