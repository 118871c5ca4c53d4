// A block of the caller's own, known to the library by its energy and derivatives alone, does what a block of the
// library does: statics by each solver, dynamics, explicit steps, modes; and what does not fit is refused.
#include "core/base/errors.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/run/modes.hpp"
#include "tests/support/statics.hpp"
#include "tests/support/user_blocks.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

namespace fascia::user_block_test {
namespace {

using namespace test;

constexpr double kSame = 1e-8;  // what tolerances of 1e-9 and 1e-10 leave of statics, steps and modes

/// A slab of tetrahedra, held on one side, and its twin, whose tetrahedra are the caller's.
struct Twins {
  ElementModel built;
  Model twin;

  Twins() {
    ElementOptions o;
    o.cells = {3, 2, 2};
    built = element_model(o);
    for (int i = 0; i < built.model.node_count(); ++i)
      if (built.model.rest_position[at(i)][0] < 0.06) {
        FrameConstraint c;
        c.node = i;
        c.translations = 3;
        built.model.constraints.push_back(c);
      }
    add_gravity(built.model, {{0, -3, 1}});
    twin = built.model;
    const ElementBlock& block = built.model.points.blocks[0];
    std::vector<int> cells;
    block.for_each_element([&](std::span<const int> e) { cells.insert(cells.end(), e.begin(), e.end()); });
    for (std::size_t c = 0; c < cells.size(); c += 4) {
      const auto X = [&](std::size_t a) { return twin.rest_position[at(cells[c + a])]; };
      if (determinant(Mat3d::from_columns(X(1) - X(0), X(2) - X(0), X(3) - X(0))) < 0)
        std::swap(cells[c + 2], cells[c + 3]);
    }
    PointSetBuilder points;
    points.add_user_block(std::make_shared<PlainTetrahedra>(cells, twin.rest_position,
                                                            Lame::from_young(o.young, o.poisson), block.length));
    twin.points = std::move(points).finish(twin.frame_kind);
  }
};

double difference(const State& a, const State& b) {
  double largest = 0, apart = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    largest = std::max(largest, norm(a.u[i]));
    apart = std::max(apart, norm(a.u[i] - b.u[i]));
  }
  EXPECT_GT(largest, 1e-3);
  return apart / largest;
}

TEST(UserBlock, EqualsTheElementsOfTheLibraryInStatics) {
  const Twins twins;
  EXPECT_FALSE(twins.twin.is_linear());
  const auto expect_equal = [&](LinearMethod method, PreconditionerKind kind) {
    SolverSettings settings;
    settings.linear = method;
    settings.preconditioner = kind;
    settings.tolerance = 1e-9;
    settings.cg.tolerance = 1e-10;
    const Solved own = solved(twins.twin, settings), usual = solved(twins.built.model, settings);
    EXPECT_LT(difference(usual.end, own.end), kSame);
    EXPECT_EQ(own.run.stability.unstable, usual.run.stability.unstable);
  };
  expect_equal(LinearMethod::cholesky, PreconditionerKind::automatic);
  expect_equal(LinearMethod::cg, PreconditionerKind::block_jacobi);
  expect_equal(LinearMethod::cg, PreconditionerKind::multigrid);
}

TEST(UserBlock, EqualsThemInDynamicsAndInModes) {
  const Twins twins;
  const auto moved = [](const Model& model, bool by_explicit) {
    ThreadPool pool(2);
    SolverSettings settings;
    settings.tolerance = 1e-10;
    MechanicalSystem system(model, pool, settings);
    State state = State::at_rest(model);
    if (by_explicit) {
      const ExplicitSettings steps{0.5 * stable_time_step(system), 200, {}};
      run_explicit(system, state, kAlways, steps, nullptr);
    } else {
      DynamicsSettings steps;
      steps.time_step = 0.01;
      steps.steps = 10;
      run_implicit(system, state, kAlways, settings, steps, nullptr);
    }
    return state;
  };
  EXPECT_LT(difference(moved(twins.built.model, false), moved(twins.twin, false)), kSame);
  EXPECT_LT(difference(moved(twins.built.model, true), moved(twins.twin, true)), kSame);
  ThreadPool pool(2);
  const Modes usual = natural_modes(twins.built.model, pool, 6), own = natural_modes(twins.twin, pool, 6);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(own.frequency[k], usual.frequency[k], kSame * usual.frequency[k]);
}

TEST(UserBlock, ResultsDoNotDependOnThreads) {
  const Twins twins;
  const auto forces = [&](int threads) {
    ThreadPool pool(threads);
    CpuExecutor executor(twins.twin.points, pool);
    std::vector<double> g(at(twins.twin.dof_count()));
    executor.gradient(random_state(twins.twin, 0.02, 0), {}, g);
    return g;
  };
  EXPECT_EQ(forces(1), forces(3));
}

/// A vertex that dependent nodes and frames have nothing to do with, on a bond to a rigid frame.
TEST(UserBlock, TiesAVertexToAFrame) {
  BlockOptions o;
  o.grid = {2, 2, 2};
  BuiltModel built;
  PointSetBuilder points;
  built.bodies.emplace_back(block_spec(o), built.model, points);
  const int frame = 7, vertex = built.model.node_count();
  const Vec3d arm{{0.2, 0.1, 0}};
  Model& model = built.model;
  model.rest_position.push_back(model.rest_position[at(frame)] + arm);
  model.rest_orientation.push_back(Mat3d::identity());
  model.frame_kind.push_back(FrameKind::vertex);
  model.inertia.push_back({});
  model.inertia.back().mass = 3;
  points.add_user_block(std::make_shared<Bonds>(std::vector<Bonds::Bond>{{{frame, vertex}, {arm, {}}}}, 1e4, 0.5));
  model.points = std::move(points).finish(model.frame_kind);
  hold_face(model);
  add_gravity(model, {{0, 0, -10}});
  SolverSettings settings;
  settings.tolerance = 1e-10;
  const State end = solved(model, settings).end;
  const Vec3d apart = end.u[at(vertex)] - end.u[at(frame)] - end.D[at(frame)] * arm;
  EXPECT_NEAR(apart[2], -30 / 1e4, 1e-9);  // the weight over the bond's stiffness
  EXPECT_NEAR(apart[0], 0, 1e-9);
}

template <class Act>
std::string refusal(const Act& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(UserBlock, WhatDoesNotFitIsRefused) {
  const auto tetrahedra = [](std::vector<int> cells) {
    return refusal([&] {
      PointSetBuilder points;
      points.add_user_block(std::make_shared<PlainTetrahedra>(std::move(cells), std::vector<Vec3d>(5), Lame{1, 1}, 1));
      std::move(points).finish(std::vector<FrameKind>(4, FrameKind::vertex));
    });
  };
  EXPECT_EQ(tetrahedra({0, 1, 2, 3, 0, 1, 2, 2}),
            "cell 1 of a user block names node 2 twice; a node may stand once in a cell");
  EXPECT_EQ(tetrahedra({0, 1, 2}), "a user block has cells of 4 nodes and 3 nodes in all; give whole cells");
  EXPECT_EQ(tetrahedra({0, 1, 2, -1}), "cell 0 of a user block names node -1");
  EXPECT_EQ(tetrahedra({0, 1, 2, 4}), "cell 0 of a user block names node 4; the model has 4");
  EXPECT_EQ(refusal([] { Bonds({}, 1, 0); }), "a user block has cells of length 0.000000; it must be positive");
  EXPECT_EQ(refusal([] { PointSetBuilder().add_user_block(nullptr); }), "a user block is missing; give one");
}

}  // namespace
}  // namespace fascia::user_block_test
