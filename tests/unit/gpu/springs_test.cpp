#include "gpu/blocks/springs.hpp"
#include "core/base/errors.hpp"
#include "core/physics/spring_law.hpp"
#include "gpu/blocks/blocks.hpp"
#include "tests/support/user_blocks.hpp"
#include "tests/unit/gpu/host_model.hpp"

/// Springs of the GPU backend, run on the processor, against the executor.
namespace fascia::springs_test {
namespace {

using namespace test;
using HostSprings = gpu::Springs<HostSpace>;

/// Frames of each kind in two parts, on springs of all kinds; rigid ones take some along by arms.
Model frames_on_springs() {
  Model model;
  PointSetBuilder points;
  model.frame_kind = {FrameKind::rigid, FrameKind::rigid, FrameKind::affine, FrameKind::vertex};
  model.rest_position = {{{0.3, 0.2, 0.1}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  model.rest_orientation.assign(4, Mat3d::identity());
  model.inertia.assign(4, {2, {}, Mat3d::diagonal(0.01)});
  const std::vector<Vec3d>& X = model.rest_position;
  const Vec3d arm{{0.2, -0.1, 0.3}};
  points.join({0, 2}, 0.1);
  points.join({1, 3}, 0.2);
  points.add_spring({2, 3000, X[2], {}, normalized(Vec3d{{1, 2, -2}})});
  points.add_spring({2, 5000, X[2], X[2] + Vec3d{{0.3, 0.1, 0}}, {}});
  points.add_spring({0, 4000, X[0], X[0] - Vec3d{{0, 0.2, 0.1}}, {}});
  points.add_spring({3, 2000, X[3], X[3], {}});
  points.add_spring({1, 2500, X[1] + arm, X[1] - arm, {}, arm});
  points.add_spring({1, 1500, X[1] - arm, {}, normalized(Vec3d{{2, 1, 2}}), -arm});
  model.points = std::move(points).finish(model.frame_kind);
  return model;
}

TEST(GpuSprings, AgreeWithTheExecutor) {
  const Model model = frames_on_springs();
  const State state = random_state(model, 0.1, 0.6);
  const HostModel host(model, state);
  HostSprings own(model.points);
  ThreadPool pool(1);
  CpuExecutor cpu(model.points, pool);
  std::vector<double> g(at(model.dof_count()));
  const double energy = cpu.gradient(state, {}, g).elastic;
  own.forces(host.nodes(), host.pose(), host.part_motion());
  expect_near(host.gathered(own.view()), g, "forces");
  const std::vector<int> parts = own.item_parts(model.points);
  EXPECT_NEAR(HostModel::sum(own.quantities(), parts, gpu::kElastic), energy, 1e-12 * energy);
  for (int part = 0; part < 2; ++part) {
    const double rounding = std::numeric_limits<double>::epsilon() *
                            std::sqrt(HostModel::sum(own.quantities(), parts, gpu::kRounding, part));
    EXPECT_NEAR(rounding, cpu.rounding(part), 1e-12 * rounding);
  }
  for (const Tangent tangent : {Tangent::full, Tangent::material}) {
    Linearization lin;
    cpu.linearize(state, {}, tangent, lin);
    std::vector<double> blocks(lin.node_blocks.size());
    own.add_blocks(host.nodes(), host.pose(), tangent, blocks.data());
    expect_near(blocks, lin.node_blocks, "blocks");
  }
}

TEST(GpuBlocks, RefuseUserBlocksByName) {
  PointSetBuilder points;
  points.add_user_block(std::make_shared<Bonds>(std::vector<Bonds::Bond>{{{0, 1}, {}}}, 1.0, 1.0));
  const PointSet set = std::move(points).finish({FrameKind::vertex, FrameKind::vertex});
  try {
    const gpu::Blocks<HostSpace> blocks(set);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "user blocks are computed on processors alone; run this model there");
  }
}

}  // namespace
}  // namespace fascia::springs_test
