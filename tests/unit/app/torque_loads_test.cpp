// A total torque on the edge of a shell, and loads on regions that a body cannot have.
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>

namespace fascia::app::torque_loads_test {
namespace {

/// A tube's sector of a radius of 1 m. @param where, load  of it
Simulation tube(const std::string& model, const std::string& angle, const std::string& where, const std::string& load) {
  const auto path = std::filesystem::temp_directory_path() / ("torque_loads_" + std::to_string(getpid()) + ".toml");
  std::ofstream(path) << "[bodies.tube]\nmodel = \"" << model << "\"\n"
                      << "domain = { cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1, " << angle
                      << "cells = [4, 8] } }\n"
                      << (model == "shell" ? "thickness = 0.01\nmaterial = { young = 1e6, poisson = 0.3 }\n" : "")
                      << "mass = 1\n[[loads]]\nbody = \"tube\"\nwhere = " << where << "\n"
                      << load << " = [0, 0, 3]\n"
                      << "[solver]\nkind = \"implicit-euler\"\ntime_step = 0.01\nduration = 0.1\n";
  Scene scene = parse_scene_file(path, {});
  std::filesystem::remove(path);
  return build_simulation(std::move(scene));
}

/// Largest force, and sums of torques and of moments of forces, of the load.
struct Acting {
  double force = 0;
  Vec3d torque{}, moment{};
};
Acting acting(const Simulation& s) {
  Acting a;
  for (const NodeLoad& n : s.model.loads.back().nodes) {
    a.force = std::max(a.force, norm(n.force));
    a.torque += n.torque;
    a.moment += cross(s.model.rest_position[static_cast<std::size_t>(n.node)], n.force);
  }
  return a;
}

TEST(TorqueLoads, TurnTheNodesOfASlightlyCurvedEdge) {
  for (const char* angle : {"1", "30", "90"}) {
    const Simulation s =
        tube("shell", std::string("angle = [0, \"") + angle + " degree\"], ", "{ group = \"from\" }", "total_torque");
    const Acting a = acting(s);
    EXPECT_LT(a.force, 1e-12) << angle;
    EXPECT_NEAR(norm(a.torque - Vec3d{{0, 0, 3}}), 0, 1e-12) << angle;
  }
}

TEST(TorqueLoads, PushAndPullOnAnEdgeThatRunsAround) {
  for (const char* angle : {"", "angle = [0, \"180 degree\"], "}) {
    const Acting a = acting(tube("shell", angle, "{ group = \"from\" }", "total_torque"));
    EXPECT_EQ(norm(a.torque), 0) << angle;
    EXPECT_NEAR(norm(a.moment - Vec3d{{0, 0, 3}}), 0, 1e-12) << angle;
  }
}

/// A closed edge has a lever however flat it is: det I over (tr I)³ of this one is that of an arc of 120°.
TEST(TorqueLoads, PushAndPullOnAFlatEdgeThatIsClosed) {
  const auto stem = std::filesystem::temp_directory_path() / ("flat_tube_" + std::to_string(getpid()));
  const std::filesystem::path mesh = stem.string() + ".obj", path = stem.string() + ".toml";
  std::ofstream file(mesh);
  for (const char* z : {"0", "0.5"})
    for (const char* xy : {"-0.1 -0.02", "0.1 -0.02", "0.1 0.02", "-0.1 0.02"}) file << "v " << xy << " " << z << "\n";
  for (int k = 1; k <= 4; ++k) {
    const int next = k % 4 + 1;
    file << "f " << k << " " << next << " " << next + 4 << "\nf " << k << " " << next + 4 << " " << k + 4 << "\n";
  }
  file.close();
  std::ofstream(path) << "[bodies.tube]\nmodel = \"shell\"\ndomain = { file = \"" << mesh.filename().string()
                      << "\" }\nthickness = 0.001\nmass = 1\nmaterial = { young = 1e6, poisson = 0.3 }\n"
                      << "[[loads]]\nbody = \"tube\"\n"
                      << "where = { box = { min = [-1, -1, -0.01], max = [1, 1, 0.01] } }\ntotal_torque = [0, 0, 3]\n"
                      << "[solver]\nkind = \"implicit-euler\"\ntime_step = 0.01\nduration = 0.1\n";
  const Acting a = acting(build_simulation(parse_scene_file(path, {})));
  std::filesystem::remove(path);
  std::filesystem::remove(mesh);
  EXPECT_EQ(norm(a.torque), 0);
  EXPECT_NEAR(norm(a.moment - Vec3d{{0, 0, 3}}), 0, 1e-12);
}

TEST(TorqueLoads, SayThatARigidBodyHasNoGroups) {
  try {
    tube("rigid", "", "{ group = \"from\" }", "total_force");
    FAIL();
  } catch (const SceneError& e) {
    EXPECT_NE(std::string(e.what()).find("only bodies of elements and shells keep the groups of a mesh"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace fascia::app::torque_loads_test
