#pragma once

#include "core/tangent/cg_solver.hpp"
#include "core/tangent/factor_solver.hpp"
#include "core/tangent/kept_factor.hpp"
#include "core/tangent/linear_settings.hpp"
#include "core/tangent/linear_solver.hpp"
#include "core/tangent/stability.hpp"
#include "core/tangent/tangent_condition.hpp"
#include "core/tangent/tangent_operator.hpp"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fascia {

struct TangentReport : LinearReport {
  bool indefinite = false;  ///< as in DirectionReport
};

/// Which solver was taken last, and the counts that speak for it.
struct SolverChoice {
  bool direct = false;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;  ///< of CG; automatic: blocks
  double flops = 0, numbers = 0;                                      ///< of a factor; 0: nobody asked
  double flops_per_number = 0;                                        ///< of the matrix
  std::vector<int> levels;                                            ///< nodes of each, the finest first
  int factors = 0, old = 0;  ///< solves with a factor of their own tangent, and of another one
};

/// Chooses among linear solvers for the tangents of a run, and sees to it that Newton's method gets a descent direction
/// where K is not positive definite. Vectors are in constraint axes; of dependent nodes their entries are zero.
class TangentSolver {
 public:
  /// Up to here statics take a factor, which is a matter of a second or two, whatever the conditioning. Levels may be
  /// twice as fast on a bulky body, and slower on a slender one (docs/manual/solvers.md).
  static constexpr int kDirectDofs = 10000;
  /// Up to here dynamics do too.
  static constexpr int kDirectDofsWithInertia = 500;
  /// From so many operations of a factor for each number of the matrix on, CG is taken beyond those unknowns: those of
  /// the iterations that a bulky body needs with blocks, or of 40 cycles with their levels, where a factor's operations
  /// run four times as fast as those of products, which wait for memory.
  static constexpr double kFlopsPerNumber = 2000;

  TangentSolver(const Model& model, CpuExecutor& executor, const DofFilter& filter, const LinearSettings& settings);

  /// @param relinearize  gives a tamer tangent at the same state; called only where the full one fails
  TangentReport solve(const Linearization& at, std::span<const double> prescribed, std::span<const double> b,
                      std::span<double> x, const Relinearize& relinearize);

  /// Sets a limit to iterations of CG in solves to come, where it is below that of the settings. Solves that end there
  /// say nothing of the solver's choice.
  void limit_iterations(int most) { cg_.limit_iterations(most); }

  /// Inertia stands beside the stiffness in tangents to come, which makes conjugate gradients with blocks quick on most
  /// bodies, however small. Where the choice is the program's they go first then, and a factor or levels follow where
  /// they take long.
  void expect_inertia(bool expected);

  /// Solves to come may leave this part of the gradient, in the norm of conjugate gradients, for Newton's method to end
  /// with them, if a tangent were all that there is to the equations.
  /// @param linear  it is: conjugate gradients go on to that
  void aim_at(double left, bool linear) {
    left_ = left;
    cg_.aim_at(linear ? left : 0);
  }

  /// Lets a factor serve the tangents of other steps too, in dynamics, or not: at first it does not.
  void keep_factors(bool keep) { keeps_ = keep; }
  /// The next tangents are of other steps than those before: the factor of these goes, and what was seen of it.
  void forget_kept_factor() { kept_factor_.begin_afresh(); }

  /// Factorises K as it is, indefinite or not, and counts the directions in which the equilibrium is unstable. None
  /// where a pivot vanishes.
  std::optional<int> factorize_as_is(const Linearization& at);
  /// Solves with that factor and the same tangent, which is still held. False where rounding spoils the solution: K is
  /// all but singular.
  bool solve_as_is(std::span<const double> prescribed, std::span<const double> b, std::span<double> x);

  /// The softest direction of a tangent, and how many negative ones it has: from a factor where one is at hand or cheap
  /// beside the iterations that CG has made, else by CG.
  /// @param made     iterations of CG in the run so far
  /// @param current  `at` is that of the last solve, but for a correction too small to matter
  SoftestDirection softest(const Linearization& at, long made, bool current);

  /// Looks at a tangent that is symmetric and positive definite: eigenvalues by Lanczos iterations, to about a percent.
  /// @param most_flops  a factor that takes more operations is left out
  TangentCondition condition(const Linearization& at, double most_flops);

  /// Levels of rigid frames of a tangent, for solves elsewhere; null where one of them is not positive definite.
  /// @param material  the tangent is without all that stress does
  const Multigrid* levels(const Linearization& at, bool material);

  /// Forgets all that solves before have taught: what comes next depends on the tangents to come alone.
  void begin_afresh();

  /// A factor is used, and neither CG nor a solver of the caller's.
  bool direct();
  SolverChoice choice();
  /// The tangent that was taken last, which may be none yet.
  TangentOperator& tangent() { return K_; }
  FactorSolver& factor() { return factor_; }
  /// A factor takes less than a tenth of the time of CG so far: its operations run several times faster than those of
  /// products, which wait for memory.
  bool factor_is_cheap(long made);
  /// A factor that fits into memory takes over where CG, which was only a guess, needs so many iterations for a solve
  /// (a slender body).
  bool gives_way_to_factor(long iterations);
  /// A factor that is kept over many steps takes the place of blocks that need so many iterations for a solve.
  bool gives_way_to_kept_factor(double iterations);

 private:
  bool blocks_go_first() const;
  bool keeps_factor() const;
  bool factor_is_small();
  bool guessed() const { return settings_.linear == LinearMethod::automatic && !own_; }
  LinearSolver& iterative() { return own_ ? *own_ : cg_; }
  void set_right_side(std::span<const double> prescribed, std::span<const double> b, bool whole);
  void take_prescribed(std::span<const double> prescribed, std::span<double> x) const;
  TangentReport descend(std::span<double> x);
  TangentReport descend_by_kept_factor(std::span<double> x);
  TangentReport descend_by_factor(std::span<double> x);
  std::optional<TangentReport> solve_unsymmetric(std::span<double> x);

  LinearSettings settings_;
  const DofFilter& filter_;
  TangentOperator K_;
  FactorSolver factor_;
  CgSolver cg_;
  KeptFactor kept_factor_;
  std::unique_ptr<LinearSolver> own_;
  std::optional<bool> direct_;
  bool inertia_ = false;
  std::optional<bool> kept_by_cost_;  ///< a factor took the place of blocks, to be kept; false: it disappointed
  bool keeps_ = false;                ///< as keep_factors() was told
  bool factor_is_current_ = false;    ///< the last solve made its factor
  double left_ = 0;                   ///< as aim_at() was told
  double of_gradient_ = 1;            ///< the gradient over the right-hand side, where a boundary moves
  std::vector<double> rhs_, product_;
};

}  // namespace fascia
