#include "core/math/polar.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <limits>
#include <random>

namespace fascia::polar_test {

namespace {

struct Nearest {
  Mat3d R;
  double gap = 0;  ///< of the two smallest singular values, the last with the sign of det F: what fixes R
  double largest = 0;
};

/// U Vᵀ of a singular value decomposition by Eigen.
Nearest by_singular_values(const Mat3d& F) {
  Eigen::Matrix3d M;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) M(i, j) = F(i, j);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  const bool mirrored = (U * svd.matrixV().transpose()).determinant() < 0;
  if (mirrored) U.col(2) *= -1;
  const Eigen::Matrix3d R = U * svd.matrixV().transpose();
  Nearest n;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) n.R(i, j) = R(i, j);
  const auto& s = svd.singularValues();
  n.gap = s[1] + (mirrored ? -s[2] : s[2]);
  n.largest = s[0];
  return n;
}

Mat3d random_matrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Mat3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = normal(random);
  return m;
}

Mat3d random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Mat3d::identity() + rotation_increment({{normal(random), normal(random), normal(random)}});
}

void expect_nearest(const Mat3d& matrix) {
  const Mat3d I = Mat3d::identity(), H = matrix - I, F = I + H;  // rounded as the function sees it
  const Nearest wanted = by_singular_values(F);
  const Mat3d R = I + nearest_rotation_increment(H);
  EXPECT_LT(norm(times_transpose(R, R) - I), 1e-14);
  EXPECT_NEAR(determinant(R), 1, 1e-14);
  // No rotation is nearer, also where several are equally near.
  EXPECT_NEAR(contract(R, F), contract(wanted.R, F), 1e-14 * wanted.largest);
  if (wanted.gap > 1e-6 * wanted.largest) {
    EXPECT_LT(norm(R - wanted.R), 4e-15 * wanted.largest / wanted.gap);
  }
}

TEST(Polar, AgreesWithSingularValues) {
  std::mt19937 random(7);
  for (int k = 0; k < 2000; ++k) expect_nearest(random_matrix(random));
}

TEST(Polar, HoldsForNearlySingularAndInvertedMatrices) {
  std::mt19937 random(8);
  for (const double last : {1e-2, 1e-8, 1e-13, 1e-17, 0.0, -1e-17, -1e-8, -1e-2, -0.5})
    for (int k = 0; k < 100; ++k) {
      const Mat3d U = random_rotation(random), V = random_rotation(random);
      for (const double middle : {0.7, 1e-3, 1.0}) {
        Mat3d s = Mat3d::diagonal(1.3);
        s(1, 1) = middle;
        s(2, 2) = last;
        expect_nearest(times_transpose(U * s, V));
        expect_nearest(times_transpose(U * s, V) * 1e-9);
      }
    }
}

TEST(Polar, HoldsWhereItLeavesRotationsOpen) {
  std::mt19937 random(9);
  EXPECT_EQ(norm(nearest_rotation_increment(Mat3d::diagonal(-1))), 0);  // F = 0
  expect_nearest(Mat3d::diagonal(-1));
  expect_nearest(Mat3d::diagonal(-0.3));
  for (int k = 0; k < 100; ++k) {
    const Mat3d M = random_matrix(random);
    expect_nearest(outer(M.row(0), M.row(1)));  // of rank one
    expect_nearest(outer(M.row(0), M.row(0)));
    expect_nearest(outer(M.row(0), M.row(0)) * -1.0);
  }
}

TEST(Polar, BatchesAgreeWithSingleMatrices) {
  std::mt19937 random(10);
  for (int k = 0; k < 200; ++k) {
    Mat3d single[kBatchWidth];
    Mat3<Lanes> H;
    for (int lane = 0; lane < kBatchWidth; ++lane) {
      single[lane] = random_matrix(random);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) H(i, j).v[lane] = single[lane](i, j);
    }
    const Mat3<Lanes> D = nearest_rotation_increment(H);
    for (int lane = 0; lane < kBatchWidth; ++lane) {
      const double gap = by_singular_values(Mat3d::identity() + single[lane]).gap;
      const Mat3d wanted = nearest_rotation_increment(single[lane]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(D(i, j).v[lane], wanted(i, j), 1e-13 / gap);
    }
  }
}

TEST(Polar, KeepsTheDigitsOfSmallTurns) {
  const Vec3d r{{1e-9, -2e-9, 3e-9}};
  const Mat3d D = rotation_increment(r);
  EXPECT_LT(norm(nearest_rotation_increment(D) - D), 1e-14 * norm(r));
}

TEST(Polar, IsNotFiniteWhereTheMatrixIsNot) {
  Mat3d H;
  H(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(norm(nearest_rotation_increment(H))));
}

}  // namespace

}  // namespace fascia::polar_test
