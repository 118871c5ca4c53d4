#pragma once

#include "core/tangent/factor_solver.hpp"
#include "core/tangent/linear_settings.hpp"
#include "core/tangent/tangent_operator.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Preconditioners of conjugate gradients. Another one is a class that derives from Preconditioner, its kind, and its
/// place in preconditioner_of().
namespace fascia {

/// M⁻¹ ≈ K⁻¹ of a tangent, symmetric and positive definite.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// Made for K as it is now. @return  false where it cannot be: K is not positive definite
  virtual bool prepare() = 0;
  /// z = M⁻¹ r; returns r · z. Where it turns out to be indefinite, with which conjugate gradients mean nothing, it
  /// returns what is not a number.
  virtual double apply(std::span<const double> r, std::span<double> z) = 0;
  /// A solve begins.
  virtual void begin() {}
  /// A solve took so many iterations. @return  false where it must be made again for the next one
  virtual bool took(int /*iterations*/) { return true; }
  /// A sentence on what prepare() found.
  virtual std::string trouble() const { return "the tangent is not positive definite: it has no such preconditioner"; }
};

/// None for kinds that are more than one: automatic, multigrid.
std::unique_ptr<Preconditioner> preconditioner_of(PreconditionerKind kind, TangentOperator& K, FactorSolver& factor);

class NoPreconditioner final : public Preconditioner {
 public:
  explicit NoPreconditioner(const TangentOperator& K) : K_(K) {}
  bool prepare() override { return true; }
  double apply(std::span<const double> r, std::span<double> z) override;

 private:
  const TangentOperator& K_;
};

/// The inverse of the diagonal's block of each node, or of the diagonal.
class DiagonalBlocks final : public Preconditioner {
 public:
  /// @param whole  false: of the diagonal alone
  DiagonalBlocks(TangentOperator& K, bool whole) : K_(K), whole_(whole) {}
  bool prepare() override;
  double apply(std::span<const double> r, std::span<double> z) override;

 private:
  TangentOperator& K_;
  bool whole_;
  std::vector<double> inverse_, chunk_sums_;
};

/// A factor of a tangent met before, kept while few iterations are needed with it.
class OldFactor final : public Preconditioner {
 public:
  OldFactor(TangentOperator& K, FactorSolver& factor) : K_(K), factor_(factor) {}
  bool prepare() override;
  double apply(std::span<const double> r, std::span<double> z) override;
  bool took(int iterations) override;
  std::string trouble() const override { return "the tangent is not positive definite: no Cholesky preconditioner"; }

 private:
  TangentOperator& K_;
  FactorSolver& factor_;
  bool ready_ = false;
};

/// A cycle over levels of rigid frames, of quadratic elements with one of their corners, of K or of its material part.
class LevelsOfFrames final : public Preconditioner {
 public:
  /// @param material  of the part that is definite whatever the stress
  LevelsOfFrames(TangentOperator& K, bool material) : K_(K), material_(material) {}
  bool prepare() override;
  double apply(std::span<const double> r, std::span<double> z) override;
  void begin() override { start_ = 0; }
  void forget() { levels_.reset(); }
  /// Those made from now on have no level of corners.
  /// @return  they had
  bool take_frames_alone() {
    if (corners_) levels_.reset();
    return std::exchange(corners_, false);
  }
  /// Null where they were never made.
  const Multigrid* levels() const { return levels_ ? &*levels_ : nullptr; }

 private:
  TangentOperator& K_;
  bool material_, corners_ = true;
  std::optional<Multigrid> levels_;
  std::vector<double> inverse_;
  double start_ = 0;  ///< |r · z| where the solve began; 0: nowhere yet
};

}  // namespace fascia
