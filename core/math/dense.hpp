#pragma once

#include <Eigen/Core>

/// Dense linear algebra of small matrices, compiled once: templates of Eigen that take the compiler long. Not for hot
/// loops.
namespace fascia {

struct Eigenpairs {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< as columns
};

/// A v = λ v of a symmetric A (n × n); vectors are orthonormal. Reads the lower triangle.
Eigenpairs symmetric_eigen(const Eigen::MatrixXd& A);

/// A v = λ B v of a symmetric A and a symmetric positive definite B (n × n); vᵀ B v = 1.
Eigenpairs symmetric_eigen(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Columns that span what those of A (n × m, n ≥ m) span, orthonormal: Q of its QR decomposition.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A);

}  // namespace fascia
