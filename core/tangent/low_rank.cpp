#include "core/tangent/low_rank.hpp"

#include <algorithm>

namespace fascia {

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void LowRank::set(const std::vector<RankOne>& terms, const DofFilter& filter) {
  filter_ = &filter;
  terms_ = terms;
  z_.resize(terms.size());
  scale_.resize(terms.size());
  for (RankOne& term : terms_) filter.to_local(term.g);
}

int LowRank::lifted() const {
  return static_cast<int>(std::count_if(scale_.begin(), scale_.end(), [](double s) { return s < 0; }));
}

void LowRank::add_product(std::span<const double> x, std::span<double> y) const {
  for (const RankOne& term : terms_) fascia::add_product(term, x, y);
}

void LowRank::prepare(const Solve& solve) {
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

void LowRank::correct(std::span<const double> b, std::span<double> x) const {
  for (std::size_t r = 0; r < terms_.size(); ++r) add(x, r, -scale_[r] * dot(z_[r], b));
}

void LowRank::add(std::span<double> to, std::size_t term, double factor) const {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * z_[term][i];
}

}  // namespace fascia
