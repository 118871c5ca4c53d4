#include "core/run/drivers.hpp"
#include "core/run/modes.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

namespace fascia::body_test {
namespace {

using namespace test;

GridSpec cylinder_spec(const std::array<int, 3>& grid) {
  BlockOptions o;
  o.grid = grid;
  GridSpec spec = block_spec(o);
  spec.domain.min = {{0, -1, -1}};
  spec.domain.max = {{6, 1, 1}};
  spec.domain.volume = 6 * std::numbers::pi;
  spec.domain.contains = [](const Vec3d& x) { return x[1] * x[1] + x[2] * x[2] <= 1; };
  return spec;
}

GridSpec ball_spec(int n) {
  BlockOptions o;
  o.grid = {n, n, n};
  GridSpec spec = block_spec(o);
  spec.domain.min = {{-1, -1, -1}};
  spec.domain.max = {{1, 1, 1}};
  spec.domain.volume = 4.0 / 3 * std::numbers::pi;
  spec.domain.contains = [](const Vec3d& x) { return squared_norm(x) <= 1; };
  return spec;
}

/// F at rest is I at every point, for every rule; else rest would not be free of stress.
TEST(ModelBody, IsFreeOfStrainAtRest) {
  for (const bool half : {true, false}) {
    BlockOptions o;
    o.half_blend = half;
    o.rotation = rotation_about(normalized(Vec3d{{1, 2, -1}}), 1.1);
    o.translation = {{5, 6, 7}};
    const BuiltModel built = block(o);
    for (std::size_t q = 0; q < built.bodies[0].points().size(); ++q) {
      const BodyPoint& p = built.bodies[0].points()[q];
      const Attachment a = built.bodies[0].attach_point(q);
      Mat3d F;
      Vec3d x;
      for (std::size_t k = 0; k < a.nodes.size(); ++k) {
        const Vec3d& X = built.model.rest_position[static_cast<std::size_t>(a.nodes[k])];
        F += outer(X, a.influences[k].g) + a.influences[k].B;
        x += X * a.influences[k].w + a.influences[k].b;
      }
      EXPECT_LT(norm(F - Mat3d::identity()), 1e-13);
      EXPECT_LT(norm(x - p.X), 1e-13);
    }
  }
}

/// Patch test: affine motion on the boundary frames, rotations free inside; F = A everywhere, inside frames at rest.
TEST(PatchTest, AffineDisplacementIsAnEquilibrium) {
  for (const GridWeightKind weights : {GridWeightKind::trilinear, GridWeightKind::linear}) {
    BlockOptions o;
    o.weights = weights;
    o.grid = {4, 4, 4};
    BuiltModel built = block(o);
    // A symmetric stretch: its polar rotation is I, which the frames then keep.
    Mat3d A = Mat3d::diagonal(0.1);
    A(0, 1) = A(1, 0) = 0.06;
    A(1, 2) = A(2, 1) = -0.04;
    A(2, 2) = -0.12;
    Model& model = built.model;
    const std::vector<char> boundary = built.bodies[0].nodes_on_boundary();
    State state = State::at_rest(model);
    for (int i = 0; i < model.node_count(); ++i) {
      const auto node = static_cast<std::size_t>(i);
      if (boundary[node] == 0) continue;
      FrameConstraint c;
      c.node = i;
      c.translations = c.rotations = 3;
      for (int a = 0; a < 3; ++a)
        c.translation_motion[static_cast<std::size_t>(a)] = static_cast<int>(model.motions.size());
      PrescribedMotion m;
      m.translation = A * model.rest_position[node];
      model.motions.push_back(m);
      model.constraints.push_back(c);
    }
    ThreadPool pool(1);
    SolverSettings settings;
    settings.tolerance = 1e-12;
    MechanicalSystem system(model, pool, settings);
    const RunReport report = run_statics(
        system, state, [](double t) { return std::vector<double>{t}; }, settings, {}, nullptr);
    ASSERT_EQ(report.status, RunStatus::converged) << report.message;
    double worst = 0;
    for (std::size_t q = 0; q < built.bodies[0].points().size(); ++q) {
      const Attachment at = built.bodies[0].attach_point(q);
      Mat3d H;
      for (std::size_t k = 0; k < at.nodes.size(); ++k)
        H += outer(state.u[static_cast<std::size_t>(at.nodes[k])], at.influences[k].g) +
             state.D[static_cast<std::size_t>(at.nodes[k])] * at.influences[k].B;
      worst = std::max(worst, norm(H - A));
    }
    std::printf("patch test, largest error of F: %.1e\n", worst);
    EXPECT_LT(worst, 1e-10);
  }
}

TEST(ModelBody, VolumesAddUpToTheDomains) {
  for (const GridSpec& spec : {cylinder_spec({13, 5, 5}), ball_spec(6)}) {
    const BuiltModel built = build({spec});
    double volume = 0, mass = 0;
    for (const BodyPoint& p : built.bodies[0].points()) volume += p.volume;
    for (const FrameInertia& i : built.model.inertia) mass += i.mass;
    EXPECT_NEAR(volume, spec.domain.volume, 1e-12 * spec.domain.volume);
    EXPECT_NEAR(mass, spec.density * spec.domain.volume, 1e-12 * mass);
  }
}

/// Cut cells leave no frame hanging on too few points, and no frame without mass.
TEST(ImmersedBody, HasExactlySixZeroModes) {
  for (const GridSpec& spec : {cylinder_spec({7, 3, 3}), cylinder_spec({9, 5, 5}), cylinder_spec({7, 6, 6}),
                               ball_spec(4), ball_spec(5), ball_spec(6), ball_spec(7), ball_spec(9)}) {
    const BuiltModel built = build({spec});
    for (const FrameInertia& i : built.model.inertia) EXPECT_GT(i.mass, 0);
    ThreadPool pool(2);
    const Modes modes = natural_modes(built.model, pool, 7);
    EXPECT_TRUE(modes.converged);
    EXPECT_LT(modes.frequency[5], 1e-4 * modes.frequency[6]);
    std::printf("grid %d x %d x %d, %d frames: %s, sixth and seventh frequency %.2e %.4g Hz\n", spec.grid[0],
                spec.grid[1], spec.grid[2], built.model.node_count(),
                built.bodies[0].messages().empty() ? "" : built.bodies[0].messages()[0].c_str(), modes.frequency[5],
                modes.frequency[6]);
  }
}

TEST(ImmersedBody, WithoutAPointInsideIsRefused) {
  GridSpec spec = ball_spec(2);
  spec.domain.contains = [](const Vec3d&) { return false; };
  Model model;
  PointSetBuilder points;
  EXPECT_ANY_THROW(GridBody(spec, model, points));
}

/// Frames along other axes, another place, another numbering: the same energy for the same motion.
TEST(ModelBody, DoesNotDependOnPlaceOrientationOrNumbering) {
  const auto energy = [](const BlockOptions& o, const Mat3d& axes) {
    const BuiltModel built = block(o);
    State state = State::at_rest(built.model);
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      // The same bending of the body, in its own axes.
      const Vec3d X = transpose(axes) * (transpose(o.rotation) * (built.model.rest_position[i] - o.translation));
      const Mat3d turn = o.rotation * axes;
      state.u[i] = turn * Vec3d{{0.05 * X[1] * X[0], -0.1 * X[0] * X[0], 0.02 * X[2] * X[0]}};
      state.D[i] = turn * rotation_increment({{0.01, -0.02, -0.2 * X[0]}}) * transpose(turn);
    }
    ThreadPool pool(1);
    CpuExecutor executor(built.model.points, pool);
    std::vector<double> g(static_cast<std::size_t>(built.model.dof_count()));
    return executor.gradient(state, {}, g).total();
  };
  BlockOptions o;
  o.grid = {4, 3, 2};
  o.size = {{2, 1, 0.5}};
  const double reference = energy(o, Mat3d::identity());
  BlockOptions moved = o;
  moved.rotation = rotation_about(normalized(Vec3d{{1, -2, 0.5}}), 2.0);
  moved.translation = {{100, -30, 7}};
  EXPECT_NEAR(energy(moved, Mat3d::identity()), reference, 1e-11 * reference);
  // x → y → z → x: the grid is numbered along other axes.
  BlockOptions cycled = o;
  cycled.grid = {2, 4, 3};
  cycled.size = {{0.5, 2, 1}};
  const Mat3d cycle = Mat3d::from_columns({{0, 1, 0}}, {{0, 0, 1}}, {{1, 0, 0}});
  EXPECT_NEAR(energy(cycled, cycle), reference, 1e-11 * reference);
}

}  // namespace
}  // namespace fascia::body_test
