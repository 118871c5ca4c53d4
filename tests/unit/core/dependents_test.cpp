#include "core/tangent/condensation.hpp"

#include "core/base/errors.hpp"
#include "core/executor/executor.hpp"
#include "core/structure/dependent_inertia.hpp"
#include "tests/support/dependent_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

/// Dependent nodes: energy, gradient, tangent and inertia on the degrees of freedom of their hosts.
namespace fascia::dependents_test {
namespace {

using namespace test;

class DependentNodesTest : public testing::TestWithParam<std::string> {
 protected:
  DependentNodesTest()
      : built_(coupled_model(GetParam())),
        model_(built_->model),
        executor_(model_.points, pool_),
        nodes_(nodes_of(model_.points)),
        dependents_(model_.points, PoolSpace(pool_)),
        forces_(6 * model_.points.dependents.size()),
        state_(placed(random_state(model_, 0.03, 0.7))) {}

  State placed(State state) const {
    place_dependents(model_.points, state);
    return state;
  }
  State moved_by(const std::vector<double>& d, double s) const { return placed(moved(model_, state_, d, s)); }
  double energy(const State& state) {
    std::vector<double> unused(d_.size());
    return executor_.gradient(state, {}, unused).total();
  }
  /// By degrees of freedom of what is free.
  std::vector<double> gradient(const State& state) {
    std::vector<double> g(d_.size());
    executor_.gradient(state, {}, g);
    dependents_.turn(state.D.data());
    dependents_.transfer(nodes_, g.data(), forces_.data());
    return g;
  }
  Linearization linearization() {
    gradient(state_);
    Linearization lin;
    executor_.linearize(state_, {}, Tangent::full, lin);
    dependents_.turn_to(lin.Q.data());
    dependents_.add_turning(nodes_, forces_.data(), lin.node_blocks.data());
    return lin;
  }
  BlockMatrix condensed() {
    BlockMatrix K(model_.points);
    executor_.assemble(linearization(), K);
    Condensation(dependents_, K.dofs(), pool_).condense(K);
    return K;
  }
  std::vector<double> product(const BlockMatrix& K, const std::vector<double>& d) {
    std::vector<double> Kd(d.size());
    K.multiply(pool_, d, Kd);
    return Kd;
  }

