#include "app/compare/local_fit.hpp"

#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr std::size_t kOfDegree[3] = {1, 12, 32};  ///< neighbours of a fit by its degree
constexpr Eigen::Index kTerms[3] = {1, 4, 10};
constexpr double kMostMagnitude = 3;  ///< of the shares: what errors of the values may grow by
/// Places in a plane leave 1e-16 of rounding across it, a layer of matter has at least this part of the neighbours'
/// spread.
constexpr double kRank = 1e-8;

using Neighbours = std::vector<std::pair<double, int>>;

double spacing_of(const std::vector<Vec3d>& places, double diagonal) {
  return diagonal > 0 ? diagonal / std::cbrt(static_cast<double>(places.size())) : 1;
}

/// Shares of the value that a fit of this degree gives at X: the first row of its pseudo-inverse. Empty where the
/// neighbours do not determine it, or only by differences.
std::vector<LocalFit::Share> fit(const std::vector<Vec3d>& places, const Neighbours& near, const Vec3d& X, int degree) {
  const auto count = static_cast<Eigen::Index>(near.size());
  const double reach = std::sqrt(near.back().first);
  Eigen::MatrixXd terms(kTerms[degree], count);  // of the neighbours, each in a column, weighted
  Eigen::VectorXd root(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [squared, place] = near[static_cast<std::size_t>(i)];
    const Vec3d d = (places[at(place)] - X) * (1 / reach);
    root[i] = reach / std::sqrt(squared);
    auto column = terms.col(i);
    column.head(4) << 1, d[0], d[1], d[2];
    if (degree == 2) column.tail(6) << d[0] * d[0], d[1] * d[1], d[2] * d[2], d[0] * d[1], d[1] * d[2], d[2] * d[0];
    column *= root[i];
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  factors.setThreshold(kRank);
  factors.compute(terms);
  const Eigen::VectorXd weights = factors.solve(Eigen::VectorXd::Unit(kTerms[degree], 0)).cwiseProduct(root);
  if (!(std::abs(weights.sum() - 1) < 1e-6) || weights.lpNorm<1>() > kMostMagnitude) return {};
  std::vector<LocalFit::Share> shares;
  for (Eigen::Index i = 0; i < count; ++i) shares.emplace_back(near[static_cast<std::size_t>(i)].second, weights[i]);
  return shares;
}

}  // namespace

LocalFit::LocalFit(std::vector<Vec3d> places)
    : places_(std::move(places)),
      diagonal_(bounds_of(places_).diagonal()),
      spacing_(spacing_of(places_, diagonal_)),
      grid_(spacing_) {
  for (const Vec3d& place : places_) grid_.insert(place);
}

std::vector<std::pair<double, int>> LocalFit::nearest(const Vec3d& X, std::size_t count, int except) const {
  const std::size_t wanted = std::min(count, places_.size() - (except >= 0 ? 1 : 0));
  Neighbours found;
  for (double radius = 2 * spacing_;; radius *= 1.5) {
    found.clear();
    grid_.visit_within(X, radius, [&](int i) {
      if (i != except) found.emplace_back(squared_norm(places_[at(i)] - X), i);
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (found.size() >= wanted) break;
  }
  if (wanted == 0) return {};
  const double last = found[wanted - 1].first * (1 + kTie);
  found.erase(std::find_if(found.begin(), found.end(), [&](const auto& f) { return f.first > last; }), found.end());
  return found;
}

std::vector<LocalFit::Share> LocalFit::shares_at(const Vec3d& X, int except) const {
  const Neighbours near = nearest(X, kOfDegree[2], except);
  if (near.empty()) return {{std::max(0, except), 1.0}};  // one place alone
  const double close = 1e-9 * spacing_;
  for (int degree = near.front().first <= close * close ? 0 : 2; degree > 0; --degree) {
    const Neighbours some(
        near.begin(),
        near.begin() +
            std::min(std::ssize(near), degree == 2 ? std::ssize(near) : static_cast<std::ptrdiff_t>(kOfDegree[1])));
    if (auto shares = fit(places_, some, X, degree); !shares.empty()) return shares;
  }
  return {{near.front().second, 1.0}};
}

}  // namespace fascia::app
