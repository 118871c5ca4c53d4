#pragma once

namespace fascia {

/// Extreme eigenvalues of a tangent on the free degrees of freedom, scaled by its diagonal blocks (or its diagonal,
/// where that is the preconditioner): what conjugate gradients see, and what a factorisation loses.
struct TangentCondition {
  enum class Kind { left_out, not_definite, known };
  Kind kind = Kind::left_out;  ///< left out: nothing is free, or the factor costs too much
  double largest = 1, smallest = 1;
  int cg_iterations = 0;      ///< that conjugate gradients took for a load in all directions, with the run's settings
  bool cg_converged = false;  ///< false: they were ended there
  bool with_levels = false;   ///< levels were their preconditioner

  double ratio() const { return largest / smallest; }
  /// Decimal digits of a direct solve that rounding leaves: −log₁₀(ε κ).
  double digits() const;
};

}  // namespace fascia
