#include "tests/unit/meshless/shared_models.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdio>
#include <functional>

/// Meshless bodies whose frames are nodes of other bodies too.
namespace fascia::shared_test {
namespace {

using namespace test;

struct Case {
  std::string name;
  HostOptions host;
  std::function<void(SharedModel&)> add;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  std::vector<Case> all;
  const std::pair<HostKind, std::string> hosts[] = {{HostKind::frames, "frames"},
                                                    {HostKind::turning, "turning"},
                                                    {HostKind::still, "still"},
                                                    {HostKind::rigid, "rigid"}};
  for (const auto& [kind, name] : hosts) {
    HostOptions host;
    host.kind = kind;
    all.push_back({name + "_grid", host, [](SharedModel& s) { add_grid(s); }});
    all.push_back({name + "_linear_grid", host, [](SharedModel& s) {
                     BlockOptions o;
                     o.weights = GridWeightKind::linear;
                     add_grid(s, o);
                   }});
    all.push_back({name + "_mls", host, [](SharedModel& s) { add_cloud(s, unit_scatter(SpacedChoice{0.34, 1})); }});
    all.push_back({name + "_affine_mls", host, [](SharedModel& s) {
                     BlockOptions o;
                     o.affine = true;
                     add_cloud(s, unit_scatter(SpacedChoice{0.34, 1}), o);
                   }});
    host.cells = 8;
    all.push_back({name + "_fine_mls", host, [](SharedModel& s) { add_cloud(s, unit_scatter(SpacedChoice{0.5, 1})); }});
    host.cells = 1;
    all.push_back({name + "_coarse_mls", host, [](SharedModel& s) {
                     add_cloud(s, unit_scatter(SpacedChoice{0.25, 1}));
                   }});
    if (kind == HostKind::still) continue;
    host.cells = 4;
    const std::pair<ScatteredKind, std::string> kernels[] = {{ScatteredKind::wendland, "wendland"},
                                                             {ScatteredKind::cubic_spline, "spline"},
                                                             {ScatteredKind::shepard, "shepard"}};
    for (const auto& [weights, kernel] : kernels)
      all.push_back({name + "_" + kernel, host, [weights = weights](SharedModel& s) {
                       BlockOptions o;
                       o.half_blend = false;
                       add_cloud(s, unit_scatter(SpacedChoice{0.34, 1}, weights), o);
                     }});
  }
  return all;
}

class Shared : public testing::TestWithParam<Case> {
 protected:
  Shared() {
    add_host(s_, GetParam().host);
    GetParam().add(s_);
    s_.finish();
  }
  bool still() const { return GetParam().host.kind == HostKind::still; }
  std::size_t size() const { return at(s_.model.dof_count()); }
  /// Own nodes and shared ones.
  std::vector<int> nodes() const {
    std::vector<int> nodes = s_.body->shared_nodes();
    for (int k = 0; k < s_.body->node_count(); ++k) nodes.push_back(s_.body->first_node() + k);
    return nodes;
  }

  SharedModel s_;
  ThreadPool pool_{1};
};

TEST_P(Shared, TakesOtherNodesBesideItsOwn) {
  const ModelBody& body = *s_.body;
  EXPECT_FALSE(body.shared_nodes().empty());
  EXPECT_TRUE(std::is_sorted(body.shared_nodes().begin(), body.shared_nodes().end()));
  EXPECT_LT(body.shared_nodes().back(), body.first_node());
  EXPECT_EQ(body.first_node() + body.node_count(), s_.model.node_count());
  EXPECT_EQ(body.nodes_on_boundary().size(), at(body.node_count()) + body.shared_nodes().size());
  const auto check = [](const Attachment& a) {
    EXPECT_EQ(std::adjacent_find(a.nodes.begin(), a.nodes.end(), std::greater_equal<>()), a.nodes.end());
    double sum = 0;
    for (const Influence& i : a.influences) sum += i.w;
    EXPECT_NEAR(sum, 1, 1e-12);
  };
  std::size_t through = 0;
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const Attachment a = body.attach_point(q);
    check(a);
    through += a.nodes.front() < body.first_node() ? 1 : 0;
  }
  check(body.attach({{0, 0.4, 0.3}}));
  EXPECT_GT(through, 0U);
}

TEST_P(Shared, RigidMotionHasNoEnergy) {
  CpuExecutor executor(s_.model.points, pool_);
  std::vector<double> unused(size());
  State turned = rigid_state(s_.model, rotation_increment({{0.7, -1.1, 2.0}}), {{1, 2, 3}});
  for (int i = 0; i < s_.model.node_count(); ++i)
    if (s_.model.kind(i) == FrameKind::vertex) turned.D[at(i)] = {};
  EXPECT_LT(executor.gradient(turned, {}, unused).total(), 1e-22 * 1e4);
}

TEST_P(Shared, LinearFieldsGiveTheirGradient) {
  if (GetParam().host.kind == HostKind::rigid) return;  // a rigid body cannot follow
  const Case& c = GetParam();
  if (c.name.find("mls") == std::string::npos && c.name.find("grid") == std::string::npos) return;
  const Mat3d H = Mat3d::from_columns({{0.01, 0.02, -0.01}}, {{0.03, -0.02, 0.01}}, {{0, 0.01, 0.02}});
  State state = State::at_rest(s_.model);
  for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] = H * s_.model.rest_position[i];
  double worst = 0;
  for (std::size_t q = 0; q < s_.body->points().size(); ++q) {
    const FieldValue f = field_at(s_.body->attach_point(q), state);
    worst = std::max(worst, norm(f.H - H));
    EXPECT_LT(norm(f.u - H * s_.body->points()[q].X), 1e-11);
  }
  std::printf("%-20s F of a linear field: %.1e off\n", c.name.c_str(), worst);
  EXPECT_LT(worst, 1e-10 * norm(H));
}

