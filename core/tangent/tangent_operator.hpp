#pragma once

#include "core/executor/executor.hpp"
#include "core/levels/multigrid.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/linear/vectors.hpp"
#include "core/node/dof_filter.hpp"
#include "core/step/dependents.hpp"
#include "core/tangent/condensation.hpp"
#include "core/tangent/low_rank.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace fascia {

/// Tangents that are positive definite where the full one is not: without the pull of tethers on turning frames, and
/// without all that stress does.
enum class TamerTangent { without_tethers, material };
using Relinearize = std::function<const Linearization&(TamerTangent)>;

/// The tangent of a model at a state, as linear solvers see it: a symmetric part K, and what loads without a potential
/// add to it. Vectors are in constraint axes, one number for each degree of freedom; what depends on other nodes is
/// condensed onto these. The matrix is assembled when it is first asked for. Products before that go from block to
/// block of the model, of which up to some tens take less time than assembling; it is assembled after as many.
class TangentOperator {
 public:
  TangentOperator(const Model& model, CpuExecutor& executor, const DofFilter& filter);
  TangentOperator(const TangentOperator&) = delete;
  TangentOperator& operator=(const TangentOperator&) = delete;

  /// @param at     is held by the caller for as long as this is asked about it
  /// @param tamer  gives tamer tangents at the same state, as long; null: there are none
  void take(const Linearization& at, const Relinearize* tamer = nullptr);
  /// Puts a tamer tangent in the place of K; the whole tangent stays what it is.
  void tame(TamerTangent kind);
  bool tamed() const { return tamed_; }
  bool has_tamer() const { return tamer_ != nullptr; }
  /// The tamer goes, or the tangent goes too: nothing is asked of it from here on.
  void forget_tamer() { tamer_ = nullptr; }
  void forget() {
    tamer_ = nullptr;
    at_ = nullptr;
  }
  bool symmetric() const { return at_->loads.symmetric(); }

  const Model& model() const { return model_; }
  const DofFilter& filter() const { return filter_; }
  const CpuVectors& vectors() const { return vectors_; }
  ThreadPool& pool() const { return executor_.pool(); }
  int free_count() const { return filter_.free_count(); }

  /// y = K x, of held degrees of freedom too; returns x · y.
  double apply(std::span<const double> x, std::span<double> y);
  /// y = K x on the free degrees of freedom; the others become 0. Returns x · y, of an x that is 0 where it is held.
  double apply_free(std::span<const double> x, std::span<double> y) {
    const double product = apply(x, y);
    filter_.clear_fixed(y);
    return product;
  }
  /// Makes x = z + s x first, then does so. @param rounded  with the entries of matrix() rounded to 32 bits
  double apply_free_next(std::span<const double> z, double s, std::span<double> x, std::span<double> y, bool rounded);
  /// y = K x on the free degrees of freedom with matrix() or material_part() alone, rounded to 32 bits.
  void apply_free_rounded(bool material, std::span<const double> x, std::span<double> y);
  /// y = K x with all that the tangent has, of held degrees of freedom too.
  void apply_whole(std::span<const double> x, std::span<double> y);

  /// K without the terms beside it, in the axes of the world.
  const BlockMatrix& matrix();
  /// Where it is stored; its values may be any.
  BlockMatrix& pattern();
  /// Changes with the pattern: what was made of another one is to be made anew.
  long pattern_revision() const { return pattern_; }
  /// Terms of K that no matrix holds.
  LowRank& beside() { return beside_; }
  const LowRank& beside() const { return beside_; }
  /// The part of K that is definite whatever the stress. A tamer tangent must be there.
  const BlockMatrix& material_part(Entries entries = Entries::all);
  /// Inverts the free part of each node's diagonal block, with pivots kept positive; 1 where it is held.
  /// @param whole  false: the diagonal alone
  void invert_diagonal(const BlockMatrix& matrix, bool whole, std::vector<double>& out) const;
  /// K resists rigid motions of parts least: where the nodes are, and how they are turned.
  Multigrid::Places places() const;
  /// motion_lengths(): what a unit of each degree of freedom moves [m].
  std::span<const double> lengths();

 private:
  void assemble(const Linearization& at, BlockMatrix& out, Entries entries);
  const BlockMatrix& rounded_matrix(bool material);
  void apply_by_blocks(std::span<const double> x, std::span<double> y, bool whole);
  template <class Multiply>
  double apply_in_world(const Multiply& multiply, std::span<const double> x, std::span<double> y);
  double add_beside(double product, std::span<const double> x, std::span<double> y) const;

  const Model& model_;
  CpuExecutor& executor_;
  const DofFilter& filter_;
  CpuVectors vectors_;
  NodesView nodes_;
  Dependents<PoolSpace> dependents_;
  Condensation condensation_;
  const Linearization* at_ = nullptr;
  const Relinearize* tamer_ = nullptr;
  std::optional<BlockMatrix> matrix_, material_;
  int by_blocks_ = 0;  ///< products without the matrix
  bool assembled_ = false, rounded_ = false, material_rounded_ = false, tamed_ = false;
  long pattern_ = 0;  ///< CpuExecutor::pattern() of the matrices
  LowRank beside_;
  std::vector<double> work_, lengths_;
};

}  // namespace fascia
