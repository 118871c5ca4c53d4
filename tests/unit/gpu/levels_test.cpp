#include "gpu/system/levels.hpp"

#include "core/math/rotation.hpp"
#include "core/space/space.hpp"
#include "tests/support/dependent_models.hpp"
#include "tests/support/exact_cycle.hpp"
#include "tests/support/shell_models.hpp"
#include "tests/support/tangent_at_rest.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

/// The cycle of a space, and that of the processor, against one that shares no loop with either.
namespace fascia::gpu::test::levels_test {
namespace {

using namespace fascia::test;

/// Entries of 32 bits, which the processor takes, change a solution by 4e-10 to 2e-7 of it.
constexpr double kRounded = 1e-6;

/// @return  the number of levels
std::size_t expect_same_cycle(Model model, const char* name) {
  TangentAtRest t(std::move(model), 1);
  Multigrid made(t.matrix, t.filter, t.pool);
  EXPECT_TRUE(t.build(made)) << name;
  const HostModel host(t.model, State::at_rest(t.model));
  Levels<HostSpace> levels;
  levels.take(made, host.nodes());
  const std::size_t n = at(t.model.dof_count());
  for (const int seed : {1, 2}) {
    const std::vector<double> r = t.random_force(seed);
    const std::vector<double> expected = ExactCycle(made, t).solve(r);
    std::vector<double> rounded(n), got(n);
    made.precondition(r, rounded);
    levels.cycle(r.data(), got.data());
    double error = 0, by_rounding = 0, size = 0;
    for (std::size_t i = 0; i < n; ++i) {
      error = std::max(error, std::abs(got[i] - expected[i]));
      by_rounding = std::max(by_rounding, std::abs(rounded[i] - expected[i]));
      size = std::max(size, std::abs(expected[i]));
    }
    std::printf("%-10s %zu levels: %.1e, rounded entries %.1e\n", name, made.level_count(), error / size,
                by_rounding / size);
    EXPECT_LE(error, 1e-11 * size) << name;
    EXPECT_LE(by_rounding, kRounded * size) << name;
  }
  return made.level_count();
}

/// Rigid and affine frames, vertices, shells; a coarsest level that a dense factor solves.
TEST(LevelsTest, HaveTheProcessorsCycle) {
  BlockOptions o;
  for (const bool affine : {false, true}) {
    o.affine = affine;
    o.grid = {9, 9, 9};
    BuiltModel built = build({block_spec(o)});
    hold_face(built.model);
    expect_same_cycle(std::move(built.model), affine ? "affine" : "rigid");
  }
  o.grid = {11, 9, 8};
  Model vertices = vertex_block(o);
  hold_face(vertices);
  expect_same_cycle(std::move(vertices), "vertices");
  PatchOptions patch;
  patch.nu = patch.nv = 24;
  patch.jitter = 0.2;
  ShellModel shell = shell_model(patch_mesh([](double x, double y) { return Vec3d{{x, y, 0.3 * x * y}}; }, patch), {});
  hold(
      shell.model, [](const Vec3d& X) { return X[0] < 1e-6; }, "xyzXYZ");
  expect_same_cycle(std::move(shell.model), "shell");
}

/// A strip along whose edge it is clamped has enough levels for several corrections of one.
TEST(LevelsTest, HaveTheProcessorsCycleOfManyLevels) {
  PatchOptions patch;
  patch.nu = 1600;
  patch.nv = 4;
  ShellModel shell = shell_model(patch_mesh([](double x, double y) { return Vec3d{{400 * x, y, 0}}; }, patch), {});
  hold(
      shell.model, [](const Vec3d& X) { return X[1] < 1e-6; }, "xyzXYZ");
  EXPECT_GE(expect_same_cycle(std::move(shell.model), "strip"), 4U);
}

/// Eight nodes, four of them held.
TEST(LevelsTest, HaveTheProcessorsCycleOfAFewNodes) {
  BlockOptions o;
  o.grid = {2, 2, 2};
  BuiltModel built = build({block_spec(o)});
  hold_face(built.model);
  expect_same_cycle(std::move(built.model), "eight");
}

/// Vertices beside frames, nodes that depend on others, constraints in axes of their own.
TEST(LevelsTest, HaveTheProcessorsCycleOfMixedNodes) {
  for (const std::string& name : kWaysToDepend) {
    Model model = std::move(coupled_model(name)->model);
    const PointSet& points = model.points;
    int held = 0;
    for (int i = 0; i < model.node_count(); ++i) {
      const bool follows = std::any_of(points.dependents.begin(), points.dependents.end(),
                                       [i](const DependentNode& d) { return d.node == i; });
      if (follows) continue;
      FrameConstraint c;
      c.node = i;
      c.translations = held < 4 ? 3 : 1;
      c.rotations = model.frame_kind[at(i)] == FrameKind::vertex || held >= 4 ? 0 : 3;
      c.whole = model.frame_kind[at(i)] == FrameKind::affine && held < 4;
      if (held >= 4) c.translation_axes = Mat3d::identity() + rotation_increment({{0.3, -0.8, 0.5}});
      model.constraints.push_back(c);
      if (++held == 6) break;
    }
    expect_same_cycle(std::move(model), name.c_str());
  }
}

/// Levels that were taken before leave nothing behind.
TEST(LevelsTest, AreTakenAgain) {
  BlockOptions large, small;
  large.grid = {9, 9, 9};
  small.grid = {5, 5, 5};
  Levels<HostSpace> levels;
  std::vector<double> last;
  for (const BlockOptions& o : {large, small}) {
    BuiltModel built = build({block_spec(o)});
    hold_face(built.model);
    TangentAtRest t(std::move(built.model), 1);
    Multigrid made(t.matrix, t.filter, t.pool);
    ASSERT_TRUE(t.build(made));
    const HostModel host(t.model, State::at_rest(t.model));
    const std::uint64_t key = levels.key();
    levels.take(made, host.nodes());
    EXPECT_NE(levels.key(), key);
    const std::size_t n = at(t.model.dof_count());
    const std::vector<double> r = t.random_force(1);
    const std::vector<double> expected = ExactCycle(made, t).solve(r);
    std::vector<double> got(n);
    levels.cycle(r.data(), got.data());
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(got[i], expected[i], 1e-11 * std::abs(expected[i]) + 1e-15);
  }
}

}  // namespace
}  // namespace fascia::gpu::test::levels_test
