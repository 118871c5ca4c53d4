// Tangents and their matrices on several threads, of nodes of one kind and of several.
#include "core/linear/block_matrix.hpp"
#include "core/executor/executor.hpp"
#include "core/linear/vectors.hpp"
#include "tests/unit/meshless/shared_models.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace fascia::block_matrix_test {
namespace {

using namespace test;

enum class Nodes { vertices, rigid, several };

std::string name_of(Nodes nodes) {
  return nodes == Nodes::vertices ? "vertices" : nodes == Nodes::rigid ? "rigid" : "several";
}

/// Several ranges of nodes and rows, and a matrix of several chunks.
Model model_of(Nodes nodes) {
  BlockOptions o;
  if (nodes != Nodes::several) {
    o.grid = nodes == Nodes::vertices ? std::array{17, 17, 17} : std::array{11, 11, 11};
    return nodes == Nodes::vertices ? vertex_block(o) : std::move(block(o).model);
  }
  SharedModel s;
  HostOptions host;
  host.kind = HostKind::turning;
  host.cells = 7;
  add_host(s, host);
  o.affine = true;
  add_cloud(s, unit_scatter(SpacedChoice{0.25, 1}), o);
  s.finish();
  return std::move(s.model);
}

class BlockMatrixOf : public testing::TestWithParam<Nodes> {
 protected:
  BlockMatrixOf() : model_(model_of(GetParam())), state_(random_state(model_, 1e-3, 0.1)) {}

  struct Found {
    Linearization lin;
    std::vector<double> values, product, rounded;
    double power = 0;  ///< x · K x
  };
  /// The last tangent is written over another one.
  Found found(int threads) {
    ThreadPool pool(threads);
    CpuExecutor executor(model_.points, pool);
    const std::vector<double> x = random_direction(model_);
    std::vector<double> g(x.size());
    executor.gradient(state_, {}, g);
    Found f;
    BlockMatrix matrix(model_.points);
    for (const Tangent tangent : {Tangent::full, Tangent::material, Tangent::full}) {
      executor.linearize(state_, {}, tangent, f.lin);
      executor.assemble(f.lin, matrix);
    }
    f.values.assign(matrix.values(), matrix.values() + matrix.value_count());
    f.product.resize(x.size());
    f.power = matrix.multiply(pool, x, f.product);
    f.rounded.resize(x.size());
    matrix.round(pool);
    matrix.multiply_rounded(pool, x, f.rounded);
    std::vector<double> free(x.size());
    executor.multiply(f.lin, x, free);
    for (std::size_t i = 0; i < free.size(); ++i) free[i] -= f.product[i];
    EXPECT_LT(norm(free), 1e-13 * norm(f.product));
    return f;
  }

  Model model_;
  State state_;
};

TEST_P(BlockMatrixOf, TangentEntriesAndProductsDoNotDependOnThreads) {
  const Found one = found(1);
  EXPECT_GT(one.values.size() * sizeof(double), std::size_t{4} << 20U);
  for (const int threads : {2, 7}) {
    const Found more = found(threads);
    EXPECT_EQ(more.lin.Q, one.lin.Q);
    EXPECT_EQ(more.lin.node_blocks, one.lin.node_blocks);
    EXPECT_EQ(more.lin.u, one.lin.u);
    EXPECT_EQ(more.lin.D, one.lin.D);
    EXPECT_EQ(more.lin.kept, one.lin.kept);
    EXPECT_EQ(more.values, one.values);
    EXPECT_EQ(more.product, one.product);
    EXPECT_EQ(more.power, one.power);
    EXPECT_EQ(more.rounded, one.rounded);
  }
}

/// Each entry is off by half a unit of its last place, 6e-8 of it, at most.
TEST_P(BlockMatrixOf, ProductsWithRoundedEntriesMissByThatRounding) {
  const Found f = found(2);
  std::vector<double> rest = f.rounded;
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= f.product[i];
  const double error = norm(rest) / norm(f.product);
  std::printf("%-9s rounded entries: %.1e\n", name_of(GetParam()).c_str(), error);
  EXPECT_LT(error, 1e-7);
  EXPECT_GT(error, 1e-10);
}

/// Directions of conjugate gradients are renewed, multiplied and judged in the loops of the product.
TEST_P(BlockMatrixOf, ProductsOfTheNextDirectionAreThoseOfLoopsOfTheirOwn) {
  ThreadPool pool(3);
  CpuExecutor executor(model_.points, pool);
  const CpuVectors vectors(pool);
  BlockMatrix matrix(model_.points);
  Linearization lin;
  executor.linearize(state_, {}, Tangent::full, lin);
  executor.assemble(lin, matrix);
  matrix.round(pool);
  const std::vector<double> z = random_direction(model_);
  for (const bool rounded : {false, true}) {
    std::vector<double> x(z.size(), 0.0), next = x, y = x, product = x;
    for (const double s : {0.0, 0.7, -1e3}) {  // from nothing on, as a solve begins
      vectors.xpay(z, s, x);
      const double power = rounded ? matrix.multiply_rounded(pool, x, y) : matrix.multiply(pool, x, y);
      const double same = rounded ? matrix.multiply_next_rounded(pool, z, s, next, product)
                                  : matrix.multiply_next(pool, z, s, next, product);
      EXPECT_EQ(next, x) << s;
      EXPECT_EQ(product, y) << s;
      EXPECT_EQ(same, power) << s;
      EXPECT_NEAR(power, vectors.dot(x, y), 1e-13 * norm(x) * norm(y)) << s;
    }
  }
}

TEST_P(BlockMatrixOf, BlocksLieAtTheirPlaces) {
  BlockMatrix matrix(model_.points);
  for (int row = 0; row < matrix.rows(); ++row)
    for (int k = matrix.fills_upper() ? matrix.diagonal(row) : matrix.row_begin(row); k < matrix.row_begin(row + 1);
         ++k)
      ASSERT_EQ(matrix.at_place(matrix.place(k)), matrix.block(k));
}

INSTANTIATE_TEST_SUITE_P(All, BlockMatrixOf, testing::Values(Nodes::vertices, Nodes::rigid, Nodes::several),
                         [](const auto& parameter) { return name_of(parameter.param); });

}  // namespace
}  // namespace fascia::block_matrix_test
