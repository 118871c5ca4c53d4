#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace fascia::app {

/// A value at a size h of cells, spacing or steps.
struct Level {
  double h = 0;
  std::vector<double> value;
};

/// Limit of a value as h goes to 0.
struct Limit {
  std::vector<double> value;
  double uncertainty = 0;       ///< of the limit, in the norm of the value
  std::optional<double> order;  ///< p of the error c h^p; none where the levels do not show one
};

/// Observed order of three levels of decreasing h, from |v1 − v2| / |v2 − v3| = (h1^p − h2^p) / (h2^p − h3^p); none
/// where the differences do not decrease, point apart, or p lies outside of 0.3 to 8.
std::optional<double> observed_order(const Level& first, const Level& second, const Level& third);

/// Richardson's extrapolation of the three finest levels: v = v3 + (v3 − v2) h3^p / (h2^p − h3^p). The uncertainty is
/// 1.25 times what was added (Roache's grid convergence index for three levels); where no order is observed the value
/// is the finest one, and the uncertainty 3 times the last difference.
/// @param levels  in any order; h > 0, equal lengths
/// @return none for fewer than two levels
std::optional<Limit> limit_of(std::vector<Level> levels);

/// Slope of log(error) over log(h) by least squares; none for fewer than two errors above 0.
std::optional<double> fitted_order(std::span<const double> h, std::span<const double> error);

/// Euclidean norm, and that of a difference.
double norm_of(std::span<const double> v);
double distance(std::span<const double> a, std::span<const double> b);

}  // namespace fascia::app
