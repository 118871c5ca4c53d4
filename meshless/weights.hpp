#pragma once

#include "core/math/vec3.hpp"

#include <algorithm>
#include <array>
#include <concepts>

/// Weight functions on one cell of a frame grid. Coordinates run from 0 to 1 inside the cell and may leave it: the
/// functions are then continued, and stay linear-consistent. Corner k of a cell is at (k & 1, k >> 1 & 1, k >> 2).
namespace fascia {

template <int N>
struct CellWeights {
  std::array<int, N> corner{};      ///< ascending
  std::array<double, N> w{};        ///< sum 1
  std::array<Vec3d, N> gradient{};  ///< with respect to the cell's coordinates, sum 0
};

/// What a builder needs of a weight function on a grid.
template <class W>
concept GridWeights = requires(const Vec3d& xi) {
  { W::kNeighbours } -> std::convertible_to<int>;
  { W::at(xi) } -> std::same_as<CellWeights<W::kNeighbours>>;
};

/// Products of linear functions: 8 neighbours.
struct TrilinearWeights {
  static constexpr int kNeighbours = 8;

  static CellWeights<8> at(const Vec3d& xi) {
    CellWeights<8> r;
    for (int k = 0; k < 8; ++k) {
      double f[3], df[3];
      for (int a = 0; a < 3; ++a) {
        const bool upper = (k >> a & 1) != 0;
        f[a] = upper ? xi[a] : 1 - xi[a];
        df[a] = upper ? 1 : -1;
      }
      const auto i = static_cast<std::size_t>(k);
      r.corner[i] = k;
      r.w[i] = f[0] * f[1] * f[2];
      r.gradient[i] = {{df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2]}};
    }
    return r;
  }
};

/// Barycentric coordinates of the tetrahedron, one of six around the cell's main diagonal, that the point lies in:
/// 4 neighbours. With ξa ≥ ξb ≥ ξc its corners are 0, a, a + b, 7.
struct LinearWeights {
  static constexpr int kNeighbours = 4;

  static CellWeights<4> at(const Vec3d& xi) {
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return xi[i] > xi[j]; });
    return in_tetrahedron(order, xi);
  }

  /// The same in a given tetrahedron, named by its order of axes.
  static CellWeights<4> in_tetrahedron(const std::array<int, 3>& order, const Vec3d& xi) {
    CellWeights<4> r;
    r.w = {1 - xi[order[0]], xi[order[0]] - xi[order[1]], xi[order[1]] - xi[order[2]], xi[order[2]]};
    for (std::size_t k = 0; k < 4; ++k) {
      if (k > 0) {
        r.corner[k] = r.corner[k - 1] | 1 << order[k - 1];
        r.gradient[k][order[k - 1]] += 1;
      }
      if (k < 3) r.gradient[k][order[k]] -= 1;
    }
    return r;
  }
};

}  // namespace fascia
