#include "core/linear/supernodes.hpp"

#include "core/base/index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace fascia::supernodes_test {
namespace {

/// Adds a binary elimination tree in postorder, by the parents of its supernodes. @return  its root
int add_binary(int levels, std::vector<int>& parent) {
  const int left = levels > 1 ? add_binary(levels - 1, parent) : -1,
            right = levels > 1 ? add_binary(levels - 1, parent) : -1;
  const int own = static_cast<int>(parent.size());
  parent.push_back(-1);
  if (left >= 0) parent[at(left)] = parent[at(right)] = own;
  return own;
}
std::vector<int> binary(int levels) {
  std::vector<int> parent;
  add_binary(levels, parent);
  return parent;
}

/// A chain, each link of which has one more child.
std::vector<int> chain(int links) {
  std::vector<int> parent;
  for (int link = 0; link < links; ++link) {
    parent.push_back(2 * link + 1);
    parent.push_back(link + 1 < links ? 2 * link + 3 : -1);
  }
  return parent;
}

/// A factor with this elimination tree. Each supernode has rows in those above it.
struct RandomFactor {
  std::vector<int> first_column{0}, row;
  std::vector<std::int64_t> row_begin{0}, value_begin{0};
  std::vector<double> value, sign;  ///< no sign: all are positive

  /// @param widest  columns of a supernode, 1 to this
  RandomFactor(const std::vector<int>& parent, int widest, std::mt19937& random) {
    for (std::size_t s = 0; s < parent.size(); ++s)
      first_column.push_back(first_column.back() + 1 + static_cast<int>(random() % at(widest)));
    std::uniform_real_distribution<double> entry(-1, 1);
    for (std::size_t s = 0; s < parent.size(); ++s) {
      for (int r = first_column[s]; r < first_column[s + 1]; ++r) row.push_back(r);
      for (int p = parent[s]; p >= 0; p = parent[at(p)])
        for (int r = first_column[at(p)]; r < first_column[at(p + 1)]; ++r)
          if (r == first_column[at(parent[s])] || random() % 2 == 0) row.push_back(r);
      const int columns = first_column[s + 1] - first_column[s],
                rows = static_cast<int>(row.size()) - static_cast<int>(row_begin.back());
      for (int j = 0; j < columns; ++j)
        for (int i = 0; i < rows; ++i)
          value.push_back(i < j ? std::nan("") : i == j ? 3 + entry(random) : entry(random) / rows);
      row_begin.push_back(static_cast<std::int64_t>(row.size()));
      value_begin.push_back(static_cast<std::int64_t>(value.size()));
    }
  }
  template <class T>
  Supernodes<T> view(const std::vector<T>& numbers) const {
    return {first_column, row_begin, value_begin, row, numbers, sign};
  }

  /// L Lᵀ x
  std::vector<double> product(const std::vector<double>& x) const {
    std::vector<double> turned(x.size()), out(x.size());
    for_each([&](std::size_t i, std::size_t j, double L) { turned[j] += L * x[i]; });
    for (std::size_t j = 0; j < sign.size(); ++j) turned[j] *= sign[j];
    for_each([&](std::size_t i, std::size_t j, double L) { out[i] += L * turned[j]; });
    return out;
  }

 private:
  /// Calls act(i, j, L_ij).
  template <class Act>
  void for_each(const Act& act) const {
    for (std::size_t s = 0; s + 1 < first_column.size(); ++s) {
      const int* own = row.data() + row_begin[s];
      const int rows = static_cast<int>(row_begin[s + 1] - row_begin[s]),
                columns = first_column[s + 1] - first_column[s];
      for (int j = 0; j < columns; ++j)
        for (int i = j; i < rows; ++i)
          act(at(own[i]), at(first_column[s] + j), value[at(static_cast<int>(value_begin[s]) + j * rows + i)]);
    }
  }
};

std::vector<double> random_numbers(int count, std::mt19937& random) {
  std::vector<double> x(at(count));
  for (double& number : x) number = std::uniform_real_distribution<double>(-1, 1)(random);
  return x;
}

template <class T>
std::vector<double> solved(const RandomFactor& factor, const std::vector<T>& numbers, std::vector<double> b,
                           int threads, int most_subtrees) {
  ThreadPool pool(threads);
  SupernodeSolver solver(factor.view(numbers));
  EXPECT_EQ(solver.subtrees() > 1, most_subtrees > 1);
  EXPECT_LE(solver.subtrees(), most_subtrees);
  solver.solve(factor.view(numbers), threads > 1 ? &pool : nullptr, b);
  return b;
}

void expect_near(const std::vector<double>& x, const std::vector<double>& wanted, double tolerance) {
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(x[i], wanted[i], tolerance) << "row " << i << " of " << x.size();
}

TEST(Supernodes, SolveWhatTheirFactorTimesItsTransposeMakes) {
  std::mt19937 random(7);
  struct Size {
    int levels, widest, most_subtrees;
  };
  for (const Size size : {Size{1, 1, 0}, Size{1, 40, 0}, Size{2, 5, 0}, Size{4, 17, 0}, Size{7, 40, 100}}) {
    const RandomFactor factor(binary(size.levels), size.widest, random);
    const std::vector<double> wanted = random_numbers(factor.first_column.back(), random), b = factor.product(wanted);
    expect_near(solved(factor, factor.value, b, 1, size.most_subtrees), wanted, 1e-12);
    const std::vector<float> rounded(factor.value.begin(), factor.value.end());
    expect_near(solved(factor, rounded, b, 1, size.most_subtrees), wanted, 1e-4);
  }
}

/// Such a subtree would have sums for all of the chain.
TEST(Supernodes, LeaveSmallSubtreesOfALongChainOnTop) {
  std::mt19937 random(3);
  const RandomFactor factor(chain(60), 20, random);
  const std::vector<double> wanted = random_numbers(factor.first_column.back(), random);
  ASSERT_GT(factor.value.size(), 100000U);
  expect_near(solved(factor, factor.value, factor.product(wanted), 1, 0), wanted, 1e-12);
}

TEST(Supernodes, AreSolvedAlikeByAnyNumberOfThreads) {
  std::mt19937 random(5);
  const RandomFactor factor(binary(7), 40, random);
  const std::vector<double> b = random_numbers(factor.first_column.back(), random);
  const std::vector<double> alone = solved(factor, factor.value, b, 1, 100);
  for (const int threads : {2, 3, 7}) EXPECT_EQ(solved(factor, factor.value, b, threads, 100), alone);
}

/// L S Lᵀ x = b
TEST(Supernodes, TakeSignsBetweenTheirTriangles) {
  std::mt19937 random(5);
  RandomFactor factor(binary(7), 40, random);
  const std::vector<double> wanted = random_numbers(factor.first_column.back(), random);
  for (double number : random_numbers(factor.first_column.back(), random)) factor.sign.push_back(number < 0 ? -1 : 1);
  expect_near(solved(factor, factor.value, factor.product(wanted), 2, 100), wanted, 1e-12);
}

}  // namespace
}  // namespace fascia::supernodes_test
