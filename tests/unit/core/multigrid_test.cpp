#include "core/levels/multigrid.hpp"
#include "core/levels/rounded_rows.hpp"
#include "core/linear/cg.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/exact_cycle.hpp"
#include "tests/support/shell_models.hpp"
#include "tests/support/tangent_at_rest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

namespace fascia::multigrid_test {
namespace {

using namespace fascia::test;

Model held_block(int n, bool affine = false, double poisson = 0.3) {
  BlockOptions o;
  o.grid = {n, n, n};
  o.affine = affine;
  o.poisson = poisson;
  BuiltModel built = build({block_spec(o)});
  hold_face(built.model);
  return std::move(built.model);
}

struct Solved {
  CgReport cg;
  std::vector<double> x;
  std::vector<int> sizes;
  double memory = 0;  ///< of the levels, over that of the matrix
};

Solved solve(TangentAtRest& t, const std::vector<double>& b) {
  Multigrid levels(t.matrix, t.filter, t.pool);
  EXPECT_TRUE(t.build(levels));
  Solved out;
  const CpuVectors vectors(t.pool);
  out.cg = conjugate_gradients(
      vectors, [&](const auto& p, auto& Ap) { t.multiply(p, Ap); },
      [&](const auto& r, auto& z) { return levels.precondition(r, z); }, b, out.x, {200, 1e-8});
  out.sizes = levels.level_sizes();
  out.memory = static_cast<double>(levels.value_count()) / static_cast<double>(t.matrix.value_count());
  return out;
}

Solved solve(Model model, int threads) {
  TangentAtRest t(std::move(model), threads);
  return solve(t, t.random_force(1));
}

TEST(MultigridTest, IterationsHardlyGrowWithTheNumberOfNodes) {
  for (const bool affine : {false, true}) {
    int fewest = 1000, most = 0;
    for (const int n : {5, 9, affine ? 11 : 17}) {
      const Solved s = solve(held_block(n, affine), 2);
      std::printf("%s cube of %2d nodes a side: %d iterations, levels", affine ? "affine" : "rigid ", n,
                  s.cg.iterations);
      for (const int size : s.sizes) std::printf(" %d", size);
      std::printf(", %.2f of the matrix's memory\n", s.memory);
      EXPECT_EQ(s.cg.status, CgStatus::converged);
      EXPECT_LE(s.memory, 1.4);
      fewest = std::min(fewest, s.cg.iterations), most = std::max(most, s.cg.iterations);
    }
    EXPECT_LE(most, affine ? 30 : 18);
    EXPECT_LE(most, 1.3 * fewest);
  }
}

/// A roof of R/t = 1,000 on three and on four levels, clamped at one end: with one correction of each level four took
/// three quarters more iterations than three.
TEST(MultigridTest, IterationsOfThinShellsHardlyGrowWithTheNumberOfLevels) {
  if (!full_size()) GTEST_SKIP() << "in full size only";
  int fewest = 1000, most = 0;
  for (const int n : {64, 128}) {
    PatchOptions patch;
    patch.nu = patch.nv = n;
    const auto roof = [](double x, double angle) {
      constexpr double R = 25, begin = 50. / 180 * M_PI, end = 0.5 * M_PI;
      const double a = begin + (end - begin) * angle;
      return Vec3d{{R * x, R * std::cos(a), R * std::sin(a)}};
    };
    ShellMatter matter;
    matter.thickness = 0.025;
    ShellModel shell = shell_model(patch_mesh(roof, patch), matter);
    hold(
        shell.model, [](const Vec3d& X) { return X[0] < 1e-6; }, "xyzXYZ");
    const Solved s = solve(std::move(shell.model), 2);
    std::printf("roof of %d cells: %d iterations, %zu levels\n", n, s.cg.iterations, s.sizes.size());
    EXPECT_EQ(s.cg.status, CgStatus::converged);
    EXPECT_EQ(s.sizes.size(), n == 64 ? 3U : 4U);
    fewest = std::min(fewest, s.cg.iterations), most = std::max(most, s.cg.iterations);
  }
  EXPECT_LE(most, 1.3 * fewest);
}

/// A beam that is clamped at one end and pulled aside all along, and the same turned by 90 degrees and askew.
TEST(MultigridTest, TheSameBeamTurnedTakesAsManyIterations) {
  std::vector<Solved> solved;
  for (const Vec3d& turn : {Vec3d{}, Vec3d{{0, 0, 0.5 * M_PI}}, Vec3d{{0, 0.5 * M_PI, 0}}, Vec3d{{0.4, -0.9, 0.7}}}) {
    BlockOptions o;
    o.grid = {33, 5, 5};
    o.size = {{8, 1, 1}};
    o.rotation = Mat3d::identity() + rotation_increment(turn);
    BuiltModel built = build({block_spec(o)});
    for (int i = 0; i < built.model.node_count(); ++i) {
      if (std::abs((transpose(o.rotation) * built.model.rest_position[at(i)])[0]) > 1e-9) continue;
      FrameConstraint c;
      c.node = i;
      c.translations = c.rotations = 3;
      c.whole = true;
      built.model.constraints.push_back(c);
    }
    ASSERT_EQ(built.model.constraints.size(), 25U);
    TangentAtRest t(std::move(built.model), 1);
    std::vector<double> b(at(t.model.dof_count()), 0.0);
    const Vec3d aside = o.rotation * Vec3d{{0, 1, 0}};
    for (int i = 0; i < t.model.node_count(); ++i)
      for (int k = 0; k < 3; ++k) b[at(t.model.points.dofs.begin(i) + k)] = aside[k];
    t.filter.clear_fixed(b);
    solved.push_back(solve(t, b));
  }
  for (const Solved& s : solved) {
    std::printf("%d iterations\n", s.cg.iterations);
    EXPECT_EQ(s.cg.iterations, solved[0].cg.iterations);
    EXPECT_EQ(s.sizes, solved[0].sizes);
  }
}

TEST(MultigridTest, VerticesHaveRigidFramesAboveThem) {
  BlockOptions o;
  o.grid = {13, 13, 13};
  Model model = vertex_block(o);
  hold_face(model);
  const Solved s = solve(std::move(model), 1);
  std::printf("hexahedra: %d iterations\n", s.cg.iterations);
  EXPECT_EQ(s.cg.status, CgStatus::converged);
  EXPECT_LE(s.cg.iterations, 18);
  ASSERT_GE(s.sizes.size(), 2u);
}

/// A rigid motion of a free body costs nothing, K P = 0 of it, and each level hands it on to the finer one as it is.
void expect_rigid_motions(Model model) {
  TangentAtRest t(std::move(model), 1);
  Multigrid levels(t.matrix, t.filter, t.pool);
  t.build(levels);  // the coarsest is singular
  ASSERT_GE(levels.level_count(), 2u);
  const Vec3d U{{0.3, -0.7, 1.1}}, turn{{0.5, 0.2, -0.4}};
  const auto motion = [&](const Vec3d& x) { return U + cross(turn, x); };
  for (std::size_t depth = 0; depth + 1 < levels.level_count(); ++depth) {
    const Multigrid::LevelView fine = levels.level(depth), coarse = levels.level(depth + 1);
    double error = 0;
    for (int i = 0; i < fine.nodes; ++i) {
      const int n = depth == 0 ? t.matrix.dofs().size(i) : kFrameDofs;
      std::vector<double> u(at(n), 0.0);
      const std::span<const int> columns = fine.P->columns(i);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const Vec3d V = motion(coarse.x[at(columns[k])]);
        const double rigid[] = {V[0], V[1], V[2], turn[0], turn[1], turn[2]};
        for (int a = 0; a < n; ++a)
          u[at(a)] += std::inner_product(rigid, rigid + kFrameDofs,
                                         fine.P->block(i, static_cast<int>(k), n) + kFrameDofs * a, 0.0);
      }
      const Vec3d expected = motion(fine.x[at(i)]);
      for (int k = 0; k < 3; ++k) error = std::max(error, std::abs(u[at(k)] - expected[k]));
      if (n == 6)
        for (int k = 0; k < 3; ++k) error = std::max(error, std::abs(u[at(3 + k)] - turn[k]));
      if (n == 12)  // dA = skew(Θ), by columns
        for (int q = 0; q < 3; ++q)
          for (int k = 0; k < 3; ++k) error = std::max(error, std::abs(u[at(3 + 3 * q + k)] - skew(turn)(k, q)));
    }
    EXPECT_LE(error, 1e-9) << "level " << depth;
  }
}

TEST(MultigridTest, HandsOnRigidMotionsAsTheyAre) {
  BlockOptions o;
  o.grid = {9, 8, 7};
  o.rotation = rotation_about({{0.4, -0.9, 0.3}}, 1.1);
  o.translation = {{0.2, 0.5, -0.3}};
  expect_rigid_motions(std::move(build({block_spec(o)}).model));
  o.affine = true;
  expect_rigid_motions(std::move(build({block_spec(o)}).model));
  PatchOptions patch;
  patch.nu = patch.nv = 24;
  patch.jitter = 0.2;
  const ShellMesh mesh = patch_mesh([](double x, double y) { return Vec3d{{x, y, 0.3 * x * y}}; }, patch);
  ShellModel shell = shell_model(mesh, {});
  expect_rigid_motions(std::move(shell.model));
}

TEST(MultigridTest, IsSymmetricAndPositive) {
  TangentAtRest t(held_block(7), 2);
  Multigrid levels(t.matrix, t.filter, t.pool);
  ASSERT_TRUE(t.build(levels));
  expect_symmetric_and_positive(levels, t);
}

/// Of frames, and of vertices under them; blocks below the diagonal mirror those above it bit for bit.
TEST(MultigridTest, CoarseMatricesAreGalerkinProducts) {
  BlockOptions o;
  o.grid = {21, 20, 17};
  BuiltModel frames = build({block_spec(o)});
  hold_face(frames.model);
  Model vertices = vertex_block(o);
  hold_face(vertices);
  for (Model* model : {&frames.model, &vertices}) {
    TangentAtRest t(std::move(*model), 2);
    Multigrid levels(t.matrix, t.filter, t.pool);
    ASSERT_TRUE(t.build(levels));
    ASSERT_GE(levels.level_count(), 3U);
    ExactCycle exact(levels, t);
    for (std::size_t depth = 1; depth < levels.level_count(); ++depth) {
      const Multigrid::LevelView level = levels.level(depth);
      std::vector<double> x(at(kFrameDofs * level.nodes));
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + static_cast<double>(i * i % 1009));
      const std::vector<double> y = exact.product(depth, x), expected = exact.galerkin_product(depth - 1, x);
      double largest = 0, error = 0;
      for (std::size_t i = 0; i < y.size(); ++i) {
        largest = std::max(largest, std::abs(expected[i]));
        error = std::max(error, std::abs(y[i] - expected[i]));
      }
      EXPECT_LE(error, 1e-12 * largest) << "level " << depth;
      const BlockRows& rows = *level.matrix;
      for (int row = 0; row < rows.rows(); ++row) {
        const std::span<const int> columns = rows.columns(row);
        EXPECT_TRUE(std::is_sorted(columns.begin(), columns.end()));
        for (std::size_t k = 0; k < columns.size(); ++k) {
          const std::span<const int> back = rows.columns(columns[k]);
          const auto found = std::lower_bound(back.begin(), back.end(), row);
          ASSERT_TRUE(found != back.end() && *found == row);
          const double *block = rows.block(row, static_cast<int>(k), kFrameDofs),
                       *mirror = rows.block(columns[k], static_cast<int>(found - back.begin()), kFrameDofs);
          for (int a = 0; a < kFrameDofs; ++a)
            for (int b = 0; b < kFrameDofs && row != columns[k]; ++b)
              EXPECT_EQ(block[kFrameDofs * a + b], mirror[kFrameDofs * b + a]);
        }
      }
    }
  }
}

