#pragma once

#include "core/executor/executor.hpp"
#include "core/node/dof_filter.hpp"

#include <algorithm>
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
  int lifted() const {
    return static_cast<int>(std::count_if(scale_.begin(), scale_.end(), [](double s) { return s < 0; }));
  }

  /// y += Σ k g (g · x), on all degrees of freedom.
  void add_product(std::span<const double> x, std::span<double> y) const {
    for (const RankOne& term : terms_) fascia::add_product(term, x, y);
  }

  /// Makes ready for correct(). @param solve  solve(b, x): x = K⁻¹ b on the free degrees of freedom
  template <class Solve>
  void prepare(const Solve& solve) {
    for (std::size_t r = 0; r < terms_.size(); ++r) {
      free_ = terms_[r].g;
      filter_->clear_fixed(free_);
      std::vector<double>& z = z_[r];
      z.resize(free_.size());
      solve(free_, z);
      for (std::size_t s = 0; s < r; ++s) add(z, s, -scale_[s] * dot(z_[s], free_));
      scale_[r] = 1 / (1 / terms_[r].stiffness + dot(free_, z));
    }
  }

  /// Turns x = K⁻¹ b into the solution with all terms. Prescribed entries of b and x are zero.
  void correct(std::span<const double> b, std::span<double> x) const {
    for (std::size_t r = 0; r < terms_.size(); ++r) add(x, r, -scale_[r] * dot(z_[r], b));
  }

 private:
  static double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }
  void add(std::span<double> to, std::size_t term, double factor) const {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * z_[term][i];
  }

  const DofFilter* filter_ = nullptr;
  std::vector<RankOne> terms_;
  std::vector<std::vector<double>> z_;
  std::vector<double> scale_, free_;
};

inline void LowRank::set(const std::vector<RankOne>& terms, const DofFilter& filter) {
  filter_ = &filter;
  terms_ = terms;
  z_.resize(terms.size());
  scale_.resize(terms.size());
  for (RankOne& term : terms_) filter.to_local(term.g);
}

}  // namespace fascia