  std::unique_ptr<CoupledModel> built_;
  const Model& model_;
  ThreadPool pool_{1};
  CpuExecutor executor_;
  NodesView nodes_;
  Dependents<PoolSpace> dependents_;
  std::vector<double> forces_;
  State state_;
  std::vector<double> d_ = random_direction(model_);
};

INSTANTIATE_TEST_SUITE_P(, DependentNodesTest, testing::ValuesIn(kWaysToDepend), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

TEST_P(DependentNodesTest, RigidMotionsHaveNoEnergy) {
  const State state = placed(rigid_state(model_, rotation_increment({{0.5, -1, 0.8}}), {{1, 2, 3}}));
  const State rigid = rigid_state(model_, rotation_increment({{0.5, -1, 0.8}}), {{1, 2, 3}});
  for (std::size_t i = 0; i < state.u.size(); ++i) EXPECT_LT(norm(state.u[i] - rigid.u[i]), 1e-13);
  EXPECT_LT(energy(state), 1e-20 * energy(state_));
}

TEST_P(DependentNodesTest, GradientIsThatOfTheEnergy) {
  const double h = 1e-6;  // truncation h² and rounding eps/h balance near here
  const std::vector<double> g = gradient(state_);
  const double numeric = (energy(moved_by(d_, h)) - energy(moved_by(d_, -h))) / (2 * h);
  const double error = std::abs(numeric - dot(g, d_)) / (norm(g) * norm(d_));
  std::printf("%-28s gradient against differences of the energy: %.1e\n", GetParam().c_str(), error);
  EXPECT_LT(error, 1e-8);
}

TEST_P(DependentNodesTest, TangentIsTheSecondDerivativeOfTheEnergy) {
  const BlockMatrix K = condensed();
  const double h = 1e-4;
  const double numeric = (energy(moved_by(d_, h)) - 2 * energy(state_) + energy(moved_by(d_, -h))) / (h * h);
  const double error = std::abs(numeric - dot(d_, product(K, d_))) / std::abs(numeric);
  std::printf("%-28s dᵀKd against second differences: %.1e\n", GetParam().c_str(), error);
  EXPECT_LT(error, 1e-6);
}

/// The derivative of successive increments is K − ½ [torque]× on the rotation blocks (docs/notation.md).
TEST_P(DependentNodesTest, TangentIsTheDerivativeOfTheGradient) {
  std::vector<double> Kd = product(condensed(), d_);
  const std::vector<double> g = gradient(state_);
  for (int node = 0; node < model_.node_count(); ++node) {
    if (model_.kind(node) != FrameKind::rigid) continue;
    const std::size_t i = at(model_.points.dofs.begin(node)) + 3;
    const Vec3d half = cross({{g[i], g[i + 1], g[i + 2]}}, Vec3d{{d_[i], d_[i + 1], d_[i + 2]}}) * 0.5;
    for (int k = 0; k < 3; ++k) Kd[i + at(k)] -= half[k];
  }
  const double h = 1e-6;
  const std::vector<double> plus = gradient(moved_by(d_, h)), minus = gradient(moved_by(d_, -h));
  std::vector<double> difference(d_.size());
  for (std::size_t i = 0; i < d_.size(); ++i) difference[i] = (plus[i] - minus[i]) / (2 * h) - Kd[i];
  const double error = norm(difference) / norm(Kd);
  std::printf("%-28s Kd against differences of the gradient: %.1e\n", GetParam().c_str(), error);
  EXPECT_LT(error, 1e-8);
}

TEST_P(DependentNodesTest, CondensedMatrixIsTheProductOfItsFactors) {
  const BlockMatrix K = condensed();
  const Linearization lin = linearization();
  std::vector<double> expected(d_.size()), d = d_;
  dependents_.expand(nodes_, d.data());
  executor_.multiply(lin, d, expected);
  dependents_.transfer(nodes_, expected.data());
  std::vector<double> Kd = product(K, d_);
  for (std::size_t i = 0; i < Kd.size(); ++i) Kd[i] -= expected[i];
  EXPECT_LT(norm(Kd), 1e-13 * norm(expected));
  const std::vector<double> other = random_direction(model_, 9);
  EXPECT_NEAR(dot(other, product(K, d_)), dot(d_, product(K, other)), 1e-13 * norm(expected) * norm(other));
  for (const DependentNode& v : model_.points.dependents)
    for (int k = 0; k < dependent_dofs(v, model_.points.dofs); ++k)
      EXPECT_EQ(product(K, d_)[at(model_.points.dofs.begin(v.node) + k)], 0);
}

/// Two rows of dependent nodes are kept at the same time, or all.
TEST_P(DependentNodesTest, BitsOfTheMatrixDependOnNeitherThreadsNorRowsAtOnce) {
  const BlockMatrix K = condensed();
  const Linearization lin = linearization();
  for (const int at_once : {2, 1024}) {
    ThreadPool threads(3);
    BlockMatrix other(model_.points);
    executor_.assemble(lin, other);
    Condensation(dependents_, other.dofs(), threads, at_once).condense(other);
    EXPECT_TRUE(std::equal(K.values(), K.values() + K.value_count(), other.values()));
  }
}

TEST_P(DependentNodesTest, BothHalvesOfTheMatrixAreEqual) {
  const BlockMatrix K = condensed();
  for (int row = 0; row < K.rows(); ++row)
    for (const int column : K.columns(row)) {
      const double *block = K.block(K.find(row, column)), *mirror = K.block(K.find(column, row));
      const int n = K.dofs().size(row), m = K.dofs().size(column);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) ASSERT_EQ(block[m * i + j], mirror[n * j + i]) << row << " " << column;
    }
}

/// What moves with its hosts moves likewise: J d against differences of places.
TEST_P(DependentNodesTest, DirectionsAreThoseOfThePlaces) {
  dependents_.turn(state_.D.data());
  std::vector<double> d = d_;
  dependents_.expand(nodes_, d.data());
  const double h = 1e-6;
  const State plus = moved_by(d_, h), minus = moved_by(d_, -h);
  for (const DependentNode& v : model_.points.dependents) {
    const std::size_t i = at(model_.points.dofs.begin(v.node));
    const Vec3d numeric = (plus.u[at(v.node)] - minus.u[at(v.node)]) * (0.5 / h);
    EXPECT_LT(norm(numeric - Vec3d{{d[i], d[i + 1], d[i + 2]}}), 1e-8);
  }
}

/// Momentum and energy of a rigid motion are the same with the inertia on the hosts.
TEST_P(DependentNodesTest, InertiaOfARigidMotionStays) {
  Model lumped = model_;
  move_inertia_to_hosts(lumped);
  const Mat3d D = rotation_increment({{0.5, -1, 0.8}});
  State state = placed(rigid_state(model_, D, {{1, 2, 3}}));
  const Vec3d v{{1, 2, 3}}, w{{0.3, -2, 1}};
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    state.v[i] = v + cross(w, model_.rest_position[i] + state.u[i]);
    if (model_.frame_kind[i] != FrameKind::vertex) state.Q_dot[i] = skew(w) * (Mat3d::identity() + D);
  }
  const Momentum before = total_momentum(model_, state), after = total_momentum(lumped, state);
  EXPECT_NEAR(after.mass, before.mass, 1e-13 * before.mass);
  EXPECT_LT(norm(after.linear - before.linear), 1e-13 * norm(before.linear));
  EXPECT_LT(norm(after.first_moment - before.first_moment), 1e-12 * norm(before.first_moment));
  if (GetParam() != "tetrahedra in tetrahedra") {  // vertices take no moments
    EXPECT_LT(norm(after.angular - before.angular), 1e-12 * norm(before.angular));
    EXPECT_NEAR(after.kinetic_energy, before.kinetic_energy, 1e-12 * before.kinetic_energy);
  }
  for (const DependentNode& d : model_.points.dependents) EXPECT_EQ(lumped.inertia[at(d.node)].mass, 0);
}

TEST(DependentNodes, HostsStandBeforeTheirDependents) {
  PointSetBuilder points;
  points.add_dependent({0, {1, 4}, {0.5, 0.5}, {{}, {}}, false});
  points.add_dependent({1, {2}, {1}, {{}}, false});
  points.add_dependent({4, {1, 3}, {0.5, 0.5}, {{}, {}}, false});
  points.join({3}, 0.2);
  points.join({5}, 0.7);
  const PointSet set = std::move(points).finish(std::vector<FrameKind>(6, FrameKind::rigid));
  ASSERT_EQ(set.dependents.size(), 3u);
  EXPECT_EQ(set.dependents[0].node, 1);
  EXPECT_EQ(set.dependents[1].node, 4);
  EXPECT_EQ(set.dependents[2].node, 0);
  EXPECT_EQ(set.part_count(), 2);
  EXPECT_EQ(set.part_length, (std::vector<double>{0.2, 0.7}));
}

TEST(DependentNodes, HostsKeepPositiveMasses) {
  CoupledModel built;
  const int light = built.add_frame({}, 1), heavy = built.add_frame({{1, 0, 0}}, 20), node = built.add_frame({}, 5);
  built.points.add_dependent({node, {light, heavy}, {-0.3, 1.3}, {{}, {}}, false});
  built.finish();
  try {
    move_inertia_to_hosts(built.model);
    FAIL() << "a negative mass was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("frame at (0, 0, 0)"), std::string::npos) << error.what();
    EXPECT_EQ(error.blame, Blame::weights);
  }
}

TEST(DependentNodes, MassesThatNothingMovesMayBeNegative) {
  CoupledModel built;
  const int light = built.add_frame({}, 1), heavy = built.add_frame({{1, 0, 0}}, 20), node = built.add_frame({}, 5);
  built.points.add_dependent({node, {light, heavy}, {-0.3, 1.3}, {{}, {}}, false});
  built.finish();
  move_idle_inertia_to_hosts(built.model);
  EXPECT_DOUBLE_EQ(built.model.inertia[at(light)].mass, -0.5);
  EXPECT_DOUBLE_EQ(built.model.inertia[at(heavy)].mass, 26.5);
}

}  // namespace
}  // namespace fascia::dependents_test
