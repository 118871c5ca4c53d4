#pragma once

#include "core/executor/executor.hpp"
#include "core/levels/blocks_or_levels.hpp"
#include "core/levels/kept_levels.hpp"
#include "core/levels/multigrid.hpp"
#include "core/linear/cholesky.hpp"
#include "core/linear/vectors.hpp"
#include "core/node/dof_filter.hpp"
#include "core/solver/dependents.hpp"
#include "core/solver/low_rank.hpp"
#include "core/solver/settings.hpp"
#include "core/solver/stability.hpp"
#include "core/solver/tangent_condition.hpp"

#include <functional>
#include <optional>
#include <string>

namespace fascia {

struct TangentReport {
  bool usable = true;
  int iterations = 0;
  std::string trouble;
  bool indefinite = false;  ///< as in DirectionReport
  bool unsolved = false;    ///< CG ended at its limit of iterations
  double residual = 0;      ///< |r| / |b| that CG left; 0 of a direct solve, whose rest is rounding
  double cg_seconds = 0;    ///< in conjugate gradients
};

/// Which solver was taken last, and the counts that speak for it.
struct SolverChoice {
  bool direct = false;
  Preconditioner preconditioner = Preconditioner::automatic;  ///< of CG; automatic: blocks
  double flops = 0, numbers = 0;                              ///< of a factor; 0: nobody asked
  double flops_per_number = 0;                                ///< of the matrix
  std::vector<int> levels;                                    ///< nodes of each, the finest first
};

/// Tangents that are positive definite where the full one is not: without the pull of tethers on turning frames, and
/// without all that stress does.
enum class TamerTangent { without_tethers, material };
using Relinearize = std::function<const Linearization&(TamerTangent)>;

/// Solves K x = b on the free degrees of freedom, directly or by CG, and finds a descent direction where K is not
/// positive definite. Vectors are in constraint axes; of dependent nodes their entries are zero.
class TangentSolver {
 public:
  /// Up to here a factorisation takes a few seconds at most, whatever the conditioning; CG may be 2 to 3 times faster
  /// on a bulky compressible body, and far slower on a slender or nearly incompressible one (docs/manual.md).
  static constexpr int kDirectDofs = 15000;
  /// From so many operations of a factor for each number of the matrix on, CG is taken beyond those unknowns: those of
  /// the iterations that a bulky body needs with blocks, or of 40 cycles with their levels, where a factor's operations
  /// run four times as fast as those of products, which wait for memory.
  static constexpr double kFlopsPerNumber = 2000;

  TangentSolver(const Model& model, CpuExecutor& executor, const DofFilter& filter, const SolverSettings& settings);

  /// @param relinearize  gives a tamer tangent at the same state; called only where the full one fails
  TangentReport solve(const Linearization& at, std::span<const double> prescribed, std::span<const double> b,
                      std::span<double> x, const Relinearize& relinearize);

  /// Factorises K as it is, indefinite or not, and counts the directions in which the equilibrium is unstable. None
  /// where a pivot vanishes. (path_system.cpp)
  std::optional<int> factorize_as_is(const Linearization& at);
  /// Solves with that factor and the same tangent. False where rounding spoils the solution: K is all but singular.
  bool solve_as_is(const Linearization& at, std::span<const double> prescribed, std::span<const double> b,
                   std::span<double> x);

  /// The softest direction of a tangent, and how many negative ones it has: from a factor where one is at hand or cheap
  /// beside the iterations that CG has made, else by CG. (tangent_stability.cpp)
  /// @param made     iterations of CG in the run so far
  /// @param current  `at` is that of the last solve, but for a correction too small to matter
  SoftestDirection softest(const Linearization& at, long made, bool current);

  /// Looks at a tangent that is symmetric and positive definite: eigenvalues by Lanczos iterations, to about a percent.
  /// @param most_flops  a factor that takes more operations is left out (tangent_condition.cpp)
  TangentCondition condition(const Linearization& at, double most_flops);

  /// Levels of rigid frames of a tangent, for solves elsewhere; null where one of them is not positive definite.
  /// @param material  the tangent is without all that stress does (tangent_multigrid.cpp)
  const Multigrid* levels(const Linearization& at, bool material);

  /// Cholesky is used, and not CG.
  bool direct();
  SolverChoice choice() const;
  BlockMatrix& matrix();
  /// Of a factor of the matrix, which need not be made for it.
  const EliminationOrder& order();
  BlockCholesky& factor();
  /// A factor takes less than a tenth of the time of CG so far: its operations run several times faster than those of
  /// products, which wait for memory. (tangent_stability.cpp)
  bool factor_is_cheap(long made);
  /// A factor that fits into memory takes over where CG, which was only a guess, needs so many iterations for a solve
  /// (a slender body).
  bool gives_way_to_factor(long iterations);

