// Pressure on surfaces that nodes move: forces and tangents against differences, resultants, volumes.
#include "core/body/body_surface.hpp"
#include "core/executor/executor.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/unit/fem/surface_models.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>

namespace fascia::surface_load_test {
namespace {

using namespace test;

enum class Kind { pressure, bulk, weight, all };

struct Case {
  std::string name;
  std::function<Loaded()> build;
  Kind kind = Kind::all;
};

void add_load(Loaded& built, Kind kind, const std::vector<BodyFace>& faces) {
  SurfaceLoad load = surface_of(*built.body, faces);
  if (kind == Kind::pressure || kind == Kind::all) load.pressure = 800;
  if (kind == Kind::bulk || kind == Kind::all) {
    load.bulk_modulus = 5e4;
    load.volume = 1.3 * load.rest_volume;
  }
  if (kind == Kind::weight || kind == Kind::all) load.weight = {{300, -2000, 500}};
  load.weight_schedule = 1;
  built.model.surfaces.push_back(load);
}

class SurfaceLoadTest : public testing::TestWithParam<Case> {
 protected:
  SurfaceLoadTest()
      : built_(make()), executor_(built_.model.points, pool_), state_(random_state(built_.model, 0.06, 0.4)) {}
  static Loaded make() {
    Loaded built = GetParam().build();
    add_load(built, GetParam().kind, built.body->faces());
    return built;
  }
  std::vector<double> forces(const State& state, double* energy = nullptr) {
    std::vector<double> out(at(built_.model.dof_count()));
    const double e = add_surface_forces(loads_, built_.model, state, factors_, out);
    if (energy != nullptr) *energy = e;
    return out;
  }
  double energy(const State& state) {
    double e = 0;
    forces(state, &e);
    return e;
  }
  /// Of the loads alone: the material's part is taken off.
  Linearization linearization() {
    std::vector<double> unused(at(built_.model.dof_count()));
    executor_.gradient(state_, {}, unused);
    Linearization lin;
    executor_.linearize(state_, {}, Tangent::full, lin);
    forces(state_);
    add_surface_tangent(loads_, built_.model, factors_, lin);
    return lin;
  }
  std::vector<double> product(const Linearization& lin, const std::vector<double>& d) {
    std::vector<double> with(d.size()), without(d.size());
    executor_.multiply(lin, d, with);
    std::vector<double> unused(d.size());
    Linearization material;
    executor_.linearize(state_, {}, Tangent::full, material);
    executor_.multiply(material, d, without);
    for (std::size_t i = 0; i < d.size(); ++i) with[i] -= without[i];
    return with;
  }

