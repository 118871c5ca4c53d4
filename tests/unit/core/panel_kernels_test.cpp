#include "core/linear/panel_kernels.hpp"
#include "core/base/index.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace fascia::panel_kernels_test {
namespace {

std::vector<double> random_numbers(int count, std::mt19937& random) {
  std::vector<double> x(at(count));
  for (double& number : x) number = std::uniform_real_distribution<double>(-1, 1)(random);
  return x;
}

/// Sizes lie around a tile's and a register's; rows are in place and packed, with signs and without.
TEST(PanelKernels, SubtractProducts) {
  std::mt19937 random(1);
  for (const int m : {1, 3, 8, 9, 17, 24, 25, 50})
    for (const int n : {1, 2, 4, 5, 7, 8, 9, 16, 21})
      for (const int k : {1, 5, 30}) {
        const int a_stride = panel::padded(m) + 3, b_stride = n + 2, stride = panel::padded(m) + 1;
        const std::vector<double> a = random_numbers(a_stride * k, random), b = random_numbers(b_stride * k, random),
                                  before = random_numbers(stride * n + panel::kTileRows, random);
        std::vector<double> sign = random_numbers(k, random);
        for (double& s : sign) s = s < 0 ? -1 : 1;
        for (const double* signs : {static_cast<const double*>(nullptr), static_cast<const double*>(sign.data())})
          for (const bool packed : {true, false}) {
            std::vector<double> left(at((m + panel::kTileRows) * k)), right(at(n * k));
            panel::pack_left(a.data(), at(a_stride), m, k, left.data());
            panel::pack_right(b.data(), at(b_stride), n, k, signs, right.data());
            for (const bool lower : {false, true}) {
              std::vector<double> c = before;
              panel::subtract_product(m, n, k, packed ? panel::Left{left.data()} : panel::Left{a.data(), at(a_stride)},
                                      right.data(), c.data(), at(stride), lower);
              for (int j = 0; j < n; ++j)
                for (int i = lower ? j : 0; i < m; ++i) {
                  double sum = 0;
                  for (int q = 0; q < k; ++q)
                    sum += a[at(q * a_stride + i)] * b[at(q * b_stride + j)] * (signs == nullptr ? 1 : signs[q]);
                  const double expected = before[at(j * stride + i)] - sum;
                  ASSERT_NEAR(c[at(j * stride + i)], expected, 1e-13) << m << " " << n << " " << k << " " << packed;
                }
              for (int i = m; packed && i < panel::padded(m); ++i) ASSERT_EQ(c[at(i)], before[at(i)]) << "zeros";
            }
          }
      }
}

/// L S Lᵀ of a panel, of its rows at once and of those below its diagonal apart, is the matrix again.
TEST(PanelKernels, FactorizePanels) {
  std::mt19937 random(2);
  for (const int columns : {1, 3, 8, 13, 40})
    for (const bool any : {false, true}) {
      const int rows = columns + 21, stride = panel::padded(rows), below = panel::padded(rows - columns);
      std::vector<double> t(at(stride * columns + stride), 0.0);
      for (int j = 0; j < columns; ++j)
        for (int i = j; i < rows; ++i)
          t[at(j * stride + i)] = std::uniform_real_distribution<double>(-1, 1)(random) +
                                  (i == j ? (any && j % 3 == 1 ? -2.0 * columns : 2.0 * columns) : 0);
      const std::vector<double> matrix = t;
      std::vector<double> sign(at(columns), 0.0), least(at(columns), 0.0), scratch(at(columns * columns) + 64),
          apart(at(below * columns), 0.0);
      for (int j = 0; j < columns; ++j)
        for (int i = columns; i < rows; ++i) apart[at(j * below + i - columns)] = matrix[at(j * stride + i)];
      double* signs = any ? sign.data() : nullptr;
      ASSERT_TRUE(panel::factorize_diagonal(t.data(), at(stride), rows, columns, signs, least.data(), scratch.data()));
      panel::solve_rows(apart.data(), at(below), rows - columns, columns, t.data(), at(stride), signs, scratch.data());
      for (int j = 0; j < columns; ++j)
        for (int i = j; i < rows; ++i) {
          double sum = 0;
          for (int q = 0; q <= j; ++q) sum += t[at(q * stride + i)] * t[at(q * stride + j)] * (any ? sign[at(q)] : 1);
          EXPECT_NEAR(sum, matrix[at(j * stride + i)], 1e-12 * columns);
        }
      for (int j = 0; j < columns; ++j)
        for (int i = columns; i < rows; ++i)
          EXPECT_NEAR(apart[at(j * below + i - columns)], t[at(j * stride + i)], 1e-14);
      for (int j = 0; any && j < columns; ++j) EXPECT_EQ(sign[at(j)], j % 3 == 1 ? -1 : 1);
    }
}

}  // namespace
}  // namespace fascia::panel_kernels_test