 private:
  bool factor_fits();
  static constexpr double kMostFactorBytes = 2e9;
  /// Of GMRES beside a factor, where another digit costs a product or two.
  static constexpr double kDirectTolerance = 1e-10;
  void assemble(const Linearization& at, BlockMatrix& matrix, Entries entries = Entries::all);
  void take_prescribed(std::span<const double> prescribed, std::span<double> x) const;
  bool cg_is_too_slow(const TangentReport& report);
  bool factorize(const Relinearize& relinearize, TangentReport& report);
  bool definite_with_low_rank();
  bool shift_until_definite(const Relinearize& relinearize);
  std::optional<int> factorize_any();
  void finish_shifted(std::span<double> x);
  TangentReport solve_cg(std::span<const double> b, std::span<double> x, const CgOptions& options);
  TangentReport solve_cg(std::span<const double> b, std::span<double> x) { return solve_cg(b, x, settings_.cg); }
  void build_block_jacobi(const BlockMatrix& matrix);
  void apply_matrix(std::span<const double> local, std::span<double> out);
  void apply_blocks(const BlockMatrix& matrix, std::span<const double> local, std::span<double> out);
  // tangent_multigrid.cpp
  void note_places(const Linearization& at);
  bool build_multigrid(bool material);
  bool build_levels(bool material);
  CgReport solve_with_levels(Multigrid& levels, const CpuVectors::Vector& b, CpuVectors::Vector& x,
                             const CgOptions& options);
  CgReport solve_by_multigrid(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options);
  bool levels_are_taken() const { return blocks_or_levels_.levels() && !kept_levels_.fail(); }
  CgReport solve_by_blocks(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options);
  CgReport solve_by_factor(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options);
  CgReport solve_by_either(const CpuVectors::Vector& b, CpuVectors::Vector& x, const CgOptions& options);
  /// @param precondition  precondition(r, z) returns r · z
  template <class Precondition>
  CgReport solve_cg_with(const Precondition& precondition, const CpuVectors::Vector& b, CpuVectors::Vector& x,
                         const CgOptions& options) {
    const auto apply = [this](const CpuVectors::Vector& p, CpuVectors::Vector& Ap) {
      apply_matrix(p, Ap);
      filter_.clear_fixed(Ap);
    };
    return conjugate_gradients(vectors_, apply, precondition, b, x, options);
  }
  // tangent_unsymmetric.cpp
  void apply_unsymmetric(const Linearization& at, std::span<const double> x, std::span<double> Ax);
  bool factorize_symmetric_part();
  bool solve_whole(const Linearization& at, std::span<const double> b, std::span<double> x, double tolerance,
                   TangentReport* report);
  std::optional<TangentReport> solve_unsymmetric(const Linearization& at, std::span<const double> prescribed,
                                                 std::span<const double> b, std::span<double> x,
                                                 const Relinearize& relinearize);
  SoftestDirection softest_unsymmetric(const Linearization& at, bool definite);
  void solve_with_factor(std::span<const double> b, std::span<double> x);

  const Model& model_;
  CpuExecutor& executor_;
  const DofFilter& filter_;
  SolverSettings settings_;
  CpuVectors vectors_;
  DependentNodes dependents_;
  std::optional<BlockMatrix> matrix_, material_matrix_;
  std::optional<EliminationOrder> order_;
  std::optional<BlockCholesky> cholesky_, indefinite_;
  BlockCholesky* as_is_ = nullptr;    ///< what factorize_as_is() left
  int unstable_ = 0;                  ///< negative pivots that it met last
  BlockCholesky* solving_ = nullptr;  ///< factor of the last direct solve
  bool definite_ = false;             ///< of K itself, without shift
  std::optional<bool> direct_;
  LowRank low_rank_;
  bool factor_is_preconditioner_ = false;
  BlocksOrLevels blocks_or_levels_{{}};  ///< of an automatic preconditioner
  double shift_ = 0;                     ///< of the last factorisation that needed one
  bool shifted_ = false;                 ///< the last factor is such
  std::optional<Multigrid> multigrid_, material_multigrid_;
  KeptLevels kept_levels_;
  Multigrid::Places places_;                  ///< of the tangent that was assembled last
  const Relinearize* relinearize_ = nullptr;  ///< within solve()
  std::vector<double> inverse_blocks_, work_, rhs_, solution_, chunk_sums_;
  std::vector<double> length_;  ///< what a degree of freedom moves: 1, or its part's length [m]; 0 where it is fixed
};

}  // namespace fascia
