#pragma once

#include "core/linear/cholesky.hpp"
#include "core/tangent/linear_solver.hpp"
#include "core/tangent/tangent_operator.hpp"

#include <optional>
#include <span>
#include <vector>

namespace fascia {

/// Solves with a factor: L Lᵀ of a positive definite tangent, or L S Lᵀ of any, whose pivots tell in how many
/// directions the equilibrium is unstable.
class FactorSolver final : public LinearSolver {
 public:
  /// @param K  belongs to the caller
  explicit FactorSolver(TangentOperator& K) : K_(K) {}

  /// False where K with the terms beside it is not positive definite.
  bool prepare() override;
  /// False where a pivot vanishes.
  bool prepare_any();
  /// Takes K + s · diagonal of its material part, with the smallest s of a few that is enough. False where none is.
  bool prepare_shifted();

  /// Forgets which shift was enough before.
  void begin_afresh() { shift_ = 0; }

  /// Takes the terms beside K as they are now, with the factor of a K as good as the same.
  void renew_terms();
  /// Takes them for precondition(), with the factor of a K met before.
  void renew_terms_of_preconditioner();
  /// The factor is L Lᵀ of a tangent that was positive definite, that of K as it is now or one met before.
  bool preconditions();
  /// x = M⁻¹ b with the factor as it is, and the terms beside K that were taken last.
  void apply_inverse(std::span<const double> b, std::span<double> x);
  /// About the same, for conjugate gradients: BlockCholesky::precondition().
  void precondition(std::span<const double> b, std::span<double> x);

  /// After a shift: a direction of descent.
  LinearReport solve(std::span<const double> b, std::span<double> x, double rough = 0) override;
  /// With a step of refinement, since L S Lᵀ has no pivoting. False where rounding spoils the solution: K is all but
  /// singular.
  bool solve_refined(std::span<const double> b, std::span<double> x);
  bool iterates() const override { return false; }

  /// K is positive definite, as it was prepared last: not shifted.
  bool definite() const { return definite_; }
  /// Directions of negative curvature, as it was prepared last.
  int negative() const { return negative_; }

  /// How nodes are eliminated; known before a factor is made.
  const EliminationOrder& order();
  /// An order that is known, perhaps a rough one; null where nobody asked.
  const EliminationOrder* known_order() const {
    return order_.has_value() && pattern_ == K_.pattern_revision() ? &*order_ : nullptr;
  }
  /// Counts the numbers of the matrix, below and above its diagonal.
  double matrix_numbers();
  /// A factor takes more operations than these, whatever the order.
  bool takes_more_than(double flops);
  /// A factor fits into memory.
  bool fits();
  BlockCholesky& cholesky();

 private:
  static constexpr double kMostBytes = 2e9;
  void follow_pattern();
  bool prepare_with(Pivots pivots);
  void finish_shifted(std::span<const double> b, std::span<double> x);

  TangentOperator& K_;
  std::optional<EliminationOrder> order_;
  std::optional<BlockCholesky> cholesky_;
  long pattern_ = 0;  ///< of K, that these were made of
  bool definite_ = false;
  int negative_ = 0;
  double shift_ = 0;      ///< of the last factorisation that needed one
  bool shifted_ = false;  ///< the last factor is such
  std::vector<double> rest_, correction_;
};

}  // namespace fascia