/// What the body adds to its own and the shared nodes is its matter's momentum.
TEST_P(Shared, InertiaIsThatOfTheMatter) {
  const Vec3d spin{{0.3, 0.5, -0.2}}, velocity{{1, 0.5, 2}};
  Momentum added;
  for (std::size_t i = 0; i < s_.model.inertia.size(); ++i) {
    const Vec3d& X = s_.model.rest_position[i];
    const auto of = [&](const FrameInertia& inertia) {
      return momentum_of(inertia, X, Mat3d::identity(), velocity + cross(spin, X), skew(spin), {});
    };
    const Momentum m = of(s_.model.inertia[i]), host = i < s_.before.size() ? of(s_.before[i]) : Momentum{};
    added.mass += m.mass - host.mass;
    added.kinetic_energy += m.kinetic_energy - host.kinetic_energy;
    added.angular += m.angular - host.angular;
    EXPECT_GT(m.mass, 0);
    if (s_.model.frame_kind[i] == FrameKind::vertex) {
      EXPECT_EQ(norm(s_.model.inertia[i].second), 0);
    }
  }
  double energy = 0;
  Vec3d angular;
  for (const BodyPoint& p : s_.body->points()) {
    const Vec3d v = velocity + cross(spin, p.X);
    energy += 0.5 * 1000 * p.volume * squared_norm(v);
    angular += cross(p.X, v) * (1000 * p.volume);
  }
  EXPECT_NEAR(added.mass, 1000, 1e-9);
  if (still()) return;  // a vertex carries mass alone
  EXPECT_NEAR(added.kinetic_energy, energy, 1e-11 * energy);
  EXPECT_LT(norm(added.angular - angular), 1e-11 * norm(angular));
}

/// With the host held, no direction of the own frames is free, nor of the rotations that vertices have for them.
TEST_P(Shared, NoNodeIsWithoutStiffness) {
  CpuExecutor executor(s_.model.points, pool_);
  std::vector<double> unused(size());
  const State rest = State::at_rest(s_.model);
  executor.gradient(rest, {}, unused);
  Linearization lin;
  executor.linearize(rest, {}, Tangent::full, lin);
  std::vector<std::size_t> free;
  double least = INFINITY, most = 0;
  std::vector<double> e(size()), Ke(size());
  for (const int node : nodes()) {
    const bool own = node >= s_.body->first_node();
    const DofLayout& dofs = s_.model.points.dofs;
    for (int k = own || GetParam().host.kind != HostKind::turning ? 0 : 3; k < dofs.size(node); ++k) {
      const std::size_t dof = at(dofs.begin(node) + k);
      e[dof] = 1;
      executor.multiply(lin, e, Ke);
      e[dof] = 0;
      if (own || GetParam().host.kind == HostKind::turning) free.push_back(dof);
      least = std::min(least, Ke[dof]);
      most = std::max(most, Ke[dof]);
    }
  }
  EXPECT_GT(least, 0);
  Eigen::MatrixXd K(free.size(), free.size());
  for (std::size_t j = 0; j < free.size(); ++j) {
    e[free[j]] = 1;
    executor.multiply(lin, e, Ke);
    e[free[j]] = 0;
    for (std::size_t i = 0; i < free.size(); ++i)
      K(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = Ke[free[i]];
  }
  const Eigen::VectorXd scale = K.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * K * scale.asDiagonal(),
                                                             Eigen::EigenvaluesOnly);
  std::printf("%-20s %3d own, %3zu shared: diagonal %.1e to %.1e, eigenvalues of the scaled matrix from %.1e\n",
              GetParam().name.c_str(), s_.body->node_count(), s_.body->shared_nodes().size(), least, most,
              eigen.eigenvalues()[0]);
  EXPECT_GT(eigen.eigenvalues()[0], 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, Shared, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace fascia::shared_test
