#include "core/step/followers.hpp"

#include "core/node/node_force.hpp"
#include "tests/support/models.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

/// Followers in the spaces of the host against those of the model.
namespace fascia::gpu::test::followers_test {
namespace {

using namespace fascia::test;

std::vector<double> reference_forces(const Model& model, const State& state, const std::vector<double>& factors) {
  std::vector<double> out(at(model.dof_count()));
  for (const FollowerLoad& load : model.followers)
    for_each_share(load, state, factors[at(load.schedule)],
                   [&](int node, const Vec3d& force, const Mat3d& couple, const Vec3d& torque) {
                     add_node_force(model.kind(node), state.D[at(node)], force, couple, torque,
                                    out.data() + model.points.dofs.begin(node));
                   });
  return out;
}

/// On so many nodes; some nodes have several followers.
FollowerLoad random_follower(const Model& model, int schedule, int count, bool vertices, std::mt19937& random) {
  std::vector<int> nodes(at(model.node_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  std::shuffle(nodes.begin(), nodes.end(), random);
  nodes.resize(at(std::min(count, model.node_count())));
  FollowerLoad load{schedule, random_vector(random, 3), random_vector(random, 2), nodes, {}, {}, {}};
  const double share = 1.0 / static_cast<double>(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    load.w.push_back(share * (1 + 0.3 * random_vector(random, 1)[0]));
    load.b.push_back(random_vector(random, share));
    if (vertices) load.g.push_back(random_vector(random, share));
  }
  return load;
}

void expect_same_forces(Model model, bool vertices, double turn) {
  std::mt19937 random(7);
  for (const auto& [schedule, count] : {std::pair{1, 1}, std::pair{0, 3}, std::pair{1, 100000}, std::pair{0, 40}})
    model.followers.push_back(random_follower(model, schedule, count, vertices, random));
  const State state = random_state(model, 0.1, turn);
  const std::vector<double> factors{0.7, -1.3};
  const HostModel host(model, state);
  std::vector<double> load = random_direction(model), expected = reference_forces(model, state, factors);
  for (std::size_t i = 0; i < load.size(); ++i) expected[i] += load[i];
  std::vector<double> on_pool = load;
  Followers<HostSpace>(model).add_forces(host.nodes(), host.pose(), factors.data(), load.data());
  EXPECT_LE(relative(load, expected), 1e-14);
  ThreadPool pool(3);
  Followers<PoolSpace> followers(model, PoolSpace(pool));
  followers.add_forces(host.nodes(), host.pose(), factors.data(), on_pool.data());
  EXPECT_LE(relative(on_pool, expected), 1e-14);
}

TEST(FollowersTest, OnRigidFrames) {
  BlockOptions o;
  o.grid = {12, 11, 10};
  expect_same_forces(block(o).model, false, 0.5);
}

TEST(FollowersTest, OnAffineFrames) {
  BlockOptions o;
  o.grid = {3, 3, 3};
  o.affine = true;
  expect_same_forces(block(o).model, false, 0.5);
}

TEST(FollowersTest, OnVertices) {
  BlockOptions o;
  o.grid = {12, 11, 10};
  expect_same_forces(vertex_block(o), true, 0);
}

TEST(FollowersTest, AreNone) {
  const Model model = block().model;
  EXPECT_TRUE(Followers<HostSpace>(model).empty());
}

}  // namespace
}  // namespace fascia::gpu::test::followers_test
