#include "gpu/tiles/tile_solver.hpp"

#include "core/executor/executor.hpp"
#include "gpu/tiles/tile_memory.cuh"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <random>

/// Tiles on a GPU against the processor's executor; skipped where there is none.
namespace fascia::tile_solver_test {
namespace {

struct TileCase {
  bool half_blend = true;
  GridWeightKind weights = GridWeightKind::trilinear;
  double drilling = 0.1;
  TileConstants constants = TileConstants::float64;
  bool resident = true;
  int shares = 1;  ///< of as many GPUs as there are
};

std::ostream& operator<<(std::ostream& out, const TileCase& c) {
  return out << (c.half_blend ? "half " : "full ") << (c.weights == GridWeightKind::linear ? "linear " : "trilinear ")
             << "drilling " << c.drilling << (c.constants == TileConstants::float32 ? " fp32" : " fp64")
             << (c.resident ? " resident" : "") << (c.shares > 1 ? " shared by " + std::to_string(c.shares) : "");
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(sum / size);
}

class TileSolverTest : public testing::TestWithParam<TileCase> {
 protected:
  void SetUp() override {
    int devices = 0;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) GTEST_SKIP() << "no GPU";
    test::BlockOptions o;
    o.grid = {7, 6, 5};
    o.half_blend = GetParam().half_blend;
    o.weights = GetParam().weights;
    o.drilling = GetParam().drilling;
    o.stiffness_damping = 0.01;
    built_ = test::build({test::block_spec(o)});
    executor_.emplace(built_.model.points, pool_);
    random_state();
    TilePointsResult points = tile_points(built_.model.points, built_.model.rest_position);
    ASSERT_EQ(points.refusal, "");
    TileSolverSettings settings{GetParam().constants, GetParam().resident};
    for (int s = 0; s < GetParam().shares; ++s) settings.devices.push_back(s % devices);
    solver_ = TileSolver::make(points.points, settings, pool_);
    ASSERT_NE(solver_, nullptr);
    ASSERT_EQ(solver_->resident(), GetParam().resident);
    tolerance_ = GetParam().constants == TileConstants::float32 ? 1e-6 : 1e-12;
  }

  double number() { return distribution_(generator_); }

  void random_state() {
    old_ = State::at_rest(built_.model);
    state_ = old_;
    for (std::size_t i = 0; i < state_.u.size(); ++i) {
      for (int a = 0; a < 3; ++a) {
        old_.u[i][a] = 0.005 * number();
        state_.u[i][a] = old_.u[i][a] + 0.002 * number();
      }
      old_.D[i] = rotation_increment({{0.02 * number(), 0.02 * number(), 0.02 * number()}});
      state_.D[i] = rotation_increment({{0.05 * number(), 0.05 * number(), 0.05 * number()}});
    }
    for (int i = 0; i < built_.model.dof_count(); ++i) direction_.push_back(number());
  }

  struct Pose {
    tile::Buffer<double> u, D;
    explicit Pose(const State& s) {
      std::vector<double> values;
      for (const Vec3d& v : s.u) values.insert(values.end(), v.v, v.v + 3);
      u.upload(values);
      values.clear();
      for (std::size_t i = 0; i < s.D.size(); ++i) values.insert(values.end(), &s.D[i].m[0][0], &s.D[i].m[0][0] + 9);
      D.upload(values);
    }
  };

