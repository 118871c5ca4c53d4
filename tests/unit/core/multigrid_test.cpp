#include "core/solver/multigrid.hpp"
#include "core/solver/cg.hpp"
#include "core/solver/positive_inverse.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace fascia::multigrid_test {
namespace {

using namespace fascia::test;

/// Everything that builds the levels of one tangent at rest.
struct Tangent {
  Model model;
  ThreadPool pool;
  DofFilter filter;
  CpuExecutor executor;
  BlockMatrix matrix;
  Linearization lin;
  std::vector<double> inverse;

  Tangent(Model m, int threads)
      : model(std::move(m)), pool(threads), filter(model), executor(model.points, pool), matrix(model.points) {
    const State rest = State::at_rest(model);
    std::vector<double> g(at(model.dof_count()));
    executor.gradient(rest, {}, g);
    executor.linearize(rest, {}, fascia::Tangent::full, lin);
    executor.assemble(lin, matrix);
    const DofLayout& dofs = model.points.dofs;
    inverse.resize(dofs.block_total());
    for (int node = 0; node < model.node_count(); ++node) {
      const int n = dofs.size(node);
      double* block = inverse.data() + dofs.block_begin(node);
      filter.rotate_block(node, node, matrix.block(matrix.diagonal(node)), block);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          if (filter.is_fixed(at(dofs.begin(node) + i)) || filter.is_fixed(at(dofs.begin(node) + j)))
            block[n * i + j] = i == j ? 1 : 0;
      positive_inverse(block, n);
    }
  }

  void multiply(std::span<const double> x, std::span<double> y) {
    std::vector<double> global(x.begin(), x.end());
    filter.to_global(global);
    matrix.multiply(pool, global, y);
    filter.to_local(y);
    filter.clear_fixed(y);
  }
  bool build(Multigrid& levels) {
    return levels.build({model.rest_position, lin.Q}, inverse,
                        [this](std::span<const double> x, std::span<double> y) { multiply(x, y); });
  }
  std::vector<double> random_force(int seed) const {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<double> f(at(model.dof_count()));
    for (double& v : f) v = uniform(random);
    filter.clear_fixed(f);
    return f;
  }
};

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

Solved solve(Model model, int threads) {
  Tangent t(std::move(model), threads);
  Multigrid levels(t.matrix, t.filter, t.pool);
  EXPECT_TRUE(t.build(levels));
  Solved out;
  const CpuVectors vectors(t.pool);
  out.cg = conjugate_gradients(
      vectors, [&](const auto& p, auto& Ap) { t.multiply(p, Ap); },
      [&](const auto& r, auto& z) { return levels.precondition(r, z); }, t.random_force(1), out.x, {200, 1e-8});
  out.sizes = levels.level_sizes();
  out.memory = static_cast<double>(levels.value_count()) / static_cast<double>(t.matrix.value_count());
  return out;
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

TEST(MultigridTest, IsSymmetricAndPositive) {
  Tangent t(held_block(7), 2);
  Multigrid levels(t.matrix, t.filter, t.pool);
  ASSERT_TRUE(t.build(levels));
  const std::vector<double> a = t.random_force(2), b = t.random_force(3);
  std::vector<double> Ma(a.size()), Mb(b.size());
  EXPECT_GT(levels.precondition(a, Ma), 0);
  EXPECT_GT(levels.precondition(b, Mb), 0);
  const CpuVectors vectors(t.pool);
  const double size = std::sqrt(vectors.dot(a, Ma) * vectors.dot(b, Mb));
  EXPECT_NEAR(vectors.dot(a, Mb), vectors.dot(b, Ma), 1e-12 * size);
}

TEST(MultigridTest, DoesNotDependOnThreads) {
  const Solved one = solve(held_block(9), 1);
  for (const int threads : {2, 3, 7}) {
    const Solved more = solve(held_block(9), threads);
    EXPECT_EQ(more.cg.iterations, one.cg.iterations);
    EXPECT_EQ(more.x, one.x) << threads;
  }
}

}  // namespace
}  // namespace fascia::multigrid_test
