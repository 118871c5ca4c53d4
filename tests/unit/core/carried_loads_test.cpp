#include "core/solver/mechanical_system.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

namespace fascia::carried_loads_test {
namespace {

using namespace fascia::test;

DeadLoad load_on(int node, const Vec3d& force, const Vec3d& torque = {}) {
  DeadLoad load;
  load.nodes.push_back({node, force, {}, torque});
  return load;
}

Evaluation evaluated(const Model& model, const State& state) {
  ThreadPool pool(1);
  MechanicalSystem system(model, pool, {});
  system.set_factors(std::vector<double>(zero_factors(model).size(), 1.0));
  system.begin_step(state, 0);
  return system.evaluate();
}

/// A block with a face held, whose first clamp has oblique axes and slides along the third.
BuiltModel with_oblique_roller() {
  BuiltModel built = block();
  hold_face(built.model);
  FrameConstraint& c = built.model.constraints.front();
  c.translation_axes = rotation_about({{0.3, -0.8, 0.5}}, 0.9);
  c.translations = 2;
  return built;
}

/// A force into a clamp is the clamp's: it makes nothing that is left elsewhere look small.
TEST(CarriedLoads, SayNothingOfWhatIsLeft) {
  BuiltModel built = block();
  Model& model = built.model;
  hold_face(model);
  const int held = model.constraints.front().node, free = model.node_count() - 1;
  model.loads.push_back(load_on(free, {{0, 1, 0}}));
  const State state = random_state(model, 1e-4, 1e-4);
  const Evaluation without = evaluated(model, state);
  model.loads.push_back(load_on(held, {{1e9, -2e9, 3e9}}, {{1e9, 0, 1e9}}));
  const Evaluation with = evaluated(model, state);
  EXPECT_NEAR(with.relative, without.relative, 1e-12 * without.relative);
  EXPECT_NEAR(with.excess, without.excess, 1e-12 * without.excess);
  EXPECT_NEAR(with.left_of_load, without.left_of_load, 1e-12 * without.left_of_load);
}

/// A clamp that slides along an axis carries what acts across that axis, whatever way it points.
TEST(CarriedLoads, AreThoseInHeldDirections) {
  BuiltModel built = with_oblique_roller();
  Model& model = built.model;
  const FrameConstraint& c = model.constraints.front();
  const Vec3d across = transpose(c.translation_axes) * Vec3d{{1, 1, 0}},
              along = transpose(c.translation_axes) * Vec3d{{0, 0, 1}};
  const State state = random_state(model, 0.05, 0.05);
  model.loads = {load_on(c.node, along)};
  const Evaluation free = evaluated(model, state);
  EXPECT_GT(free.relative, 10) << "internal forces are much larger than the load";
  model.loads = {load_on(c.node, along + across * 1e6)};
  EXPECT_NEAR(evaluated(model, state).relative, free.relative, 1e-7 * free.relative);
  model.loads = {load_on(c.node, along * 1e6)};
  EXPECT_NEAR(evaluated(model, state).relative, 1, 0.01) << "this load is not carried";
}

/// Nothing acts but into a clamp whose axes are oblique: rounding of the turn must not pass for a load.
TEST(CarriedLoads, LeaveNothingInObliqueAxes) {
  BuiltModel built = block();
  Model& model = built.model;
  hold_face(model);
  FrameConstraint& c = model.constraints.front();
  c.translation_axes = rotation_about({{0.3, -0.8, 0.5}}, 0.9);
  c.rotation_axes = rotation_about({{0.7, 0.2, -0.4}}, 0.6);
  const State rest = State::at_rest(model);
  model.loads = {load_on(c.node, {{1e3, 2e3, -1e3}}, {{10, 20, 30}})};
  const Evaluation e = evaluated(model, rest);
  EXPECT_EQ(e.residual, 0);
  EXPECT_TRUE(e.converged());
  model.loads.push_back(load_on(model.node_count() - 1, {{0, 1, 0}}));
  EXPECT_NEAR(evaluated(model, rest).relative, 1, 1e-12);
}

/// The same of a roller: what the turn leaves in its free direction is known as rounding.
TEST(CarriedLoads, KnowTheRoundingOfARoller) {
  BuiltModel built = with_oblique_roller();
  Model& model = built.model;
  const FrameConstraint& c = model.constraints.front();
  const Vec3d across = transpose(c.translation_axes) * Vec3d{{1, 1, 0}};
  model.loads = {load_on(c.node, across * 1e9)};
  const Evaluation e = evaluated(model, State::at_rest(model));
  EXPECT_LT(e.residual, 1e-5);
  EXPECT_TRUE(e.converged()) << e.residual << " N, " << e.excess;
}

}  // namespace
}  // namespace fascia::carried_loads_test