  Loaded built_;
  ThreadPool pool_{1};
  CpuExecutor executor_;
  State state_;
  std::vector<double> factors_{0.7, 0.9};
  Surfaces<PoolSpace> loads_{built_.model, PoolSpace(pool_)};
};

TEST_P(SurfaceLoadTest, ForcesAreTheGradientOfTheEnergy) {
  const std::vector<double> d = random_direction(built_.model), f = forces(state_);
  ASSERT_TRUE(built_.model.surfaces[0].closed);
  const double h = 1e-6;
  const double numeric =
      (energy(moved(built_.model, state_, d, h)) - energy(moved(built_.model, state_, d, -h))) / (2 * h);
  const double error = std::abs(numeric + test::dot(f, d)) / (test::norm(f) * test::norm(d));
  std::printf("%-24s forces against differences of the energy: %.1e\n", GetParam().name.c_str(), error);
  EXPECT_LT(error, 1e-8);
}

TEST_P(SurfaceLoadTest, TangentIsTheSecondDerivativeAlongExponentials) {
  const std::vector<double> d = random_direction(built_.model), Kd = product(linearization(), d);
  // Richardson: the second difference to fourth order.
  const auto second = [&](double h) {
    return (energy(moved(built_.model, state_, d, h)) - 2 * energy(state_) +
            energy(moved(built_.model, state_, d, -h))) /
           (h * h);
  };
  const double numeric = (4 * second(1e-3) - second(2e-3)) / 3;
  const double error = std::abs(numeric - test::dot(d, Kd)) / (test::norm(d) * test::norm(Kd));
  std::printf("%-24s tangent against second differences: %.1e\n", GetParam().name.c_str(), error);
  EXPECT_LT(error, 1e-7);
}

TEST_P(SurfaceLoadTest, ProductIsTheDerivativeOfTheForcesAndSymmetric) {
  const std::vector<double> d = random_direction(built_.model), e = random_direction(built_.model, 9),
                            f = forces(state_);
  const Linearization lin = linearization();
  std::vector<double> Kd = product(lin, d);
  EXPECT_NEAR(test::dot(e, Kd), test::dot(d, product(lin, e)), 1e-12 * test::norm(Kd) * test::norm(e));
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
  const double error = test::norm(difference) / test::norm(Kd);
  std::printf("%-24s product against differences of the forces: %.1e\n", GetParam().name.c_str(), error);
  EXPECT_LT(error, 1e-8);
}

TEST_P(SurfaceLoadTest, AssembledEqualsTheProductWithoutTheRankOneTerm) {
  Linearization lin = linearization();
  lin.loads.volumes.clear();
  BlockMatrix matrix(built_.model.points, built_.model.surfaces);
  executor_.assemble(lin, matrix);
  const std::vector<double> d = random_direction(built_.model);
  std::vector<double> assembled(d.size()), free(d.size());
  matrix.multiply(pool_, d, assembled);
  executor_.multiply(lin, d, free);
  for (std::size_t i = 0; i < d.size(); ++i) assembled[i] -= free[i];
  EXPECT_LT(test::norm(assembled), 1e-12 * test::norm(free));
}

TEST_P(SurfaceLoadTest, ClosedSurfacesPushNothingButWeigh) {
  SurfaceForces f;
  evaluate(built_.model.surfaces[0], state_, factors_, f);
  Vec3d sum;
  double sizes = 0;
  for (const Vec3d& v : f.force) {
    sum += v;
    sizes += norm(v);
  }
  const Vec3d expected = built_.model.surfaces[0].weight * (factors_[1] * f.volume);
  EXPECT_LT(norm(sum - expected), 1e-12 * sizes);
}

std::vector<Case> cases() {
  return {{"tet4_pressure", [] { return elements(ElementShape::tet4); }, Kind::pressure},
          {"tet4_bulk", [] { return elements(ElementShape::tet4); }, Kind::bulk},
          {"tet4_weight", [] { return elements(ElementShape::tet4); }, Kind::weight},
          {"tet4", [] { return elements(ElementShape::tet4); }},
          {"tet10", [] { return elements(ElementShape::tet10); }},
          {"hex8", [] { return elements(ElementShape::hex8); }},
          {"hex20", [] { return elements(ElementShape::hex20); }},
          {"rigid_frames",
           [] {
             return frames(false, {2, 1, 1});
           }},
          {"affine_frames",
           [] {
             return frames(true, {2, 1, 1});
           }},
          {"scattered_frames", scattered}};
}

INSTANTIATE_TEST_SUITE_P(Surfaces, SurfaceLoadTest, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

/// Volume of a body's elements against that inside its surface, and its change against displacements.
TEST(EnclosedVolume, IsThatOfTheElements) {
  for (const ElementShape shape : {ElementShape::tet4, ElementShape::tet10, ElementShape::hex8, ElementShape::hex20}) {
    Loaded built = elements(shape);
    add_load(built, Kind::pressure, built.body->faces());
    // The rule of ten-node tetrahedra is exact for degree 2, the Jacobian of curved ones of degree 3.
    const double allowed = shape == ElementShape::tet10 ? 1e-5 : 1e-12, volume = built.model.surfaces[0].rest_volume;
    EXPECT_NEAR(volume, built.body->volume(), allowed) << static_cast<int>(shape);
    const SurfaceLoad turned = surface_of(*built.body, turned_over(built.body->faces()));
    EXPECT_NEAR(turned.rest_volume, -volume, 1e-14) << static_cast<int>(shape);
  }
}

TEST(EnclosedVolume, IsKeptByRigidMotionsAndSoAreTheForces) {
  Loaded built = elements(ElementShape::tet10);
  add_load(built, Kind::pressure, built.body->faces());
  const std::vector<double> factors{1, 1};
  const Mat3d D = rotation_increment({{0.4, 2, -1}});
  SurfaceForces rest, turned;
  evaluate(built.model.surfaces[0], State::at_rest(built.model), factors, rest);
  evaluate(built.model.surfaces[0], rigid_state(built.model, D, {{10, -3, 5}}), factors, turned);
  EXPECT_NEAR(turned.volume, rest.volume, 1e-13);
  for (std::size_t v = 0; v < rest.force.size(); ++v)
    EXPECT_LT(norm(turned.force[v] - (rest.force[v] + D * rest.force[v])), 1e-11 * norm(rest.force[v]) + 1e-11);
}

TEST(OpenSurfaces, HaveNoEnergyAndAreNotConservative) {
  Loaded built = elements(ElementShape::hex8);
  std::vector<BodyFace> faces = built.body->faces();
  faces.pop_back();
  EXPECT_EQ(free_edges(faces).size(), 4u);
  add_load(built, Kind::pressure, faces);
  EXPECT_FALSE(built.model.surfaces[0].closed);
  EXPECT_FALSE(built.model.loads_are_conservative());
  SurfaceForces f;
  evaluate(built.model.surfaces[0], random_state(built.model, 0.05, 0), std::vector<double>{1, 1}, f);
  EXPECT_EQ(f.energy, 0);
}

/// Where the free edges stay, the force is the gradient of −p V.
TEST(OpenSurfaces, HaveAnEnergyWhereTheirEdgesAreHeld) {
  Loaded built = elements(ElementShape::hex8);
  std::vector<BodyFace> faces = built.body->faces();
  faces.pop_back();
  add_load(built, Kind::pressure, faces);
  SurfaceLoad& load = built.model.surfaces[0];
  load.has_potential = true;
  EXPECT_TRUE(built.model.loads_are_conservative());
  std::vector<double> d = random_direction(built.model);
  for (const auto& edge : free_edges(faces))
    for (const int node : edge) std::fill_n(d.begin() + 3 * static_cast<std::ptrdiff_t>(node), 3, 0.0);
  const State state = random_state(built.model, 0.06, 0);
  const std::vector<double> factors{1, 1};
  SurfaceForces f, plus, minus;
  evaluate(load, state, factors, f);
  const double h = 1e-6;
  evaluate(load, moved(built.model, state, d, h), factors, plus);
  evaluate(load, moved(built.model, state, d, -h), factors, minus);
  std::vector<double> force(d.size());
  Surfaces<PoolSpace> loads(built.model);
  add_surface_forces(loads, built.model, state, factors, force);
  EXPECT_NEAR((minus.energy - plus.energy) / (2 * h), test::dot(force, d), 1e-8 * test::norm(force) * test::norm(d));
}

/// A pressure on the flat face of an element is shared as its shape functions say.
TEST(OpenSurfaces, ShareAPressureByShapeFunctions) {
  ElementOptions o;
  o.distortion = 0;
  o.cells = {1, 1, 1};
  for (const auto& [shape, corner] : {std::pair{ElementShape::hex8, 0.25}, std::pair{ElementShape::hex20, -1.0 / 12}}) {
    o.shape = shape;
    ElementModel built = element_model(o);
    SurfaceLoad load = surface_of(*built.body, {built.body->faces()[0]});
    load.pressure = 1;
    SurfaceForces f;
    evaluate(load, State::at_rest(built.model), std::vector<double>{1, 1}, f);
    Vec3d sum;
    for (const Vec3d& v : f.force) sum += v;
    EXPECT_NEAR(dot(f.force[0], sum) / squared_norm(sum), corner, 1e-12);
  }
}

TEST(ConnectedFaces, ArePartsOfASurface) {
  Loaded built = elements(ElementShape::tet4);
  std::vector<BodyFace> faces = built.body->faces();
  const std::size_t count = faces.size(), points = built.body->surface().points.size();
  for (std::size_t f = 0; f < count; ++f) {
    BodyFace apart = faces[f];
    for (int& p : apart) p += static_cast<int>(points);
    faces.push_back(apart);
  }
  const auto parts = connected_faces(faces);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].size(), count);
}

}  // namespace
}  // namespace fascia::surface_load_test
