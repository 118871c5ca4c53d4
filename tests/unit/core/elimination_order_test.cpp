#include "core/linear/elimination_order.hpp"
#include "core/base/errors.hpp"
#include "core/linear/cholesky.hpp"
#include "tests/support/tangent_at_rest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace fascia::elimination_order_test {
namespace {

using namespace fascia::test;

Model held(Model model) {
  hold_face(model);
  return model;
}

/// Against what the analysis of single degrees of freedom counts.
TEST(EliminationOrder, CountsWhatAFactorTakes) {
  BlockOptions o;
  o.grid = {9, 9, 9};
  for (const bool frames : {true, false}) {
    TangentAtRest t(held(frames ? std::move(build({block_spec(o)}).model) : vertex_block(o)), 1);
    const EliminationOrder order = EliminationOrder::of(t.matrix, t.filter);
    const BlockCholesky factor(t.matrix, t.filter, Pivots::positive, &order);
    std::printf("%s: %.3g operations, of the factor %.3g; %.3g numbers\n", frames ? "frames" : "vertices", order.flops,
                factor.factor_flops(), order.numbers);
    EXPECT_NEAR(order.flops, factor.factor_flops(), 1e-9 * order.flops);
    EXPECT_GE(factor.factor_bytes(), 8 * order.numbers);
    EXPECT_LE(factor.factor_bytes(), 20 * order.numbers);
    EXPECT_TRUE(order.narrow());
  }
}

/// What a factor gives: without and with a shift, in 64 and 32 bits, and how many pivots are negative.
struct Given {
  std::vector<double> numbers;
  int negative_pivots;
  double bytes;
  bool operator==(const Given& other) const {
    return numbers == other.numbers && negative_pivots == other.negative_pivots;
  }
};

Given given_by(const TangentAtRest& t, const BlockMatrix& matrix, Pivots pivots, const EliminationOrder& order) {
  BlockCholesky factor(t.matrix, t.filter, pivots, &order);
  Given out{{}, 0, factor.factor_bytes()};
  std::vector<double> b(at(t.model.dof_count())), x(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = static_cast<double>(i % 7) - 3;
  for (const double shift : {0.0, 1e-3}) {
    EXPECT_TRUE(factor.factorize(matrix, shift, &t.matrix));
    factor.solve(b, x);
    out.numbers.insert(out.numbers.end(), x.begin(), x.end());
    factor.precondition(b, x);
    out.numbers.insert(out.numbers.end(), x.begin(), x.end());
  }
  out.negative_pivots = factor.negative_pivots();
  return out;
}

/// Supernodes and single columns. Factors that need them take 9 GB and more (docs/manual/limits.md).
TEST(EliminationOrder, WideIndicesMakeTheSameFactor) {
  for (const int n : {3, 9}) {
    BlockOptions o;
    o.grid = {n, n, n};
    const TangentAtRest t(held(vertex_block(o)), 1);
    BlockMatrix indefinite = t.matrix;
    for (double* number = indefinite.block(indefinite.diagonal(n * n * n / 2)); double& entry : std::span(number, 9))
      entry *= -1;
    const EliminationOrder order = EliminationOrder::of(t.matrix, t.filter);
    EliminationOrder large = order;
    large.numbers = 3e9;
    ASSERT_FALSE(large.narrow());
    for (const Pivots pivots : {Pivots::positive, Pivots::any}) {
      const BlockMatrix& matrix = pivots == Pivots::any ? indefinite : t.matrix;
      const Given narrow = given_by(t, matrix, pivots, order);
      EXPECT_EQ(narrow.negative_pivots > 0, pivots == Pivots::any);
      try {
        const Given wide = given_by(t, matrix, pivots, large);
        EXPECT_TRUE(wide == narrow) << n;
        EXPECT_GT(wide.bytes, narrow.bytes);
        EXPECT_LT(wide.bytes, 1.5 * narrow.bytes);
      } catch (const InputError& error) {  // a build that has no such indices
        EXPECT_NE(std::string(error.what()).find("without CHOLMOD"), std::string::npos) << error.what();
      }
    }
  }
}

/// Each node that has something free, once.
TEST(EliminationOrder, TakesEveryFreeNodeOnce) {
  TangentAtRest t(held(std::move(block().model)), 1);
  std::vector<int> nodes = EliminationOrder::of(t.matrix, t.filter).nodes, expected;
  std::sort(nodes.begin(), nodes.end());
  for (int i = 0; i < t.model.node_count(); ++i)
    if (t.filter.fixed_of(i) != 63U) expected.push_back(i);
  EXPECT_EQ(nodes, expected);
  EXPECT_LT(expected.size(), at(t.model.node_count()));
}

/// What is told without the best order holds for it too.
TEST(EliminationOrder, ARoughOneIsEnoughWhereEveryOneIsFarBeyond) {
  BlockOptions o;
  o.grid = {14, 14, 14};
  TangentAtRest t(held(vertex_block(o)), 1);
  const EliminationOrder best = EliminationOrder::of(t.matrix, t.filter);
  EXPECT_FALSE(best.rough);
  const EliminationOrder rough = EliminationOrder::of(t.matrix, t.filter, 0.01 * best.flops);
  std::printf("%.3g operations by minimum degree, %.3g at best\n", rough.flops, best.flops);
  EXPECT_GE(rough.flops, best.flops);
  for (const double part : {0.01, 0.1, 0.3, 0.9, 0.999}) {
    const double limit = part * best.flops;
    if (EliminationOrder::of(t.matrix, t.filter, limit).exceeds(limit)) continue;
    ADD_FAILURE() << part;
  }
  EXPECT_FALSE(best.exceeds(1.001 * best.flops));
  EXPECT_EQ(EliminationOrder::of(t.matrix, t.filter, 1.001 * best.flops).flops, best.flops);
}

}  // namespace
}  // namespace fascia::elimination_order_test
