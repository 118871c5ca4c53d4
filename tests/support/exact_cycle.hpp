#pragma once

#include "core/levels/multigrid.hpp"
#include "tests/support/tangent_at_rest.hpp"

#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace fascia::test {

/// A cycle over the levels of a tangent as decisions/multigrid.md describes it: one thread, all entries of 64 bits,
/// none of the loops of Multigrid.
class ExactCycle {
 public:
  using Vector = std::vector<double>;

  ExactCycle(const Multigrid& levels, TangentAtRest& tangent)
      : levels_(levels), tangent_(tangent), coarsest_(levels.coarsest_inverse()) {}

  Vector solve(const Vector& b, std::size_t depth = 0) {
    const bool last = depth + 1 == levels_.level_count();
    if (last && !coarsest_.empty()) return multiplied(coarsest_, b.size(), b.size(), b);
    Vector x(b.size(), 0.0);
    smooth(depth, b, x);
    for (int k = 0; !last && k < corrections(depth, levels_.level_count()); ++k) {
      const Multigrid::LevelView level = levels_.level(depth);
      const BlockRows& P = *level.P;
      Vector coarse(at(kFrameDofs * levels_.level(depth + 1).nodes), 0.0);
      const Vector r = residual(depth, b, x);
      for_each_entry(P, depth, [&](std::size_t i, std::size_t j, double p) { coarse[j] += p * r[i]; });
      coarse = solve(coarse, depth + 1);
      for_each_entry(P, depth, [&](std::size_t i, std::size_t j, double p) { x[i] += p * coarse[j]; });
    }
    smooth(depth, b, x);
    return x;
  }

  /// K x of a level.
  Vector product(std::size_t depth, const Vector& x) {
    Vector Kx(x.size(), 0.0);
    if (depth == 0)
      tangent_.multiply(x, Kx);
    else
      for_each_entry(*levels_.level(depth).matrix, depth,
                     [&](std::size_t i, std::size_t j, double K) { Kx[i] += K * x[j]; });
    return Kx;
  }
  /// Pᵀ K P x, where K and P are those of a level and x lies on the next coarser one.
  Vector galerkin_product(std::size_t depth, const Vector& x) {
    const Multigrid::LevelView level = levels_.level(depth);
    Vector fine(depth == 0 ? at(tangent_.matrix.dofs().total()) : at(kFrameDofs * level.nodes), 0.0);
    for_each_entry(*level.P, depth, [&](std::size_t i, std::size_t j, double p) { fine[i] += p * x[j]; });
    fine = product(depth, fine);
    Vector y(x.size(), 0.0);
    for_each_entry(*level.P, depth, [&](std::size_t i, std::size_t j, double p) { y[j] += p * fine[i]; });
    return y;
  }

 private:
  static Vector multiplied(std::span<const double> A, std::size_t rows, std::size_t columns, const Vector& x) {
    Vector y(rows);
    for (std::size_t i = 0; i < rows; ++i) y[i] = std::inner_product(x.begin(), x.end(), A.data() + i * columns, 0.0);
    return y;
  }
  int size(std::size_t depth, int node) const { return depth == 0 ? tangent_.matrix.dofs().size(node) : kFrameDofs; }

  /// Calls act(row, column, entry) for single degrees of freedom.
  template <class Act>
  void for_each_entry(const BlockRows& rows, std::size_t depth, const Act& act) const {
    std::size_t first = 0;
    for (int node = 0; node < rows.rows(); ++node) {
      const int n = size(depth, node);
      const std::span<const int> columns = rows.columns(node);
      for (std::size_t k = 0; k < columns.size(); ++k)
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < kFrameDofs; ++j)
            act(first + at(i), at(kFrameDofs * columns[k] + j),
                rows.block(node, static_cast<int>(k), n)[kFrameDofs * i + j]);
      first += at(n);
    }
  }
  Vector residual(std::size_t depth, const Vector& b, const Vector& x) {
    Vector Kx = product(depth, x);
    for (std::size_t i = 0; i < b.size(); ++i) Kx[i] = b[i] - Kx[i];
    return Kx;
  }
  Vector preconditioned(std::size_t depth, const Vector& r) const {
    const Multigrid::LevelView level = levels_.level(depth);
    Vector z;
    const double* block = level.inverse.data();
    for (int node = 0; node < level.nodes; ++node) {
      const auto n = at(size(depth, node));
      const Vector own(r.begin() + static_cast<std::ptrdiff_t>(z.size()),
                       r.begin() + static_cast<std::ptrdiff_t>(z.size() + n));
      for (const double v : multiplied({block, n * n}, n, n, own)) z.push_back(v);
      block += n * n;
    }
    return z;
  }
  void smooth(std::size_t depth, const Vector& b, Vector& x) {
    const Smoothing by = Smoothing::up_to(levels_.level(depth).largest);
    const Vector first = preconditioned(depth, residual(depth, b, x));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += by.first * first[i];
    const Vector next = preconditioned(depth, residual(depth, b, x));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += by.again * by.first * first[i] + by.next * next[i];
  }

  const Multigrid& levels_;
  TangentAtRest& tangent_;
  Vector coarsest_;
};

}  // namespace fascia::test
