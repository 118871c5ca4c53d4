#pragma once

#include "core/linear/rank_one.hpp"
#include "core/node/dof_filter.hpp"

#include <functional>
#include <span>
#include <vector>

namespace fascia {

/// The terms Σ k g gᵀ beside the matrix of a tangent, in constraint axes: added to products, and to solutions by
/// Sherman and Morrison's formula, one term after the other:
///
///   x ← x − z (z · b) / (1/k + g · z),   z = K⁻¹ g with the terms before.
class LowRank {
 public:
  void set(const std::vector<RankOne>& terms, const DofFilter& filter);
  bool empty() const { return terms_.empty(); }
  /// Negative eigenvalues of K that the terms lift, as prepare() found: each denominator below 0 is one.
  int lifted() const;

  /// y += Σ k g (g · x), on all degrees of freedom.
  void add_product(std::span<const double> x, std::span<double> y) const;

  /// x = K⁻¹ b on the free degrees of freedom.
  using Solve = std::function<void(std::span<const double> b, std::span<double> x)>;
  /// Makes ready for correct().
  void prepare(const Solve& solve);

  /// Turns x = K⁻¹ b into the solution with all terms. Prescribed entries of b and x are zero.
  void correct(std::span<const double> b, std::span<double> x) const;

 private:
  void add(std::span<double> to, std::size_t term, double factor) const;

  const DofFilter* filter_ = nullptr;
  std::vector<RankOne> terms_;
  std::vector<std::vector<double>> z_;
  std::vector<double> scale_, free_;
};

}  // namespace fascia
