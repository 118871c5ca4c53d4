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

struct ComplexEigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< as columns, of length 1
};

/// A v = λ v of any real A (n × n): real values are real exactly, others come in conjugate pairs.
ComplexEigenpairs general_eigen(const Eigen::MatrixXd& A);

/// Columns that span what those of A (n × m, n ≥ m) span, orthonormal: Q of its QR decomposition.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A);

}  // namespace fascia