TEST(MultigridTest, DoesNotDependOnThreads) {
  const Solved one = solve(held_block(9), 1);
  for (const int threads : {2, 3, 7}) {
    const Solved more = solve(held_block(9), threads);
    EXPECT_EQ(more.cg.iterations, one.cg.iterations);
    EXPECT_EQ(more.x, one.x) << threads;
  }
}

/// As sums over the entries, of blocks of three, six and twelve rows; what lies beyond the last column stays.
TEST(RoundedRowsTest, MultiplyAsTheEntriesDo) {
  for (const int size : {3, 6, 12}) {
    BlockRows rows;
    rows.column = {0, 2, 1, 2};
    rows.begin = {0, 2, 2, 4};
    rows.value_begin = {0, at(2 * size * kFrameDofs), at(2 * size * kFrameDofs), at(4 * size * kFrameDofs)};
    for (int k = 0; k < 4 * size * kFrameDofs; ++k) rows.values.push_back(std::sin(1.0 + k));
    const RoundedRows rounded(rows);
    std::vector<double> x(3 * kFrameDofs + RoundedRows::kBeyond, 0.0), y(at(3 * size), 0.5), expected = y, back = x,
                                                                                             expected_back = x;
    for (std::size_t i = 0; i < 3 * kFrameDofs; ++i) x[i] = std::cos(static_cast<double>(i));
    for (int row = 0; row < 3; ++row) {
      rounded.add_product(rows, row, size, x.data(), y.data() + size * row);
      rounded.add_transposed_product(rows, row, size, x.data(), back.data());
      for (std::size_t k = 0; k < rows.columns(row).size(); ++k)
        for (int i = 0; i < size; ++i)
          for (int j = 0; j < kFrameDofs; ++j) {
            const double entry = rows.block(row, static_cast<int>(k), size)[kFrameDofs * i + j];
            const std::size_t column = at(kFrameDofs * rows.columns(row)[k] + j);
            expected[at(size * row + i)] += entry * x[column];
            expected_back[column] += entry * x[at(i)];
          }
    }
    for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], expected[i], 1e-6) << size;
    for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], expected_back[i], 1e-6) << size;
    EXPECT_EQ(back[3 * kFrameDofs], 0);
    EXPECT_EQ(back[3 * kFrameDofs + 1], 0);
  }
}

}  // namespace
}  // namespace fascia::multigrid_test