  ThreadPool pool_{2};
  std::mt19937 generator_{7};
  std::uniform_real_distribution<double> distribution_{-1, 1};
  test::BuiltModel built_;
  std::optional<CpuExecutor> executor_;
  State old_, state_;
  std::vector<double> direction_;
  std::unique_ptr<TileSolver> solver_;
  double tolerance_ = 0;
};

TEST_P(TileSolverTest, AgreesWithTheProcessor) {
  StrainHistory history;
  executor_->store_strain(old_, history.E);
  history.inverse_step = 50;
  const std::size_t n = direction_.size();
  std::vector<double> gradient(n);
  const InternalEnergy energy = executor_->gradient(state_, history, gradient);

  const Pose old_pose(old_), pose(state_);
  tile::Buffer<double> b, x(n), y(n), blocks;
  b.upload(direction_);
  solver_->store_strain(old_pose.u.get(), old_pose.D.get());
  const TileEnergy found = solver_->gradient(pose.u.get(), pose.D.get(), 50, y.get(), nullptr);
  EXPECT_LT(difference(y.download(), gradient), tolerance_);
  EXPECT_NEAR(found.elastic, energy.elastic, 10 * tolerance_ * energy.elastic);
  EXPECT_NEAR(found.stabilization, energy.stabilization, 10 * tolerance_ * energy.stabilization);
  EXPECT_NEAR(found.viscous, energy.viscous, 10 * tolerance_ * energy.viscous);

  for (const Tangent tangent : {Tangent::full, Tangent::material}) {
    Linearization lin;
    executor_->linearize(state_, history, tangent, lin);
    for (std::size_t node = 0; node < n / 6; ++node)
      for (std::size_t i = 0; i < 6; ++i) lin.node_blocks[36 * node + 7 * i] += 2000 + 100 * number();
    blocks.upload(lin.node_blocks);
    solver_->linearize(pose.u.get(), pose.D.get(), tangent, 50);
    solver_->set_node_blocks(blocks.get());
    std::vector<double> product(n);
    executor_->multiply(lin, direction_, product);
    solver_->multiply(b.get(), y.get());
    EXPECT_LT(difference(y.download(), product), tolerance_);

    std::vector<std::uint8_t> held(n / 6, 0);
    for (std::size_t node = 0; node < 30; ++node) held[node] = static_cast<std::uint8_t>(node % 2 == 0 ? 63 : 5);
    const auto is_held = [&](std::size_t dof) { return (held[dof / 6] >> dof % 6 & 1) != 0; };
    solver_->set_held(held);
    solver_->build_preconditioner();
    const CgOptions options{500, 1e-9};
    const CgReport report = solver_->solve(b.get(), x.get(), options);
    EXPECT_EQ(report.status, CgStatus::converged);
    EXPECT_LT(report.iterations, 200);
    const std::vector<double> solution = x.download();
    executor_->multiply(lin, solution, product);
    double left = 0, whole = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_held(i)) {
        EXPECT_EQ(solution[i], 0);
        continue;
      }
      left += std::pow(product[i] - direction_[i], 2);
      whole += std::pow(direction_[i], 2);
    }
    EXPECT_LT(std::sqrt(left / whole), GetParam().constants == TileConstants::float32 ? 1e-5 : 1e-7);
    solver_->solve(b.get(), x.get(), options);
    EXPECT_EQ(x.download(), solution);

    EXPECT_EQ(solver_->solve(b.get(), x.get(), {3, 1e-9}).status, CgStatus::limit);
    for (double& v : lin.node_blocks) v = -1e9 * v;
    blocks.upload(lin.node_blocks);
    solver_->set_node_blocks(blocks.get());
    EXPECT_EQ(solver_->solve(b.get(), x.get(), options).status, CgStatus::negative_curvature);
    solver_->set_held({});
    solver_->set_node_blocks(nullptr);
  }
}

std::vector<TileCase> cases() {
  std::vector<TileCase> all;
  for (const bool half : {true, false})
    for (const GridWeightKind weights : {GridWeightKind::trilinear, GridWeightKind::linear})
      for (const bool resident : {true, false}) all.push_back({half, weights, 0.1, TileConstants::float64, resident});
  all.push_back({true, GridWeightKind::trilinear, 0, TileConstants::float64, true});
  all.push_back({true, GridWeightKind::trilinear, 0.1, TileConstants::float32, true});
  all.push_back({false, GridWeightKind::linear, 0, TileConstants::float32, false});
  for (const int shares : {2, 3, 4}) {
    all.push_back({true, GridWeightKind::trilinear, 0.1, TileConstants::float64, false, shares});
    all.push_back({false, GridWeightKind::linear, 0, TileConstants::float32, false, shares});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Cases, TileSolverTest, testing::ValuesIn(cases()));

}  // namespace
}  // namespace fascia::tile_solver_test
