#pragma once

#include "core/tangent/cg_solver.hpp"
#include "core/tangent/factor_solver.hpp"
#include "core/tangent/preconditioners.hpp"
#include "core/tangent/tangent_operator.hpp"

#include <span>

namespace fascia {

/// Serves the solves of many steps with one factor: it preconditions a few iterations of conjugate gradients, whose
/// products go from block to block, so that most solves neither assemble nor factorise. Costs are counted, no clock is
/// read.
class KeptFactor {
 public:
  /// @param factor  of K, which others may make anew: renewed() tells so
  KeptFactor(TangentOperator& K, FactorSolver& factor, CgSolver& cg)
      : K_(K), factor_(factor), cg_(cg), old_(K, factor) {}

  /// Solves with the factor of a tangent before. The report is of no use, and says how many iterations it took to find
  /// out, where there is none; where it is out of date, when it is gone; and for a while after factors served next to
  /// no solve. Time does not limit the iterations: a factor would take more of it.
  /// @param tolerance  on what is left of b in the norm of conjugate gradients, 0.01 at the most
  LinearReport solve(std::span<const double> b, std::span<double> x, double tolerance);

  /// The factor was made of K as it is.
  void renewed();
  /// Forgets the factor, and how many solves factors served.
  void begin_afresh() {
    old_.forget();
    rest_ = recent_factors_ = recent_solves_ = 0;
  }

  /// Solves that took factors of their own tangents, and of others.
  int factors() const { return factors_; }
  int solves() const { return solves_; }

  /// A kept factor is likely to be clearly cheaper than so many iterations with blocks and the assembly before them,
  /// which takes a millisecond at least.
  bool takes_less_than_blocks(double iterations);
  /// Factors served so few solves that none is kept for a while.
  bool rests() const { return rest_ > 0; }

 private:
  TangentOperator& K_;
  FactorSolver& factor_;
  CgSolver& cg_;
  OldFactor old_;
  int factors_ = 0, solves_ = 0;
  int recent_factors_ = 0, recent_solves_ = 0;  ///< those of long ago count less
  int rest_ = 0;                                ///< solves
};

}  // namespace fascia
