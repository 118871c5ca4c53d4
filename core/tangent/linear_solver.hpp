#pragma once

#include <span>
#include <string>

namespace fascia {

/// Says what a solve of K x = b came to.
struct LinearReport {
  bool usable = true;     ///< x is the solution, or what was reached of it, or a descent direction
  bool unsolved = false;  ///< ended at its limit of iterations
  int negative = 0;       ///< directions of negative curvature that it met; of iterations 1 stands for any number
  int iterations = 0;
  double residual = 0;  ///< |r| / |b| that iterations left; 0 of a direct solve, whose rest is rounding
  double seconds = 0;   ///< in iterations
  std::string trouble;  ///< a sentence where K is not positive definite, or nothing of use was found
};

/// Solves K x = b on the free degrees of freedom of a tangent, or of its symmetric part. It belongs to one
/// TangentOperator, which it asks for what it needs: products, the matrix, its diagonal blocks, rigid motions.
///
/// A solver of another kind is a class that derives from this one (LinearSettings::own). GMRES for the tangents of
/// loads without a potential, inverse iteration for the softest direction, and prescribed motions come on top of any.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Makes ready for K as it is now. @return  false where this cannot take it: it is not positive definite, say
  virtual bool prepare() = 0;

  /// Solves with a K that prepare() took. Vectors are in constraint axes; held and dependent entries of b are zero, and
  /// those of x become zero.
  /// @param rough  a tolerance on |r| / |b| that is enough, where it is coarser than the solver's own
  virtual LinearReport solve(std::span<const double> b, std::span<double> x, double rough = 0) = 0;

  /// Each solve takes iterations, so that another digit has its price.
  virtual bool iterates() const = 0;
  /// The time that a step has is used up: another solve would take it beyond its budget.
  virtual bool spent() const { return false; }
};

}  // namespace fascia
