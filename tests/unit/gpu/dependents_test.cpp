#include "core/step/dependents.hpp"

#include "core/tangent/condensation.hpp"
#include "tests/support/dependent_models.hpp"
#include "tests/support/plain_dependents.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>

/// Dependent nodes in the spaces of the host against their formulas.
namespace fascia::gpu::test::dependents_test {
namespace {

using namespace fascia::test;

/// Null where no node turns.
Mat3d* matrices(FrameMatrices& m) { return m.values().empty() ? nullptr : &m[0]; }

class DependentsTest : public testing::TestWithParam<std::string> {
 protected:
  DependentsTest()
      : built_(coupled_model(GetParam())),
        model_(built_->model),
        state_(placed(model_)),
        host_(model_, state_),
        reference_(model_.points, state_),
        dependents_(model_.points),
        of_pool_(model_.points, PoolSpace(pool_)) {
    dependents_.turn(matrices(state_.D));
    of_pool_.turn(matrices(state_.D));
  }

  static State placed(const Model& model) {
    State state = random_state(model, 0.03, 0.7);
    place_dependents(model.points, state);
    return state;
  }

  std::unique_ptr<CoupledModel> built_;
  const Model& model_;
  State state_;
  HostModel host_;
  ThreadPool pool_{3};
  PlainDependents reference_;
  Dependents<HostSpace> dependents_;
  Dependents<PoolSpace> of_pool_;
  std::vector<double> d_ = random_direction(model_);
};

INSTANTIATE_TEST_SUITE_P(, DependentsTest, testing::ValuesIn(kWaysToDepend), [](const auto& parameter) {
  std::string name = parameter.param;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// Places and rates by node, one after the other.
std::vector<double> flat(const std::vector<Vec3d>& x, const FrameMatrices& D) {
  std::vector<double> values;
  for (const Vec3d& v : x) values.insert(values.end(), v.v, v.v + 3);
  for (const Mat3d& m : D.values()) values.insert(values.end(), &m.m[0][0], &m.m[0][0] + 9);
  return values;
}

TEST_P(DependentsTest, PlacesAndRates) {
  State expected = random_state(model_, 0.1, 1, 3);
  const State rates = random_state(model_, 2, 1, 4);
  expected.v = rates.u;
  expected.Q_dot = rates.D;
  State state = expected;
  State on_pool = expected;
  PlainDependents::place(model_.points, expected.u, expected.D);
  PlainDependents::place(model_.points, expected.v, expected.Q_dot);
  dependents_.place(state.u.data(), matrices(state.D));
  dependents_.place_rates(state.v.data(), matrices(state.Q_dot));
  EXPECT_LE(relative(flat(state.u, state.D), flat(expected.u, expected.D)), 1e-15);
  EXPECT_LE(relative(flat(state.v, state.Q_dot), flat(expected.v, expected.Q_dot)), 1e-15);
  of_pool_.place(on_pool.u.data(), matrices(on_pool.D));
  EXPECT_LE(relative(flat(on_pool.u, on_pool.D), flat(expected.u, expected.D)), 1e-15);
}

/// Where the hosts' increments take a dependent node is where their end takes it.
TEST_P(DependentsTest, Increments) {
  const State increment = random_state(model_, 0.1, 1, 3);
  std::vector<Vec3d> du = increment.u;
  FrameMatrices Ds = increment.D;
  for (std::size_t i = 0; i < du.size(); ++i)
    if (model_.frame_kind[i] == FrameKind::vertex) Ds[i] = {};
  State end = state_;
  for (std::size_t i = 0; i < du.size(); ++i) {
    end.u[i] += du[i];
    end.D[i] = model_.frame_kind[i] == FrameKind::rigid ? compose_increments(Ds[i], state_.D[i]) : Ds[i] + state_.D[i];
  }
  place_dependents(model_.points, end);
  dependents_.place_increments(du.data(), matrices(Ds), matrices(state_.D));
  for (const DependentNode& d : model_.points.dependents) {
    const auto i = at(d.node);
    EXPECT_LT(norm(state_.u[i] + du[i] - end.u[i]), 1e-13);
    if (!d.turns) continue;
    EXPECT_LT(norm(compose_increments(Ds[i], state_.D[i]) - end.D[i]), 1e-13);
  }
}

TEST_P(DependentsTest, Directions) {
  std::vector<double> expected = d_, d = d_, on_pool = d_;
  reference_.expand(expected);
  std::vector<Vec3d> dx(state_.u.size());
  std::vector<Mat3d> dA(dx.size());
  dependents_.expand(host_.nodes(), d.data(), dx.data(), dA.data(), host_.Q());
  EXPECT_LE(relative(d, expected), 1e-15);
  of_pool_.expand(host_.nodes(), on_pool.data());
  EXPECT_LE(relative(on_pool, expected), 1e-15);
  for (const DependentNode& v : model_.points.dependents) {
    const double* own = d.data() + model_.points.dofs.begin(v.node);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(dx[at(v.node)][k], own[k]);
    const Mat3d turned = v.turns ? frame_variation(FrameKind::rigid, own + 3, host_.Q()[v.node]) : Mat3d{};
    EXPECT_LT(norm(dA[at(v.node)] - turned), 1e-15);
  }
}

TEST_P(DependentsTest, Forces) {
  std::vector<double> expected = d_, g = d_, forces(6 * model_.points.dependents.size()), kept = forces;
  reference_.transfer(expected, kept);
  dependents_.transfer(host_.nodes(), g.data(), forces.data());
  EXPECT_LE(relative(g, expected), 1e-14);
  EXPECT_LE(relative(forces, kept), 1e-14);
  std::vector<double> on_pool = d_, kept_on_pool = kept;
  of_pool_.transfer(host_.nodes(), on_pool.data(), kept_on_pool.data());
  EXPECT_LE(relative(on_pool, expected), 1e-14);
  EXPECT_LE(relative(kept_on_pool, kept), 1e-14);
  EXPECT_EQ(dependents_.leverage(), of_pool_.leverage());

  std::vector<double> expected_blocks(model_.points.dofs.block_total()), blocks = expected_blocks;
  reference_.add_turning(kept, expected_blocks);
  dependents_.add_turning(host_.nodes(), kept.data(), blocks.data());
  EXPECT_LE(relative(blocks, expected_blocks), 1e-14);
}

/// Against the condensed matrix of nodes that nothing joins; blocks that are positive definite stay so.
TEST_P(DependentsTest, OwnBlocks) {
  const DofLayout& dofs = model_.points.dofs;
  BlockMatrix K(model_.points);
  std::vector<double> blocks(dofs.block_total());
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int node = 0; node < model_.node_count(); ++node) {
    const int n = dofs.size(node);
    double* block = blocks.data() + dofs.block_begin(node);
    for (int r = 0; r < n; ++r)
      for (int c = 0; c <= r; ++c) block[n * r + c] = block[n * c + r] = r == c ? 20.0 : uniform(random);
    std::copy_n(block, n * n, K.block(K.diagonal(node)));
  }
  Condensation(of_pool_, dofs, pool_).condense(K);
  dependents_.add_diagonal(host_.nodes(), blocks.data());
  std::vector<double> expected(blocks.size());
  for (int node = 0; node < model_.node_count(); ++node)
    std::copy_n(K.block(K.diagonal(node)), dofs.size(node) * dofs.size(node), expected.data() + dofs.block_begin(node));
  for (const DependentNode& d : model_.points.dependents)
    for (int k = 0; k < dependent_dofs(d, dofs); ++k)
      expected[dofs.block_begin(d.node) + at(k * (dofs.size(d.node) + 1))] = 1;
  if (GetParam() != "chain") {  // there, hosts that depend themselves have blocks with each other
    EXPECT_LE(relative(blocks, expected), 1e-14);
  }
  for (int node = 0; node < model_.node_count(); ++node) {
    const int n = dofs.size(node);
    const double* block = blocks.data() + dofs.block_begin(node);
    for (int r = 0; r < n; ++r) EXPECT_GT(block[n * r + r], 0);
  }
}

TEST(RowSums, AreTheSameForEveryLengthOfRows) {
  constexpr int kRows = 5;
  const int lengths[kRows] = {0, 7, 33, 1100, 40000};
  std::vector<int> row_of_item;
  for (int row = 0; row < kRows; ++row) row_of_item.insert(row_of_item.end(), at(lengths[row]), row);
  row_of_item.insert(row_of_item.end(), 10, -1);
  std::shuffle(row_of_item.begin(), row_of_item.end(), std::mt19937(3));
  std::vector<long> sums(kRows), largest(kRows);
  RowSums<HostSpace>(row_of_item, kRows)
      .sum<1, 1>(
          [](int i, Sums<1, 1>& s) {
            s.v[0] += i;
            s.note(0, i);
          },
          [&](int row, const Sums<1, 1>& s) {
            sums[at(row)] = static_cast<long>(s.v[0]);
            largest[at(row)] = static_cast<long>(s.largest[0]);
          });
  std::vector<long> expected(kRows), expected_largest(kRows);
  for (std::size_t i = 0; i < row_of_item.size(); ++i) {
    if (row_of_item[i] < 0) continue;
    expected[at(row_of_item[i])] += static_cast<long>(i);
    expected_largest[at(row_of_item[i])] = static_cast<long>(i);
  }
  EXPECT_EQ(sums, expected);
  EXPECT_EQ(largest, expected_largest);
}

}  // namespace
}  // namespace fascia::gpu::test::dependents_test
