#include "core/math/dense.hpp"
#include "core/math/principal_axes.hpp"

#include <Eigen/Dense>

namespace fascia {

PrincipalAxes principal_axes(const Mat3d& S) {
  const Eigen::Matrix3d A = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&S.m[0][0]);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(A);
  PrincipalAxes principal;
  for (int k = 0; k < 3; ++k) {
    principal.values[k] = solver.eigenvalues()[k];
    for (int i = 0; i < 3; ++i) principal.axes[k][i] = solver.eigenvectors()(i, k);
  }
  return principal;
}

Eigenpairs symmetric_eigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigenpairs symmetric_eigen(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(A, B);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

ComplexEigenpairs general_eigen(const Eigen::MatrixXd& A) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ() * Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

}  // namespace fascia
