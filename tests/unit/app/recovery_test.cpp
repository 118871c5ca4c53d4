#include "app/run/recovery.hpp"
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/matter.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

// Fields at nodes from those at integration points, and the displacements of matter.
namespace fascia::app::recovery_test {
namespace {

Simulation body(const std::string& keys, const std::string& material = "material = { young = 1e4, poisson = 0.3 }\n") {
  return build_simulation(parse_scene_text(
      fmt::format("[bodies.b]\ndensity = 1000\n{}{}\n"
                  "[[constraints]]\nbody = \"b\"\nwhere = \"all\"\nfix = \"all\"\n[solver]\nkind = \"static\"\n",
                  material, keys),
      "b.toml", {}));
}

ThreadPool& one_thread() {
  static ThreadPool pool(1);
  return pool;
}

/// The field 2 + 3 x − y + 5 z.
double linear(const Vec3d& x) { return 2 + 3 * x[0] - x[1] + 5 * x[2]; }

double largest_error(const SimulatedBody& b) {
  std::vector<PointTensors> points;
  for (const BodyPoint& p : b.body->points()) points.push_back({{}, Mat3d::identity() * linear(p.X), 0});
  const std::vector<PointTensors> nodes = NodalRecovery(b).at_nodes(points, one_thread());
  double worst = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    worst = std::max(worst, std::abs(nodes[i].stress(1, 1) - linear(b.nodes[i])));
  return worst;
}

/// Exact where the points span space around or beside the node, at all corners of hexahedra too.
TEST(NodalRecovery, IsExactForLinearFields) {
  const std::string box = "domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [3, 3, 3] } }\n";
  EXPECT_LT(largest_error(body("model = \"hexahedra\"\n" + box).bodies[0]), 1e-12);
  EXPECT_LT(largest_error(body("model = \"hexahedra\"\norder = 2\n" + box).bodies[0]), 1e-12);
  const std::string plain = "domain = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
  EXPECT_LT(largest_error(body("model = \"meshless\"\nframes = { grid = [4, 4, 4] }\n" + plain).bodies[0]), 1e-12);
}

/// A single tetrahedron's constant is taken as it is: nothing is extrapolated from points that are too close.
TEST(NodalRecovery, FallsBackToTheMeanWhereThereIsNoSlope) {
  const Simulation s =
      body("model = \"tetrahedra\"\ndomain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [1, 1, 1] } }\n");
  const SimulatedBody& b = s.bodies[0];
  std::vector<PointTensors> points(b.body->points().size());
  for (PointTensors& p : points) p.energy_density = 7;
  for (const PointTensors& n : NodalRecovery(b).at_nodes(points, one_thread())) EXPECT_NEAR(n.energy_density, 7, 1e-12);
  EXPECT_LT(largest_error(b), 9);  // of a field from 1 to 10
}

/// Two layers of a bar carry stresses a hundred times apart: each end of a node's patch keeps to its own.
TEST(NodalRecovery, DoesNotGoAcrossMaterials) {
  const Simulation s = body(
      "model = \"meshless\"\nframes = { grid = [6, 3, 3] }\npoints = { per_cell = [2, 2, 2] }\n"
      "domain = { box = { min = [0, 0, 0], max = [1, 0.4, 0.4] } }\n",
      "material = [{ where = { box = { min = [-1, 0.1, -1], max = [2, 1, 1] } }, use = { young = 5e4, poisson = 0 } }, "
      "{ use = { young = 1e3, poisson = 0 } }]\n");
  const SimulatedBody& b = s.bodies[0];
  std::vector<PointTensors> points;
  for (const BodyPoint& p : b.body->points()) points.push_back({{}, Mat3d::identity() * (p.mu * 0.02), 0});
  const double soft = 1e3 / 2 * 0.02, stiff = 5e4 / 2 * 0.02;
  for (const PointTensors& n : NodalRecovery(b).at_nodes(points, one_thread())) {
    const double value = n.stress(0, 0);
    EXPECT_LT(std::min(std::abs(value - soft), std::abs(value - stiff)), 1e-9 * stiff) << value;
  }
}

/// Points that lie in a plane have no slope across it, however the plane is turned.
TEST(NodalRecovery, SeesNoSlopeAcrossAPlane) {
  const Simulation s = body(
      "model = \"meshless\"\nthickness = 0.01\nframes = { grid = [11, 3] }\n"
      "points = { per_cell = [3, 3], through = 1 }\n"
      "transform = { rotate = { axis = [1, 2, 3], angle = 0.7 } }\n"
      "domain = { rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 0.2, 0] } }\n");
  EXPECT_LT(largest_error(s.bodies[0]), 1e-11);
}

/// Corner frames of a ball's grid lie outside and move further than the ball when it turns.
TEST(Matter, LeavesFramesOutsideOfItOut) {
  const Simulation s = body(
      "model = \"meshless\"\ndomain = { sphere = { center = [0, 0, 0], radius = 1 } }\nframes = { grid = [4, 4, 4] "
      "}\n");
  State state = State::at_rest(s.model);
  double farthest = 0;
  for (int i = 0; i < s.model.node_count(); ++i) {
    const Vec3d X = s.model.rest_position[static_cast<std::size_t>(i)];
    state.u[static_cast<std::size_t>(i)] = X * 0.1;  // a uniform stretch
    farthest = std::max(farthest, norm(X) * 0.1);
  }
  MatterDisplacement displacement;
  displacement.add(s.bodies[0], state);
  EXPECT_GT(farthest, 0.12);
  EXPECT_NEAR(displacement.largest(), 0.1, 2e-3);
  EXPECT_LT(norm(displacement.mean()), 1e-3);
}

}  // namespace
}  // namespace fascia::app::recovery_test
