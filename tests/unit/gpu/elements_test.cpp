#include "gpu/elements/elements.hpp"
#include "tests/unit/fem/element_models.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <ostream>
#include <string>

/// Elements of the GPU backend, run on the processor, against the executor.
namespace fascia::elements_test {
namespace {

using namespace test;
using HostElements = gpu::Elements<HostSpace>;

struct Case {
  std::string name;
  ElementOptions options;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

/// Each law on each shape, with every choice of penalty, damping and averages.
std::vector<Case> cases() {
  using enum ElementShape;
  struct LawCase {
    const char* name;
    ElementFormulation formulation;
    Law law = Law::st_venant_kirchhoff;
  };
  const LawCase laws[] = {{"linear", ElementFormulation::linear},
                          {"corotational", ElementFormulation::corotational},
                          {"svk", ElementFormulation::large_strain},
                          {"neo_hookean", ElementFormulation::large_strain, Law::neo_hookean},
                          {"mooney_rivlin", ElementFormulation::large_strain, Law::mooney_rivlin}};
  const std::pair<ElementShape, const char*> shapes[] = {
      {tet4, "tet4"}, {tet10, "tet10"}, {hex8, "hex8"}, {hex20, "hex20"}};
  std::vector<Case> all;
  for (const LawCase& law : laws)
    for (const auto& [shape, shape_name] : shapes)
      for (const bool averaged : {false, true})
        for (const bool penalised : {false, true})
          for (const char* past : {"", "_damped", "_fading", "_acting"}) {
            const bool damped = past == std::string("_damped"), fading = past == std::string("_fading");
            if (averaged && (shape != tet4 || law.formulation != ElementFormulation::large_strain)) continue;
            ElementOptions o;
            o.shape = shape;
            o.formulation = law.formulation;
            o.law = law.law;
            if (averaged) o.locking = ElementLocking::averaged;
            if (penalised) o.penalty = 1e5;
            if (damped) o.stiffness_damping = 0.02;
            if (fading) o.viscosity = two_branches(!averaged && penalised);
            if (past == std::string("_acting")) o.active = askew_muscle(3e3);
            if (order_of(shape) == 2) o.cells = {1, 1, 1};
            if (shape == tet4) o.cells = {3, 2, 1};  // lanes are left over
            all.push_back({std::string(law.name) + "_" + shape_name + (averaged ? "_averaged" : "") +
                               (penalised ? "_penalised" : "") + past,
                           o});
          }
  return all;
}

/// A random state, turned by half a radian.
State turned_state(const Model& model, double displacement, unsigned seed) {
  State state = random_state(model, displacement, 0, seed);
  const Mat3d D = rotation_increment(Vec3d{{0.3, -0.4, 0.1}});
  for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] += D * (model.rest_position[i] + state.u[i]);
  return state;
}

class GpuElements : public testing::TestWithParam<Case> {};

TEST_P(GpuElements, AgreeWithTheExecutor) {
  const ElementModel built = element_model(GetParam().options);
  Comparison<HostElements> comparison(built.model, turned_state(built.model, 0.03, 1),
                                      random_state(built.model, 0.01, 0, 7),
                                      GetParam().options.stiffness_damping > 0 ? 0.05 : 0);
  comparison.expect_all();
}

INSTANTIATE_TEST_SUITE_P(Laws, GpuElements, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

ElementBodySpec spec_of(const ElementOptions& o, const Vec3d& shift) {
  ElementBodySpec spec;
  spec.mesh = distorted_mesh(o);
  for (Vec3d& x : spec.mesh.nodes) x += shift;
  spec.formulation = o.formulation;
  spec.locking = o.locking;
  spec.penalty = o.penalty;
  spec.density = 1000;
  const Lame lame = Lame::from_young(o.young, o.poisson);
  spec.material = [=](const Vec3d& X, int) {
    return PointMaterialSpec{
        {{lame.lambda * (1 + X[0]), lame.mu}, own_constants(o.law, lame.mu)}, 0, o.stiffness_damping, o.law};
  };
  return spec;
}

/// Bodies of several kinds in one model: places of forces, strains and quantities of each block.
TEST(GpuElementBodies, OfSeveralBodies) {
  ElementOptions first, second, third;
  first.locking = ElementLocking::averaged;
  first.law = Law::neo_hookean;
  second.shape = ElementShape::hex20;
  second.formulation = ElementFormulation::corotational;
  second.stiffness_damping = 0.02;
  second.cells = {1, 1, 1};
  third.stiffness_damping = 0.01;
  third.law = Law::mooney_rivlin;
  Model model;
  PointSetBuilder points;
  std::vector<std::unique_ptr<ElementBody>> bodies;
  double shift = 0;
  for (const ElementOptions& o : {first, second, third})
    bodies.push_back(std::make_unique<ElementBody>(spec_of(o, {{shift += 2, 0, 0}}), model, points));
  model.points = std::move(points).finish(model.frame_kind);
  ASSERT_EQ(model.points.part_count(), 3);
  Comparison<HostElements> comparison(model, turned_state(model, 0.03, 1), random_state(model, 0.01, 0, 7), 0.05);
  comparison.expect_all();
}

/// Inside out, the rotation is found another way.
TEST(GpuElementBodies, TurnedInsideOut) {
  for (const ElementShape shape : {ElementShape::tet4, ElementShape::hex8}) {
    ElementOptions o;
    o.shape = shape;
    o.formulation = ElementFormulation::corotational;
    const ElementModel built = element_model(o);
    State state = random_state(built.model, 0.02, 0);
    for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i][0] -= 1.7 * built.model.rest_position[i][0];
    Comparison<HostElements> comparison(built.model, state, state, 0);
    comparison.expect_all();
  }
}

TEST(GpuElementBodies, AreNoneOfAModelWithoutThem) {
  const BuiltModel built = block();
  const HostElements none(built.model.points);
  EXPECT_TRUE(none.empty());
  gpu::NodeSums sums;
  none.view().add_sums(0, sums);
  EXPECT_EQ(norm(sums.force), 0);
}

}  // namespace
}  // namespace fascia::elements_test
