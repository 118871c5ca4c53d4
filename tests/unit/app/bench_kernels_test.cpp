#include "app/bench/kernel_runs.hpp"
#include "app/bench/traffic.hpp"
#include "core/base/processors.hpp"

#include <gtest/gtest.h>

#include <array>

// fascia bench kernels: what it counts against counts by hand, and what it makes of times.
namespace fascia::app::bench_kernels_test {
namespace {

/// One tetrahedron: a batch of eight lanes in a patch of four nodes.
PointSet one_tetrahedron() {
  ElementBlockSpec spec;
  spec.node = {0, 1, 2, 3};
  spec.gradient = {{{-1, -1, -1}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  spec.volume = {1.0 / 6};
  spec.material.resize(1);
  PointSetBuilder builder;
  builder.add_elements(make_element_block(spec));
  return std::move(builder).finish(std::vector<FrameKind>(4, FrameKind::vertex));
}

/// Eight points of two frames.
PointSet one_group() {
  const std::array<int, 2> nodes{0, 1};
  PointSample sample;
  sample.volume = 1;
  sample.influences.assign(2, Influence{0.5, {{1, 0, 0}}, {}, Mat3d::identity() * 0.5});
  const std::vector<PointSample> samples(8, sample);
  PointSetBuilder builder;
  builder.add_points(nodes, samples, 1, {Law::st_venant_kirchhoff, Stabilization::none});
  return std::move(builder).finish(std::vector<FrameKind>(2, FrameKind::rigid));
}

/// At rest.
Linearization linearized(const PointSet& set, ThreadPool& pool) {
  State state;
  state.u.resize(at(set.node_count()));
  state.D = FrameMatrices(at(set.node_count()), set.dofs.kind(0) != FrameKind::vertex);
  CpuExecutor executor(set, pool);
  std::vector<double> gradient(at(set.dofs.total()));
  executor.gradient(state, {}, gradient);
  Linearization lin;
  executor.linearize(state, {}, Tangent::full, lin);
  return lin;
}

TEST(BenchTraffic, OfATetrahedronIsThatCountedByHand) {
  const PointSet set = one_tetrahedron();
  ThreadPool pool(1);
  const Linearization lin = linearized(set, pool);
  const BlockMatrix matrix(set);
  const TrafficCount count(set);
  // Gradients 4 × 3, volume, λ and μ, each of eight lanes; two bytes for each node of a lane, four for each of a patch.
  const double constants = (12 + 1 + 2) * 64 + 4 * 8 * 2 + 4 * 4, state = 4 * 24;
  EXPECT_EQ(count.points(), 1);
  EXPECT_EQ(count.forces().read, constants + state);
  EXPECT_EQ(count.forces().written, 12 * 8);
  EXPECT_EQ(count.forces().flops, 120 + 4 * 36);
  EXPECT_EQ(count.product(lin).read, 12 * 8 + constants + state + 4 * 9 * 8);
  EXPECT_EQ(count.product(lin).flops, 228 + 4 * 54);
  EXPECT_EQ(count.assembly(lin, matrix).read, constants + state + 4 * 9 * 8 + 10 * 8 * 4);
  EXPECT_EQ(count.assembly(lin, matrix).written, 10 * 9 * 8);
  EXPECT_FALSE(count.assembly(lin, matrix).flops.has_value());
}

TEST(BenchTraffic, OfAnAssembledProductHasBothUsesOfAnEntry) {
  const BlockMatrix matrix(one_tetrahedron());
  const Traffic traffic = assembled_product_traffic(matrix);
  EXPECT_EQ(traffic.read, 10 * 9 * 8 + 10 * 4 + 4 * 4 + 12 * 8) << "blocks on and above the diagonal, columns, rows, x";
  EXPECT_EQ(traffic.written, 12 * 8);
  EXPECT_EQ(traffic.flops, 2 * 12 * 12);
  EXPECT_EQ(axpy_traffic(10).bytes(), 480);
  EXPECT_EQ(axpy_traffic(10).working_set(), 320);
  EXPECT_EQ(dot_traffic(10).flops, 20);
}

TEST(BenchTraffic, OfAGroupIsThatCountedByHand) {
  const PointSet set = one_group();
  ThreadPool pool(1);
  const Linearization lin = linearized(set, pool);
  const TrafficCount count(set);
  // Volume, λ, μ of eight lanes; 13 rows of each of two frames, and the frame's number.
  const double constants = 3 * 64 + 2 * (13 * 64 + 4), rotations = 2 * 72, state = 2 * 24 + rotations;
  EXPECT_EQ(count.points(), 8);
  EXPECT_EQ(count.forces().read, constants + state);
  EXPECT_EQ(count.forces().flops, 8 * 120 + 16 * 144);
  EXPECT_EQ(count.linearization(lin).read, constants + state + rotations);
  EXPECT_EQ(count.linearization(lin).written, 15 * 64 + 2 * (72 + 36 * 8 + 24 + 72));
  EXPECT_EQ(count.product(lin).read, 12 * 8 + constants + 15 * 64 + 2 * 36 * 8 + rotations);
  EXPECT_EQ(count.product(lin).flops, 8 * 186 + 16 * 144);
}

TEST(BenchKernels, TimesAreTheMedianAndWhereFourOfFiveLie) {
  std::vector<double> seconds(21);
  for (int i = 0; i <= 20; ++i) seconds[at(i)] = (8 * i) % 21;
  const CallTimes t = times_of(seconds);
  EXPECT_EQ(t.calls, 21);
  EXPECT_EQ(t.median, 10);
  EXPECT_EQ(t.low, 2);
  EXPECT_EQ(t.high, 18);
  EXPECT_EQ(times_of({}).calls, 0);
}

TEST(BenchKernels, ALimitIsTheLargerOfReadingAndOfAll) {
  const MemoryRates rates{10, 8, 16};
  EXPECT_EQ(rates.seconds(100, 0), 10);
  EXPECT_EQ(rates.seconds(100, 140), 15);
  KernelRow row;
  row.memory_seconds = 2;
  row.flop_seconds = 3;
  row.time.median = 6;
  EXPECT_EQ(row.fraction(), 0.5);
}

TEST(BenchKernels, MoreThreadsThanProcessorsAreSaid) {
  EXPECT_EQ(shared_processors(1), "");
  EXPECT_NE(shared_processors(available_processors() + 1).find("threads share"), std::string::npos);
}

TEST(BenchKernels, BodiesHaveAboutAsManyPointsAsAreAskedFor) {
  for (const KernelBody body : {KernelBody::grid, KernelBody::scattered4, KernelBody::scattered8,
                                KernelBody::tetrahedra, KernelBody::hexahedra, KernelBody::shells}) {
    std::string reason;
    const std::optional<Simulation> simulation = built(body_case("test", body, 2000), reason);
    ASSERT_TRUE(simulation.has_value()) << reason;
    EXPECT_NEAR(TrafficCount(simulation->model.points).points(), 2000, 200) << static_cast<int>(body);
  }
}

}  // namespace
}  // namespace fascia::app::bench_kernels_test
