// Tangents of loads without a potential: against differences of the forces, and their eigenvalues against dense ones.
#include "core/body/body_surface.hpp"
#include "core/node/node_force.hpp"
#include "core/node/node_load.hpp"
#include "core/run/drivers.hpp"
#include "core/solver/mechanical_system.hpp"
#include "tests/unit/fem/surface_models.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <complex>
#include <functional>

namespace fascia::unsymmetric_loads_test {
namespace {

using namespace test;

enum class Kind { pressure, follower, torque, dead_torque };

struct Case {
  std::string name;
  std::function<Loaded()> build;
  Kind kind = Kind::pressure;
};

/// Weights, arms and gradients of six nodes that reproduce constant and linear fields about as well as a body's do.
FollowerLoad follower(const Model& model, bool vertices) {
  FollowerLoad load;
  std::mt19937 random(3);
  const auto number = [&] { return static_cast<double>(random()) / 4294967295.0; };
  Vec3d mean;
  for (int node = 0; node < 6; ++node) mean += model.rest_position[at(node)] * (1.0 / 6);
  Mat3d spread;
  for (int node = 0; node < 6; ++node) {
    const Vec3d r = model.rest_position[at(node)] - mean;
    spread += outer(r, r);
  }
  spread += Mat3d::diagonal(1e-2);
  for (int node = 0; node < 6; ++node) {
    load.nodes.push_back(node);
    load.w.push_back(vertices ? 1.0 / 6 : 0.1 + number());
    load.b.push_back({{number() - 0.5, number() - 0.5, number() - 0.5}});
    if (vertices) load.g.push_back(inverse(spread) * (model.rest_position[at(node)] - mean));
  }
  double sum = 0;
  for (const double w : load.w) sum += w;
  for (double& w : load.w) w /= sum;
  return load;
}

void add_load(Loaded& built, Kind kind) {
  Model& model = built.model;
  const bool vertices = model.kind(0) == FrameKind::vertex;
  if (kind == Kind::pressure) {
    std::vector<BodyFace> faces = built.body->faces();
    faces.resize(faces.size() / 2);
    model.surfaces.push_back(surface_of(*built.body, faces));
    model.surfaces.back().pressure = 800;
    return;
  }
  if (kind == Kind::dead_torque) {
    model.loads.push_back({0, {{1, {{30, 10, -20}}, {}, {{15, -40, 25}}}}});
    return;
  }
  FollowerLoad load = follower(model, vertices);
  (kind == Kind::follower ? load.force : load.torque) = {{120, -60, 200}};
  model.followers.push_back(load);
}

class UnsymmetricLoads : public testing::TestWithParam<Case> {
 protected:
  UnsymmetricLoads()
      : built_(make()), executor_(built_.model.points, pool_), state_(random_state(built_.model, 0.06, 0.4)) {}
  static Loaded make() {
    Loaded built = GetParam().build();
    add_load(built, GetParam().kind);
    return built;
  }
  std::size_t size() const { return at(built_.model.dof_count()); }
  std::vector<double> forces(const State& state) {
    const Model& model = built_.model;
    std::vector<double> out(size());
    const auto add = [&](int node, const Vec3d& force, const Mat3d& couple, const Vec3d& torque) {
      add_node_force(model.kind(node), state.D[at(node)], force, couple, torque,
                     out.data() + model.points.dofs.begin(node));
    };
    for (const DeadLoad& load : model.loads)
      for (const NodeLoad& n : load.nodes) add(n.node, n.force * 0.7, n.couple * 0.7, n.torque * 0.7);
    for (const FollowerLoad& load : model.followers) for_each_share(load, state, 0.7, add);
    add_surface_forces(loads_, model, state, factors_, out);
    return out;
  }
  /// Of the loads alone.
  std::vector<double> product(const std::vector<double>& d) {
    const Model& model = built_.model;
    std::vector<double> unused(size()), with(size()), without(size());
    executor_.gradient(state_, {}, unused);
    Linearization lin;
    executor_.linearize(state_, {}, Tangent::full, lin);
    executor_.multiply(lin, d, without);
    add_surface_forces(loads_, model, state_, factors_, unused);
    add_surface_tangent(loads_, model, factors_, lin);
    for (const FollowerLoad& load : model.followers) lin.loads.followers.emplace_back(load, state_, 0.7);
    for (const DeadLoad& load : model.loads)
      for (const NodeLoad& n : load.nodes) lin.loads.torques.push_back({n.node, n.torque * 0.7});
    EXPECT_FALSE(lin.loads.symmetric());
    executor_.multiply(lin, d, with);
    lin.loads.add_unsymmetric_product(model.points, lin.Q, d, with);
    for (std::size_t i = 0; i < size(); ++i) with[i] -= without[i];
    return with;
  }

