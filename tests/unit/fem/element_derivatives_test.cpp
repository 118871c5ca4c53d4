#include "tests/support/derivatives.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <ostream>
#include <string>

namespace fascia::element_derivatives_test {
namespace {

using namespace test;

struct Case {
  std::string name;
  ElementOptions options;
  double dt = 0;
};

/// Each law on each shape, with the terms that it can have.
std::vector<Case> cases() {
  using enum ElementShape;
  using enum ElementFormulation;
  std::vector<Case> all;
  const auto add = [&](const std::string& name, ElementShape shape, auto change) {
    ElementOptions o;
    o.shape = shape;
    if (order_of(shape) == 2) o.cells = {1, 1, 1};
    change(o);
    all.push_back({name, o, o.stiffness_damping > 0 ? 0.05 : 0});
  };
  const std::pair<ElementShape, std::string> shapes[] = {
      {tet4, "tet4"}, {tet10, "tet10"}, {hex8, "hex8"}, {hex20, "hex20"}};
  for (const auto& [shape, name] : shapes) {
    add("linear_" + name, shape, [](ElementOptions& o) { o.formulation = linear; });
    add("corotational_" + name, shape, [](ElementOptions& o) { o.formulation = corotational; });
    add("svk_" + name, shape, [](ElementOptions&) {});
    add("neo_hookean_" + name, shape, [](ElementOptions& o) { o.law = Law::neo_hookean; });
    add("mooney_rivlin_" + name, shape, [](ElementOptions& o) { o.law = Law::mooney_rivlin; });
    add("corotational_viscous_" + name, shape, [](ElementOptions& o) {
      o.formulation = corotational;
      o.stiffness_damping = 0.02;
    });
    add("neo_hookean_viscous_" + name, shape, [](ElementOptions& o) {
      o.law = Law::neo_hookean;
      o.stiffness_damping = 0.02;
    });
    add("linear_fading_" + name, shape, [](ElementOptions& o) {
      o.formulation = linear;
      o.viscosity = two_branches();
    });
    add("corotational_fading_" + name, shape, [](ElementOptions& o) {
      o.formulation = corotational;
      o.viscosity = two_branches(true);
    });
    add("mooney_rivlin_fading_" + name, shape, [](ElementOptions& o) {
      o.law = Law::mooney_rivlin;
      o.viscosity = two_branches(true);
    });
  }
  add("svk_acting_tet4", tet4, [](ElementOptions& o) { o.active = askew_muscle(3e3); });
  add("mooney_rivlin_acting_hex20", hex20, [](ElementOptions& o) {
    o.law = Law::mooney_rivlin;
    o.active = askew_muscle(3e3);
  });
  add("corotational_acting_and_fading_hex8", hex8, [](ElementOptions& o) {
    o.formulation = corotational;
    o.active = askew_muscle(3e3);
    o.viscosity = two_branches();
  });
  add("svk_fading_tet4", tet4, [](ElementOptions& o) { o.viscosity = two_branches(); });
  add("neo_hookean_fading_hex8", hex8, [](ElementOptions& o) {
    o.law = Law::neo_hookean;
    o.viscosity = two_branches();
  });
  add("neo_hookean_averaged_fading", tet4, [](ElementOptions& o) {
    o.locking = ElementLocking::averaged;
    o.law = Law::neo_hookean;
    o.poisson = 0.49;
    o.viscosity = two_branches();
  });
  add("svk_viscous_tet4", tet4, [](ElementOptions& o) { o.stiffness_damping = 0.02; });
  add("linear_viscous_tet4", tet4, [](ElementOptions& o) {
    o.formulation = linear;
    o.stiffness_damping = 0.02;
  });
  add("svk_penalty_tet4", tet4, [](ElementOptions& o) { o.penalty = 1e5; });
  add("linear_penalty_tet4", tet4, [](ElementOptions& o) {
    o.formulation = linear;
    o.penalty = 1e5;
  });
  add("corotational_penalty_tet10", tet10, [](ElementOptions& o) {
    o.formulation = corotational;
    o.penalty = 1e5;
  });
  add("svk_averaged", tet4, [](ElementOptions& o) { o.locking = ElementLocking::averaged; });
  add("neo_hookean_averaged", tet4, [](ElementOptions& o) {
    o.locking = ElementLocking::averaged;
    o.law = Law::neo_hookean;
    o.poisson = 0.49;
  });
  add("mooney_rivlin_averaged_viscous", tet4, [](ElementOptions& o) {
    o.locking = ElementLocking::averaged;
    o.law = Law::mooney_rivlin;
    o.poisson = 0.49;
    o.stiffness_damping = 0.02;
  });
  add("averaged_viscous_penalty", tet4, [](ElementOptions& o) {
    o.locking = ElementLocking::averaged;
    o.stiffness_damping = 0.02;
    o.penalty = 1e5;
  });
  return all;
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class ElementDerivatives : public DerivativeTest<Case, ElementModel> {
 protected:
  ElementDerivatives() : DerivativeTest(element_model(GetParam().options), 0.03, 0) { turn(state_); }
  /// Adds a rotation of half a radian.
  void turn(State& state) const {
    const Mat3d D = rotation_increment(Vec3d{{0.3, -0.4, 0.1}});
    for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i] += D * (built_.model.rest_position[i] + state.u[i]);
  }
};

TEST_P(ElementDerivatives, GradientIsThatOfTheEnergy) { expect_gradient_of_the_energy(); }

TEST_P(ElementDerivatives, TangentIsTheDerivativeOfTheGradient) {
  const std::vector<double> d = random_direction(built_.model);
  expect_derivative_of_the_gradient(d, product(linearization(Tangent::full), d));
}

TEST_P(ElementDerivatives, AssembledMatrixEqualsTheProduct) { expect_assembled_equals_product(); }

TEST_P(ElementDerivatives, ExtrapolatedStressesAreOfSecondOrder) { expect_extrapolation_of_second_order(); }

TEST_P(ElementDerivatives, MaterialTangentIsSymmetricAndNotNegative) { expect_symmetric_and_not_negative(); }

TEST_P(ElementDerivatives, ForcesWithoutEnergiesAreTheSame) {
  const std::vector<double> g = gradient(state_);
  std::vector<double> f(size());
  executor_.forces(state_, history_, f);
  EXPECT_EQ(f, g);
}

/// Forces and their moments about any point vanish; a rotation costs nothing, except for small-strain elements.
TEST_P(ElementDerivatives, InternalForcesBalance) {
  const std::vector<double> g = gradient(state_);
  Vec3d force, moment;
  for (int i = 0; i < built_.model.node_count(); ++i) {
    const Vec3d f{{g[at(3 * i)], g[at(3 * i + 1)], g[at(3 * i + 2)]}};
    force += f;
    moment += cross(built_.model.rest_position[at(i)] + state_.u[at(i)], f);
  }
  EXPECT_LT(norm(force), 1e-12 * test::norm(g));
  const bool linear = GetParam().options.formulation == ElementFormulation::linear;
  const bool viscous = GetParam().dt > 0 && GetParam().options.formulation == ElementFormulation::corotational;
  if (linear) {
    EXPECT_GT(norm(moment), 1e-4 * test::norm(g));
  } else if (!viscous) {
    EXPECT_LT(norm(moment), 1e-12 * test::norm(g));
  }
  if (GetParam().dt > 0 || !memory_.empty()) return;  // a stress of the past works along rounding
  const double turned = energy(rigid_state(built_.model, rotation_increment(Vec3d{{0, 1, 2}}), {{1, 2, 3}}));
  const double scale = GetParam().options.young * built_.body->volume();
  if (linear)
    EXPECT_GT(turned, 1e-2 * scale);
  else
    EXPECT_LT(turned, 1e-24 * scale);
}

INSTANTIATE_TEST_SUITE_P(Laws, ElementDerivatives, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

/// The slow reference: the same elements as ordinary points of a point set whose nodes are vertices.
TEST(ElementReference, BlocksEqualOrdinaryPoints) {
  for (const ElementShape shape : {ElementShape::tet4, ElementShape::tet10, ElementShape::hex8, ElementShape::hex20}) {
    for (const Law law : kSolidLaws) {
      ElementOptions o;
      o.shape = shape;
      o.law = law;
      const ElementModel built = element_model(o);
      const ElementBody& body = *built.body;
      PointSetBuilder builder;
      for (std::size_t q = 0; q < body.points().size(); ++q) {
        const BodyPoint& p = body.points()[q];
        const Attachment a = body.attach_point(q);
        const PointSample sample{p, p.X, p.volume, 0, 0, a.influences, {}};
        builder.add_points(a.nodes, std::span(&sample, 1), 1, {p.law, Stabilization::none, false});
      }
      const PointSet set = std::move(builder).finish(built.model.frame_kind);
      const State state = random_state(built.model, 0.03, 0);
      ThreadPool pool(1);
      CpuExecutor blocks(built.model.points, pool), points(set, pool);
      std::vector<double> f(at(built.model.dof_count())), g = f, Kf = f, Kg = f;
      const double energy = blocks.gradient(state, {}, f).total(), reference = points.gradient(state, {}, g).total();
      EXPECT_NEAR(energy, reference, 1e-12 * reference);
      Linearization of_blocks, of_points;
      blocks.linearize(state, {}, Tangent::full, of_blocks);
      points.linearize(state, {}, Tangent::full, of_points);
      const std::vector<double> d = random_direction(built.model);
      blocks.multiply(of_blocks, d, Kf);
      points.multiply(of_points, d, Kg);
      const double scale = test::norm(g), stiff = test::norm(Kg);
      for (std::size_t i = 0; i < f.size(); ++i) {
        EXPECT_NEAR(f[i], g[i], 1e-12 * scale);
        EXPECT_NEAR(Kf[i], Kg[i], 1e-12 * stiff);
      }
    }
  }
}

/// Frames and vertices in one model: each as it is alone, the matrix as the product.
TEST(ElementReference, StandBesideFrames) {
  ElementBodySpec spec;
  spec.mesh = distorted_mesh({});
  spec.density = 1000;
  spec.material = [](const Vec3d&, int) { return PointMaterialSpec{{{5e3, 4e3}}, 0, 0}; };
  Model model;
  PointSetBuilder points;
  const GridBody frames(block_spec({}), model, points);
  const ElementBody elements(std::move(spec), model, points);
  model.points = std::move(points).finish(model.frame_kind);
  EXPECT_EQ(model.dof_count(), 6 * frames.node_count() + 3 * elements.node_count());
  EXPECT_EQ(model.points.part_count(), 2);
  const State state = random_state(model, 0.02, 0.3);
  ThreadPool pool(2);
  CpuExecutor executor(model.points, pool);
  const auto n = at(model.dof_count());
  std::vector<double> g(n), Kd(n), assembled(n);
  executor.gradient(state, {}, g);
  Linearization lin;
  executor.linearize(state, {}, Tangent::full, lin);
  const std::vector<double> d = random_direction(model);
  executor.multiply(lin, d, Kd);
  BlockMatrix matrix(model.points);
  EXPECT_FALSE(matrix.fills_upper());
  executor.assemble(lin, matrix);
  matrix.multiply(pool, d, assembled);
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(assembled[i], Kd[i], 1e-12 * test::norm(Kd));
}

/// Averages reach the neighbours of neighbours by law: also those that another law's elements are about.
TEST(ElementReference, AveragedElementsOfAllLawsInOneBody) {
  ElementBodySpec spec;
  ElementOptions o;
  o.cells = {3, 3, 2};
  spec.mesh = distorted_mesh(o);
  spec.locking = ElementLocking::averaged;
  spec.density = 1000;
  spec.material = [](const Vec3d&, int element) {
    const Law law = kSolidLaws[element % kSolidLawCount];
    return PointMaterialSpec{{{5e3, 4e3}, own_constants(law, 4e3)}, 0, 0, law};
  };
  const ElementModel built = element_model(std::move(spec));
  const State state = random_state(built.model, 0.02, 0);
  ThreadPool pool(2);
  CpuExecutor executor(built.model.points, pool);
  const auto n = at(built.model.dof_count());
  std::vector<double> g(n), Kd(n), assembled(n);
  executor.gradient(state, {}, g);
  Linearization lin;
  executor.linearize(state, {}, Tangent::full, lin);
  const std::vector<double> d = random_direction(built.model);
  executor.multiply(lin, d, Kd);
  BlockMatrix matrix(built.model.points);
  executor.assemble(lin, matrix);
  matrix.multiply(pool, d, assembled);
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(assembled[i], Kd[i], 1e-12 * test::norm(Kd));
}

/// An element turned inside out keeps a proper rotation: energy and forces stay finite and agree.
TEST(ElementReference, CorotationalElementsSurviveInversion) {
  ElementOptions o;
  o.formulation = ElementFormulation::corotational;
  o.cells = {1, 1, 1};
  const ElementModel built = element_model(o);
  State state = State::at_rest(built.model);
  for (std::size_t i = 0; i < state.u.size(); ++i) state.u[i][0] = -1.7 * built.model.rest_position[i][0];
  ThreadPool pool(1);
  CpuExecutor executor(built.model.points, pool);
  std::vector<double> g(at(built.model.dof_count()));
  const auto energy = [&](const State& at_state) {
    std::vector<double> unused(g.size());
    return executor.gradient(at_state, {}, unused).total();
  };
  const double e = executor.gradient(state, {}, g).total();
  EXPECT_TRUE(std::isfinite(e));
  const std::vector<double> d = random_direction(built.model);
  const double h = 1e-6;
  const double numeric = (energy(moved(built.model, state, d, h)) - energy(moved(built.model, state, d, -h))) / (2 * h);
  EXPECT_NEAR(numeric, test::dot(g, d), 1e-7 * test::norm(g) * test::norm(d));
}

}  // namespace
}  // namespace fascia::element_derivatives_test
