#include "core/math/polar.hpp"

#include <Eigen/Dense>

namespace fascia {

Mat3d nearest_rotation_increment(const Mat3d& H) {
  Eigen::Matrix3d F;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) F(i, j) = H(i, j) + (i == j ? 1 : 0);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  const Eigen::Matrix3d R = U * svd.matrixV().transpose();
  Mat3d D;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) D(i, j) = R(i, j) - (i == j ? 1 : 0);
  return orthonormalized_increment(D);
}

}  // namespace fascia
