#pragma once

#include "core/levels/blocks_or_levels.hpp"
#include "core/levels/kept_levels.hpp"
#include "core/linear/cg.hpp"
#include "core/tangent/linear_settings.hpp"
#include "core/tangent/linear_solver.hpp"
#include "core/tangent/preconditioners.hpp"

#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace fascia {

/// A limit of iterations below this is a budget that the user set, and not too small a guess of ours.
inline constexpr int kEnoughForBulk = 1000;

/// Solves by preconditioned conjugate gradients.
///
/// Where the preconditioner is left open, blocks precondition; levels of rigid frames do from the first solve on that
/// ends at its limit of iterations, where the limit is not a budget that the user set. Where the program chose
/// conjugate gradients itself, they do as soon as they are likely to be cheaper, and hand back where they are not; or a
/// factor takes over, where that is cheaper than either.
///
/// Where the precision is mixed, products take the entries of K rounded to 32 bits. Rounding can make a K indefinite
/// that is not: a solve that finds it so is made again in 64 bits, and where these find K definite, they stay.
class CgSolver final : public LinearSolver {
 public:
  /// @param K       belongs to the caller, as does factor
  /// @param factor  of K, for the preconditioner that asks for one
  CgSolver(TangentOperator& K, const LinearSettings& settings, FactorSolver& factor);

  /// Preconditioners are made where a solve asks for them. But for a factor those that are kept take products with K
  /// all the same, before the first iteration does: its matrix is assembled here.
  bool prepare() override {
    if (pattern_ != K_.pattern_revision()) begin_afresh();
    one_is_ready_ = false;
    if (settings_.preconditioner != PreconditionerKind::cholesky) K_.matrix();
    return true;
  }
  LinearReport solve(std::span<const double> b, std::span<double> x, double rough = 0) override;
  LinearReport solve(std::span<const double> b, std::span<double> x, const CgOptions& asked);
  /// Solves with a preconditioner of the caller's, which is ready, as far as `asked` says alone.
  LinearReport solve_by(Preconditioner& M, std::span<const double> b, std::span<double> x, const CgOptions& asked);
  bool iterates() const override { return true; }
  /// Sets a limit to the iterations of all solves to come, beside that of the settings for each: that of the time which
  /// a step has. What a solve does not reach because of it says nothing of preconditioners.
  void limit_iterations(int most) {
    left_ = most;
    limited_ = most < settings_.cg.max_iterations;
  }
  /// Solves to come go on to this tolerance, where it is less than that of the settings, as far as their limit of
  /// iterations lets them; 0: to that of the settings. Where products are rounded they do not.
  void aim_at(double tolerance) { aim_ = tolerance; }
  /// Products have 64 bits, whatever the precision, and no factor takes over: for what is asked of this solver itself.
  void take_exact_products(bool exact) { exact_ = exact; }
  bool spent() const override { return limited_ && left_ <= 0; }
  /// A factor is the cheaper solver from here on: the last solve may have ended without a solution. Only where the
  /// program chose the solver.
  bool hands_over() const { return hands_over_; }
  /// Makes preconditioners anew and counts iterations afresh.
  void begin_afresh();

  /// That was taken last; automatic: blocks.
  PreconditionerKind preconditioner() const {
    return levels_are_taken() ? PreconditionerKind::multigrid : settings_.preconditioner;
  }
  /// Levels of K or of its material part, the last that were made; null where there were none.
  const Multigrid* levels(bool material = false) const { return (material ? material_ : levels_).levels(); }
  /// Makes them. False where one of them is not positive definite.
  bool make_levels(bool material) { return (material ? material_ : levels_).prepare(); }
  /// Levels made from now on are of frames alone, as those that run elsewhere take them.
  void take_frames_alone() {
    const bool either = levels_.take_frames_alone(), other = material_.take_frames_alone();
    if (either || other) kept_levels_ = {};
  }

 private:
  using Vector = CpuVectors::Vector;
  bool levels_are_taken() const { return blocks_or_levels_.levels() && !kept_levels_.fail(); }
  CgReport solve_with(Preconditioner& M, const Vector& b, Vector& x, const CgOptions& options);
  CgReport iterate(Preconditioner& M, const Vector& b, Vector& x, const CgOptions& options, bool rounded);
  CgReport solve_as_asked(const Vector& b, Vector& x, const CgOptions& options);
  CgReport solve_by_one(const Vector& b, Vector& x, const CgOptions& options);
  CgReport solve_by_levels(const Vector& b, Vector& x, const CgOptions& options);
  CgReport solve_by_either(const Vector& b, Vector& x, const CgOptions& options);

  LinearReport report_of(const CgReport& cg, std::span<double> x) const;
  void choose_one();
  void renew_one();
  bool factor_takes_less(double iterations);

  TangentOperator& K_;
  CgVectors<Vector> work_;
  Vector b_, found_;  ///< the right-hand side, and what a solve found; empty: nothing
  LinearSettings settings_;
  FactorSolver& factor_;
  bool limited_ = false, exact_ = false, hands_over_ = false;
  int left_ = 0;                         ///< iterations, where they are limited
  double aim_ = 0;                       ///< as aim_at() was told
  long pattern_ = 0;                     ///< of K, that preconditioners were made of
  std::unique_ptr<Preconditioner> one_;  ///< that is asked for, or blocks
  bool one_is_ready_ = false;            ///< for K as it is
  bool rounds_ = false;                  ///< products are of 32 bits
  LevelsOfFrames levels_, material_;
  KeptLevels kept_levels_;
  BlocksOrLevels blocks_or_levels_{{}};  ///< of an automatic preconditioner
};

}  // namespace fascia
