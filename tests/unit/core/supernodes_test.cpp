#include "core/linear/supernodes.hpp"

#include "core/base/index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace fascia::supernodes_test {
namespace {

/// A factor with supernodes of these many columns, each above some rows of those that follow.
struct RandomFactor {
  std::vector<int> first_column{0}, row_begin{0}, value_begin{0}, row;
  std::vector<double> value;

  RandomFactor(const std::vector<int>& columns, std::mt19937& random) {
    std::uniform_real_distribution<double> entry(-1, 1);
    for (const int n : columns) first_column.push_back(first_column.back() + n);
    for (std::size_t s = 0; s < columns.size(); ++s) {
      for (int r = first_column[s]; r < first_column.back(); ++r)
        if (r < first_column[s + 1] || random() % 3 == 0) row.push_back(r);
      const int rows = static_cast<int>(row.size()) - row_begin.back();
      for (int j = 0; j < columns[s]; ++j)
        for (int i = 0; i < rows; ++i)
          value.push_back(i < j ? std::nan("") : i == j ? 3 + entry(random) : entry(random) / rows);
      row_begin.push_back(static_cast<int>(row.size()));
      value_begin.push_back(static_cast<int>(value.size()));
    }
  }
  template <class T>
  Supernodes<T> view(const std::vector<T>& numbers) const {
    return {first_column, row_begin, value_begin, row, numbers};
  }

  /// Calls act(i, j, L_ij).
  template <class Act>
  void for_each(const Act& act) const {
    for (std::size_t s = 0; s + 1 < first_column.size(); ++s) {
      const int rows = row_begin[s + 1] - row_begin[s], columns = first_column[s + 1] - first_column[s];
      for (int j = 0; j < columns; ++j)
        for (int i = j; i < rows; ++i)
          act(at(row[at(row_begin[s] + i)]), at(first_column[s] + j), value[at(value_begin[s] + j * rows + i)]);
    }
  }
};

TEST(Supernodes, SolveWhatTheirFactorTimesItsTransposeMakes) {
  std::mt19937 random(7);
  const std::vector<std::vector<int>> all{{1}, {4}, {7}, {1, 1, 1}, {5, 1, 9, 2, 12, 40}, {3, 8, 33, 4, 1, 17, 64}};
  for (const std::vector<int>& columns : all) {
    const RandomFactor factor(columns, random);
    const auto n = at(factor.first_column.back());
    std::vector<double> wanted(n), turned(n), b(n), work(at(factor.view(factor.value).most_rows()), std::nan(""));
    for (double& x : wanted) x = std::uniform_real_distribution<double>(-1, 1)(random);
    factor.for_each([&](std::size_t i, std::size_t j, double L) { turned[j] += L * wanted[i]; });
    factor.for_each([&](std::size_t i, std::size_t j, double L) { b[i] += L * turned[j]; });
    std::vector<double> x = b;
    solve(factor.view(factor.value), std::span(x), std::span(work));
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(x[i], wanted[i], 1e-13) << columns.size() << " supernodes, row " << i;
    const std::vector<float> rounded(factor.value.begin(), factor.value.end());
    x = b;
    solve(factor.view(rounded), std::span(x), std::span(work));
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(x[i], wanted[i], 1e-5) << columns.size() << " supernodes, row " << i;
  }
}

}  // namespace
}  // namespace fascia::supernodes_test
