#pragma once

#include "core/tangent/factor_solver.hpp"
#include "core/tangent/linear_settings.hpp"
#include "core/tangent/tangent_operator.hpp"

#include <cmath>
#include <limits>
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
  /// Makes x += s p and r −= s q first, then does so.
  virtual double advance(const CpuVectors& vectors, double s, std::span<const double> p, std::span<const double> q,
                         std::span<double> x, std::span<double> r, std::span<double> z) {
    vectors.advance(s, p, q, x, r);
    return apply(r, z);
  }
  /// A solve begins.
  virtual void begin() {}
  /// A solve took so many iterations. @return  false where it must be made again for the next one
  virtual bool took(int /*iterations*/) { return true; }
  /// A sentence on what prepare() found.
  virtual std::string trouble() const { return "the tangent is not positive definite: it has no such preconditioner"; }
};

/// None for kinds that are more than one: automatic, multigrid.
std::unique_ptr<Preconditioner> preconditioner_of(PreconditionerKind kind, TangentOperator& K, FactorSolver& factor);

/// Looks at the products r · M⁻¹ r of a solve: a definite M gives none below zero. Where nothing but rounding is left
/// the sign says nothing.
class DefiniteProducts {
 public:
  void begin() { start_ = 0; }
  /// @param left  left(): r is not zero
  /// @return      rz; what is not a number where M is indefinite
  template <class Left>
  double take(double rz, const Left& left) {
    const bool first = start_ == 0;
    if (first) start_ = std::abs(rz);
    const bool indefinite = first ? rz < 0 || (rz == 0 && left()) : rz < -kCycleRounding * start_;
    return indefinite ? std::numeric_limits<double>::quiet_NaN() : rz;
  }

 private:
  double start_ = 0;  ///< |r · z| where the solve began; 0: nowhere yet
};

class NoPreconditioner final : public Preconditioner {
 public:
  explicit NoPreconditioner(const TangentOperator& K) : K_(K) {}
  bool prepare() override { return true; }
  double apply(std::span<const double> r, std::span<double> z) override;
  double advance(const CpuVectors& vectors, double s, std::span<const double> p, std::span<const double> q,
                 std::span<double> x, std::span<double> r, std::span<double> z) override;

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
  double advance(const CpuVectors& vectors, double s, std::span<const double> p, std::span<const double> q,
                 std::span<double> x, std::span<double> r, std::span<double> z) override;

 private:
  template <class Before>
  double apply_after(const Before& before, std::span<const double> r, std::span<double> z);

  TangentOperator& K_;
  bool whole_;
  std::vector<double> inverse_, chunk_sums_;
};

/// A factor of a tangent met before, with the terms beside K as they are now, kept while few iterations are needed with
/// it.
class OldFactor final : public Preconditioner {
 public:
  /// A factor that leaves more iterations is out of date.
  static constexpr int kMostIterations = 15;

  OldFactor(TangentOperator& K, FactorSolver& factor) : K_(K), factor_(factor) {}
  bool prepare() override;
  double apply(std::span<const double> r, std::span<double> z) override;
  void begin() override { products_.begin(); }
  bool took(int iterations) override;
  /// One is at hand, so that prepare() makes none.
  bool is_kept() { return ready_ && factor_.preconditions(); }
  /// The factor was made of K as it is now.
  void renewed();
  void forget() { ready_ = false; }
  std::string trouble() const override { return "the tangent is not positive definite: no Cholesky preconditioner"; }

 private:
  TangentOperator& K_;
  FactorSolver& factor_;
  DefiniteProducts products_;
  bool ready_ = false;
  bool exact_ = true;         ///< of K itself: no more than rounding is left; what an old one leaves hides 32 bits
  int first_ = 0, more_ = 0;  ///< iterations of the first solve after it was made; those of later ones beyond as many
};

/// A cycle over levels of rigid frames, of quadratic elements with one of their corners, of K or of its material part.
class LevelsOfFrames final : public Preconditioner {
 public:
  /// @param material  of the part that is definite whatever the stress
  LevelsOfFrames(TangentOperator& K, bool material) : K_(K), material_(material) {}
  bool prepare() override;
  double apply(std::span<const double> r, std::span<double> z) override;
  void begin() override { products_.begin(); }
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
  DefiniteProducts products_;
};

}  // namespace fascia
