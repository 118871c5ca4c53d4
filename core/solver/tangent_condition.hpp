#pragma once

namespace fascia {

/// Extreme eigenvalues of a tangent on the free degrees of freedom, scaled by its diagonal blocks (or its diagonal,
/// where that is the preconditioner): what conjugate gradients see, and what a factorisation loses.
struct TangentCondition {
  enum class Kind { left_out, not_definite, known };
  Kind kind = Kind::left_out;  ///< left out: nothing is free, or the factor costs too much
  double largest = 1, smallest = 1;

  double ratio() const { return largest / smallest; }
  /// An upper estimate of the iterations that reduce the residual to a part: ½ √κ ln(2/tolerance).
  double cg_iterations(double tolerance) const;
  /// Decimal digits of a direct solve that rounding leaves: −log₁₀(ε κ).
  double digits() const;
};

}  // namespace fascia
