#include "core/linear/elimination_order.hpp"
#include "core/linear/cholesky.hpp"
#include "tests/support/tangent_at_rest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <vector>

namespace fascia::elimination_order_test {
namespace {

using namespace fascia::test;

Model held(Model model) {
  hold_face(model);
  return model;
}

/// Eliminates the nodes of a matrix one after the other: what each ties, it ties to one another.
struct Eliminated {
  double flops = 0, numbers = 0;

  Eliminated(const TangentAtRest& t, const std::vector<int>& nodes) {
    std::vector<std::set<int>> tied(at(t.matrix.rows()));
    std::vector<int> place(tied.size(), -1), free(tied.size(), 0);
    for (std::size_t k = 0; k < nodes.size(); ++k) place[at(nodes[k])] = static_cast<int>(k);
    for (const int i : nodes)
      for (int dof = t.matrix.dofs().begin(i); dof < t.matrix.dofs().begin(i) + t.matrix.dofs().size(i); ++dof)
        free[at(i)] += t.filter.is_fixed(at(dof)) ? 0 : 1;
    const auto tie = [&](int i, int j) {
      if (place[at(i)] >= 0 && place[at(j)] > place[at(i)]) tied[at(i)].insert(j);
      if (place[at(j)] >= 0 && place[at(i)] > place[at(j)]) tied[at(j)].insert(i);
    };
    for (int i = 0; i < t.matrix.rows(); ++i)
      for (const int j : t.matrix.columns(i)) tie(i, j);
    for (const int i : nodes) {
      int below = 0;
      for (const int j : tied[at(i)]) {
        below += free[at(j)];
        for (const int k : tied[at(i)]) tie(j, k);
      }
      for (int own = free[at(i)]; own > 0; --own) {
        numbers += own + below;
        flops += static_cast<double>(own + below) * (own + below);
      }
    }
  }
};

TEST(EliminationOrder, CountsWhatAFactorTakes) {
  BlockOptions o;
  o.grid = {7, 6, 5};
  for (const bool frames : {true, false})
    for (const bool whole : {true, false}) {
      Model model = frames ? std::move(build({block_spec(o)}).model) : vertex_block(o);
      if (whole)
        hold_face(model);
      else
        hold_face(model, 1, 0);
      const TangentAtRest t(std::move(model), 1);
      const EliminationOrder order = EliminationOrder::of(t.matrix, t.filter);
      const Eliminated counted(t, order.nodes);
      EXPECT_EQ(order.flops, counted.flops);
      EXPECT_EQ(order.numbers, counted.numbers);
      const BlockCholesky factor(t.matrix, t.filter, &order);
      EXPECT_EQ(factor.factor_flops(), order.flops);
      EXPECT_GE(factor.factor_bytes(), 8 * order.numbers);
      EXPECT_LE(factor.number_bytes(), 14 * order.numbers) << "zeros of joined columns, and above diagonals";
      EXPECT_LE(factor.factor_bytes(), factor.number_bytes() + 3e6) << "room to work in";
      EXPECT_TRUE(order.moderate());
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