  Loaded built_;
  ThreadPool pool_{1};
  CpuExecutor executor_;
  State state_;
  std::vector<double> factors_{0.7, 0.7};
  Surfaces<PoolSpace> loads_{built_.model, PoolSpace(pool_)};
};

TEST_P(UnsymmetricLoads, ProductIsTheDerivativeOfTheForces) {
  const std::vector<double> d = random_direction(built_.model), f = forces(state_);
  std::vector<double> Kd = product(d);
  for (int node = 0; node < built_.model.node_count(); ++node) {  // as for the internal forces: − ½ [torque]×
    if (built_.model.kind(node) != FrameKind::rigid) continue;
    const auto i = at(built_.model.points.dofs.begin(node));
    const Vec3d torque{{-f[i + 3], -f[i + 4], -f[i + 5]}}, dr{{d[i + 3], d[i + 4], d[i + 5]}};
    const Vec3d correction = cross(torque, dr) * 0.5;
    for (std::size_t k = 0; k < 3; ++k) Kd[i + 3 + k] -= correction[static_cast<int>(k)];
  }
  const double h = 1e-5;
  const std::vector<double> plus = forces(moved(built_.model, state_, d, h)),
                            minus = forces(moved(built_.model, state_, d, -h));
  std::vector<double> difference(d.size());
  for (std::size_t i = 0; i < d.size(); ++i) difference[i] = (minus[i] - plus[i]) / (2 * h) - Kd[i];
  const double error = test::norm(difference) / (test::norm(Kd) + test::norm(f) * test::norm(d));
  std::printf("%-24s product against differences of the forces: %.1e\n", GetParam().name.c_str(), error);
  EXPECT_LT(error, 1e-9);
}

Loaded of_frames(bool affine) { return frames(affine, {2, 1, 1}); }

std::vector<Case> cases() {
  const auto hex8 = [] { return elements(ElementShape::hex8); };
  const auto rigid = [] { return of_frames(false); };
  const auto affine = [] { return of_frames(true); };
  return {{"hex8_pressure", hex8},
          {"tet10_pressure", [] { return elements(ElementShape::tet10); }},
          {"hex20_pressure", [] { return elements(ElementShape::hex20); }},
          {"rigid_pressure", rigid},
          {"affine_pressure", affine},
          {"hex8_follower", hex8, Kind::follower},
          {"rigid_follower", rigid, Kind::follower},
          {"affine_follower", affine, Kind::follower},
          {"hex8_torque", hex8, Kind::torque},
          {"rigid_torque", rigid, Kind::torque},
          {"affine_torque", affine, Kind::torque},
          {"rigid_dead_torque", rigid, Kind::dead_torque}};
}

INSTANTIATE_TEST_SUITE_P(Loads, UnsymmetricLoads, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

/// A bar of hexahedra, held at one end; a pressure follows the face at the other, and forces of fixed direction push
/// it.
ElementModel bar(double pressure, double push) {
  ElementOptions o;
  o.shape = ElementShape::hex8;
  o.young = 1;
  ElementModel built =
      element_model(o, generate_box({}, {{6, 1, 1}}, {6, 1, 1}, {family_of(o.shape), order_of(o.shape), 6}));
  for (int node = 0; node < built.model.node_count(); ++node) {
    if (built.model.rest_position[at(node)][0] > 1e-6) continue;
    FrameConstraint held;
    held.node = node;
    held.translations = 3;
    built.model.constraints.push_back(held);
  }
  std::vector<BodyFace> end;
  for (const BodyFace& face : built.body->faces())
    if (std::all_of(face.begin(), face.end(),
                    [&](int point) { return built.body->surface().points[at(point)][0] > 6 - 1e-6; }))
      end.push_back(face);
  built.model.surfaces.push_back(surface_of(*built.body, end));
  built.model.surfaces.back().pressure = pressure;
  DeadLoad dead;
  for (int node = 0; node < built.model.node_count(); ++node)
    if (built.model.rest_position[at(node)][0] > 6 - 1e-6) dead.nodes.push_back({node, {{-push / 4, 0, 0}}, {}, {}});
  built.model.loads.push_back(dead);
  return built;
}

/// Real negative eigenvalues of the free degrees of freedom of vertices, from all of the matrix.
int negative_eigenvalues(const Model& model, ThreadPool& pool, const State& state) {
  CpuExecutor executor(model.points, pool);
  const DofFilter filter(model);
  const std::size_t n = at(model.dof_count());
  std::vector<double> unused(n), d(n), Kd(n);
  executor.gradient(state, {}, unused);
  Linearization lin;
  executor.linearize(state, {}, Tangent::full, lin);
  Surfaces<PoolSpace> loads(model);
  const std::vector<double> factors{1, 1};
  add_surface_forces(loads, model, state, factors, unused);
  add_surface_tangent(loads, model, factors, lin);
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < n; ++i)
    if (!filter.is_fixed(i)) free.push_back(i);
  const int size = static_cast<int>(free.size());
  Eigen::MatrixXd K(size, size);
  for (int c = 0; c < size; ++c) {
    std::fill(d.begin(), d.end(), 0.0);
    d[free[at(c)]] = 1;
    executor.multiply(lin, d, Kd);
    lin.loads.add_unsymmetric_product(model.points, lin.Q, d, Kd);
    for (int r = 0; r < size; ++r) K(r, c) = Kd[free[at(r)]];
  }
  const Eigen::VectorXcd values = Eigen::EigenSolver<Eigen::MatrixXd>(K, false).eigenvalues();
  int negative = 0;
  double least = 1e300;
  std::complex<double> softest;
  for (const std::complex<double> value : values) {
    if (value.imag() == 0 && value.real() < 0) ++negative;
    if (std::abs(value) < least) softest = value, least = std::abs(value);
  }
  std::printf(" softest %.3e %+.3ei", softest.real(), softest.imag());
  return negative;
}

/// At 10 E the dense solver finds two of -5.6e-7, which rounding made: the symmetric part is positive definite.
TEST(UnsymmetricTangent, ItsNegativeEigenvaluesAreCounted) {
  int most = 0;
  for (const auto& [pressure, push] : {std::pair{0.1, 0.0},
                                       {0.5, 0.0},
                                       {1.0, 0.0},
                                       {2.0, 0.0},
                                       {5.0, 0.0},
                                       {-0.05, 0.0},
                                       {-0.1, 0.0},
                                       {-0.15, 0.0},
                                       {1e-3, 0.02},
                                       {1e-3, 0.05},
                                       {-0.02, 0.08}}) {
    const ElementModel built = bar(pressure, push);
    ThreadPool pool(1);
    SolverSettings settings;
    settings.tolerance = 1e-10;
    MechanicalSystem system(built.model, pool, settings);
    State state = State::at_rest(built.model);
    const RunReport report = run_statics(
        system, state, [](double t) { return std::vector<double>(2, t); }, settings, {1}, nullptr);
    ASSERT_EQ(report.status, RunStatus::converged) << report.message;
    const Stability found = system.stability(state, 0, true);
    std::printf("pressure %6.3f E, push %.2f E: %d iterations,", pressure, push, report.newton_iterations);
    const int negative = negative_eigenvalues(built.model, pool, state);
    std::printf(", %d negative, %d found, near a limit point %d\n", negative, found.unstable,
                static_cast<int>(found.near_limit));
    EXPECT_TRUE(found.known);
    EXPECT_EQ(found.unstable, negative);
    most = std::max(most, negative);
  }
  EXPECT_GE(most, 4) << "straight columns beyond their second Euler load, in two planes";
}

}  // namespace
}  // namespace fascia::unsymmetric_loads_test
