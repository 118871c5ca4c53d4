#include "core/math/dense.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::dense_test {
namespace {

constexpr double kRounding = 1e-13;  ///< of matrices of eight rows with entries about 1

Eigen::MatrixXd full(int rows, int columns) {
  Eigen::MatrixXd A(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) A(i, k) = std::cos(1.0 + i * (2 * k + 1));
  return A;
}

TEST(Dense, EigenpairsSatisfyTheirEquation) {
  const Eigen::MatrixXd A = full(8, 8) + full(8, 8).transpose();
  const Eigenpairs pairs = symmetric_eigen(A);
  EXPECT_LT((A * pairs.vectors - pairs.vectors * pairs.values.asDiagonal()).norm(), kRounding);
  EXPECT_LT((pairs.vectors.transpose() * pairs.vectors - Eigen::MatrixXd::Identity(8, 8)).norm(), kRounding);
  for (int k = 1; k < 8; ++k) EXPECT_LE(pairs.values[k - 1], pairs.values[k]);
}

TEST(Dense, GeneralEigenpairsSatisfyTheirEquation) {
  const Eigen::MatrixXd A = full(8, 8) + full(8, 8).transpose();
  const Eigen::MatrixXd B = full(8, 8) * full(8, 8).transpose() + 4 * Eigen::MatrixXd::Identity(8, 8);
  const Eigenpairs pairs = symmetric_eigen(A, B);
  EXPECT_LT((A * pairs.vectors - B * pairs.vectors * pairs.values.asDiagonal()).norm(), 10 * kRounding);
  EXPECT_LT((pairs.vectors.transpose() * B * pairs.vectors - Eigen::MatrixXd::Identity(8, 8)).norm(), 10 * kRounding);
}

TEST(Dense, OrthonormalColumnsSpanTheSame) {
  const Eigen::MatrixXd A = full(8, 3), Q = orthonormal(A);
  ASSERT_EQ(Q.cols(), 3);
  EXPECT_LT((Q.transpose() * Q - Eigen::MatrixXd::Identity(3, 3)).norm(), kRounding);
  EXPECT_LT((A - Q * (Q.transpose() * A)).norm(), kRounding);
}

}  // namespace
}  // namespace fascia::dense_test
