#pragma once

#include "core/executor/executor.hpp"
#include "core/levels/multigrid.hpp"
#include "core/node/positive_inverse.hpp"
#include "core/tangent/condensation.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <vector>

namespace fascia::test {

/// The tangent of a model at rest, and what levels of it are built from.
struct TangentAtRest {
  Model model;
  ThreadPool pool;
  DofFilter filter;
  CpuExecutor executor;
  BlockMatrix matrix;
  Linearization lin;
  std::vector<double> inverse;

  TangentAtRest(Model m, int threads)
      : model(std::move(m)), pool(threads), filter(model), executor(model.points, pool), matrix(model.points) {
    const State rest = State::at_rest(model);
    std::vector<double> g(at(model.dof_count()));
    executor.gradient(rest, {}, g);
    executor.linearize(rest, {}, Tangent::full, lin);
    executor.assemble(lin, matrix);
    if (Dependents<PoolSpace> dependents(model.points); !dependents.empty()) {
      dependents.turn_to(lin.Q.data());
      Condensation(dependents, matrix.dofs(), pool).condense(matrix);
    }
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

/// Expects of two forces that nothing favours that the cycle is symmetric and positive definite.
inline void expect_symmetric_and_positive(Multigrid& levels, TangentAtRest& t) {
  const std::vector<double> a = t.random_force(2), b = t.random_force(3);
  std::vector<double> Ma(a.size()), Mb(b.size());
  EXPECT_GT(levels.precondition(a, Ma), 0);
  EXPECT_GT(levels.precondition(b, Mb), 0);
  const CpuVectors vectors(t.pool);
  const double size = std::sqrt(vectors.dot(a, Ma) * vectors.dot(b, Mb));
  EXPECT_NEAR(vectors.dot(a, Mb), vectors.dot(b, Ma), 1e-12 * size);
}

}  // namespace fascia::test
