#pragma once

#include "core/math/vec3.hpp"
#include "meshless/scattered/point_grid.hpp"

#include <utility>
#include <vector>

namespace fascia::app {

/// Interpolates values that are known at scattered places.
///
/// Around X a polynomial p of degree 2 is fitted to the 32 nearest places, weighted with 1 / distance²; p(X) is the
/// value there. It meets the values at the places themselves, and every polynomial of degree 2 exactly. In places of a
/// plane or a line the polynomial is one of their coordinates. Where a fit would rely on differences (the weights' sum
/// of magnitudes is above 3) one of degree 1 takes its place, and then the nearest value.
class LocalFit {
 public:
  /// A place by its number, and its part of the value. The parts add up to 1.
  using Share = std::pair<int, double>;

  /// @pre at least one place
  explicit LocalFit(std::vector<Vec3d> places);

  /// @param except  a place that takes no part; −1: none
  std::vector<Share> shares_at(const Vec3d& X, int except = -1) const;
  const std::vector<Vec3d>& places() const { return places_; }

 private:
  /// The nearest `count` places and those as far as the last of them, nearest first, with their squared distances.
  std::vector<std::pair<double, int>> nearest(const Vec3d& X, std::size_t count, int except) const;

  std::vector<Vec3d> places_;
  double diagonal_, spacing_;  ///< of all places; about between two of them [m]
  PointGrid grid_;
};

}  // namespace fascia::app
