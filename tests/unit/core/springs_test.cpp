#include "core/physics/spring_law.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/modes.hpp"
#include "tests/support/derivatives.hpp"

#include <gtest/gtest.h>

#include <numbers>

/// Springs to fixed points: their law by differences, alone and on nodes of a body, and what solvers make of them.
namespace fascia::springs_test {
namespace {

using namespace test;

struct SpringCase {
  std::string name;
  FrameKind kind;
  double dt = 0;
};

/// A block on springs of all kinds: along a direction, in tension, in compression, and without a length at rest.
BuiltModel on_springs(FrameKind kind) {
  BlockOptions o;
  o.grid = {3, 2, 2};
  o.affine = kind == FrameKind::affine;
  BuiltModel built;
  PointSetBuilder points;
  built.bodies.emplace_back(block_spec(o), built.model, points);
  const std::vector<Vec3d>& X = built.model.rest_position;
  points.add_spring({0, 3000, X[0], {}, normalized(Vec3d{{1, 2, -2}})});
  points.add_spring({2, 5000, X[2], X[2] + Vec3d{{0.3, 0.1, 0}}, {}});
  points.add_spring({2, 4000, X[2], X[2] - Vec3d{{0, 0.2, 0.1}}, {}});
  points.add_spring({5, 2000, X[5], X[5], {}});
  if (kind == FrameKind::rigid) {
    const Vec3d arm{{0.2, -0.1, 0.3}};
    points.add_spring({3, 2500, X[3] + arm, X[3] - arm, {}, arm});
    points.add_spring({3, 1500, X[3] - arm, {}, normalized(Vec3d{{2, 1, 2}}), -arm});
  }
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

class SpringsTest : public DerivativeTest<SpringCase, BuiltModel> {
 protected:
  SpringsTest() : DerivativeTest(on_springs(tested().kind), 0.1, 0.6) {}
};

INSTANTIATE_TEST_SUITE_P(, SpringsTest,
                         testing::Values(SpringCase{"rigid", FrameKind::rigid},
                                         SpringCase{"affine", FrameKind::affine}),
                         [](const auto& test) { return test.param.name; });

TEST_P(SpringsTest, GradientOfTheEnergy) { expect_gradient_of_the_energy(); }
TEST_P(SpringsTest, SecondDerivative) { expect_second_derivative_along_exponentials(); }
TEST_P(SpringsTest, DerivativeOfTheGradient) {
  if (tested().kind == FrameKind::rigid) expect_differences_to_be_tangent_minus_half_torque();
}
TEST_P(SpringsTest, AssembledEqualsProduct) { expect_assembled_equals_product(); }
TEST_P(SpringsTest, MaterialTangentIsNotNegative) { expect_symmetric_and_not_negative(); }

TEST_P(SpringsTest, EnergiesAndForces) {
  const std::vector<Spring>& springs = built_.model.points.springs;
  const double all = energy(state_);
  double sum = 0;
  for (std::size_t k = 0; k < springs.size(); ++k) {
    sum += executor_.energies().springs[k];
    EXPECT_GT(executor_.energies().springs[k], 0);
    const Vec3d u = state_.u[at(springs[k].node)] + state_.D[at(springs[k].node)] * springs[k].arm;
    const Vec3d force = SpringExecutor::force(springs[k], state_);
    EXPECT_LE(norm(force + spring_gradient(springs[k], u)), 1e-14 * norm(force));
  }
  Model without = built_.model;
  without.points.springs.clear();
  CpuExecutor body(without.points, pool_);
  std::vector<double> unused(size());
  EXPECT_NEAR(all - body.gradient(state_, history_, unused).total(), sum, 1e-13 * all);
}

TEST(SpringLaw, TellsTheLengthOfSmallDisplacements) {
  const Spring spring{0, 1000, {{1, 0, 0}}, {{-2, 0, 0}}, {}};
  EXPECT_NEAR(spring_stretch(spring, {{1e-18, 0, 0}}).stretch, 1e-18, 1e-32);
  EXPECT_NEAR(spring_energy(spring, {{-0.5, 0, 0}}), 125, 1e-12);
}

TEST(SpringLaw, IsFiniteWhereTheNodeMeetsThePoint) {
  const Spring spring{0, 1000, {{1, 0, 0}}, {}, {}};
  const Vec3d u{{-1, 0, 0}};
  EXPECT_EQ(spring_gradient(spring, u), (Vec3d{{-1000, 0, 0}}));
  EXPECT_EQ(spring_tangent(spring, u, true)(0, 0), 1000);
  EXPECT_EQ(spring_tangent(spring, u, true)(1, 1), 0);
}

/// A rigid frame of 2 kg alone on three springs: statics, its frequencies, and the explicit limit 2/ω.
TEST(Springs, HoldAFrameAlone) {
  Model model;
  PointSetBuilder points;
  const Vec3d X{{0.3, 0.2, 0.1}};
  model.rest_position = {X};
  model.rest_orientation = {Mat3d::identity()};
  model.frame_kind = {FrameKind::rigid};
  model.inertia = {{2, {}, Mat3d::diagonal(0.01)}};
  points.join({0}, 0.1);
  const double k[3] = {200, 800, 3200};
  for (int a = 0; a < 3; ++a) {
    Vec3d n;
    n[a] = 1;
    points.add_spring({0, k[a], X, {}, n});
  }
  model.points = std::move(points).finish(model.frame_kind);
  FrameConstraint c;
  c.rotations = 3;
  model.constraints = {c};
  add_gravity(model, {{1, 2, -10}});
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  State state = State::at_rest(model);
  const RunReport report = run_statics(system, state, kRamp, {}, {}, nullptr);
  ASSERT_EQ(report.status, RunStatus::converged) << report.message;
  EXPECT_LT(norm(state.u[0] - Vec3d{{2 / k[0], 4 / k[1], -20 / k[2]}}), 1e-15);
  const Modes modes = natural_modes(model, pool, 3);
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(modes.frequency[a], std::sqrt(k[a] / 2) / (2 * std::numbers::pi), 1e-9 * modes.frequency[a]);
  EXPECT_NEAR(stable_time_step(system), kStableMargin * 2 / std::sqrt(k[2] / 2), 1e-9);
}

}  // namespace
}  // namespace fascia::springs_test
