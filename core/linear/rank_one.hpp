#pragma once

#include <span>
#include <vector>

namespace fascia {

/// stiffness · g gᵀ beside a matrix: the volume of a fluid joins all nodes of its surface.
struct RankOne {
  double stiffness = 0;   ///< K / V* [Pa/m³]
  std::vector<double> g;  ///< dV by degrees of freedom [m²], [m³]
};

/// y += stiffness · g (g · x)
inline void add_product(const RankOne& update, std::span<const double> x, std::span<double> y) {
  double along = 0;
  for (std::size_t i = 0; i < x.size(); ++i) along += update.g[i] * x[i];
  along *= update.stiffness;
  for (std::size_t i = 0; i < x.size(); ++i) y[i] += update.g[i] * along;
}

}  // namespace fascia
