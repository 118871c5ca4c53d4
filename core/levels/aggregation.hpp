#pragma once

#include "core/base/thread_pool.hpp"
#include "core/levels/block_rows.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fascia {

/// Nodes in groups, each of which becomes one rigid frame of the next coarser level.
struct Aggregates {
  int count = 0;
  std::vector<int> of_node;  ///< −1: in none, because nothing of it is free or nothing holds it to its neighbours
};

namespace aggregation {

/// L (n × n) of K_ii = L Lᵀ; what is prescribed stands alone, and pivots are kept positive.
inline void factorize(const double* K, int n, unsigned fixed, double* L) {
  double largest = 0;
  for (int i = 0; i < n; ++i) largest = std::max(largest, std::abs(K[n * i + i]));
  if (largest == 0) largest = 1;
  std::fill(L, L + n * n, 0.0);
  for (int j = 0; j < n; ++j) {
    double pivot = K[n * j + j];
    for (int k = 0; k < j; ++k) pivot -= L[n * j + k] * L[n * j + k];
    const bool held = ((fixed >> j) & 1U) != 0;
    const double root = std::sqrt(held ? largest : std::max(std::abs(pivot), 1e-12 * largest));
    L[n * j + j] = root;
    for (int i = j + 1; i < n; ++i) {
      double sum = K[n * i + j];
      for (int k = 0; k < j; ++k) sum -= L[n * i + k] * L[n * j + k];
      L[n * i + j] = sum / root;
    }
  }
}

/// ‖L⁻¹ B M⁻ᵀ‖², B n × m. B is overwritten.
inline double scaled_square(double* B, int n, const double* L, int m, const double* M) {
  double square = 0;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      double v = B[m * i + j];
      for (int k = 0; k < i; ++k) v -= L[n * i + k] * B[m * k + j];
      B[m * i + j] = v / L[n * i + i];
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      double v = B[m * i + j];
      for (int k = 0; k < j; ++k) v -= M[m * j + k] * B[m * i + k];
      B[m * i + j] = v / M[m * j + j];
      square += B[m * i + j] * B[m * i + j];
    }
  return square;
}

/// Strong neighbours of each node, and how strong they are.
struct Strong {
  std::vector<int> begin{0}, column;
  std::vector<float> strength;
};

template <class Matrix>
Strong strong_neighbours(const Matrix& A, ThreadPool& pool, double threshold) {
  constexpr int kGrain = 64;
  const int n = A.rows();
  std::vector<std::size_t> begin(at(n) + 1, 0);
  for (int i = 0; i < n; ++i) begin[at(i) + 1] = begin[at(i)] + at(A.size(i) * A.size(i));
  std::vector<double> factors(begin.back());
  const auto L = [&](int i) { return factors.data() + begin[at(i)]; };
  pool.for_ranges(n, kGrain, [&](int first, int end) {
    for (int i = first; i < end; ++i)
      A.for_each_block(i, [&](int j, const double* block) {
        if (j == i) factorize(block, A.size(i), A.fixed(i), L(i));
      });
  });
  std::vector<Strong> part(at((n + kGrain - 1) / kGrain));
  pool.for_ranges(n, kGrain, [&](int first, int end) {
    Strong& found = part[at(first / kGrain)];
    for (int i = first; i < end; ++i) {
      const int size = A.size(i);
      A.for_each_block(i, [&](int j, const double* block) {
        if (j == i) return;
        double B[kMostDofs * kMostDofs];
        std::copy(block, block + size * A.size(j), B);
        const double square = scaled_square(B, size, L(i), A.size(j), L(j));
        if (!(square >= threshold * threshold)) return;
        found.column.push_back(j);
        found.strength.push_back(static_cast<float>(square));
      });
      found.begin.push_back(static_cast<int>(found.column.size()));
    }
  });
  Strong all;
  for (const Strong& p : part) {
    const int before = static_cast<int>(all.column.size());
    for (std::size_t k = 1; k < p.begin.size(); ++k) all.begin.push_back(before + p.begin[k]);
    all.column.insert(all.column.end(), p.column.begin(), p.column.end());
    all.strength.insert(all.strength.end(), p.strength.begin(), p.strength.end());
  }
  return all;
}

}  // namespace aggregation

/// Greedy aggregates in the order of nodes (Vanek, Mandel, Brezina 1996): first nodes with all of their strong
/// neighbours, then what is left goes to the strongest neighbour that is in one.
/// @param threshold  neighbours i and j are strong where ‖L_i⁻¹ K_ij L_j⁻ᵀ‖ (Frobenius) is at least this, with
///                   K_ii = L_i L_iᵀ
template <class Matrix>
Aggregates aggregate(const Matrix& A, ThreadPool& pool, double threshold) {
  const aggregation::Strong strong = aggregation::strong_neighbours(A, pool, threshold);
  const int n = A.rows();
  Aggregates out;
  out.of_node.assign(at(n), -1);
  const auto neighbours = [&](int i) {
    return std::span(strong.column).subspan(at(strong.begin[at(i)]), at(strong.begin[at(i + 1)] - strong.begin[at(i)]));
  };
  for (int i = 0; i < n; ++i) {
    const std::span<const int> near = neighbours(i);
    if (near.empty() || out.of_node[at(i)] >= 0) continue;
    if (std::any_of(near.begin(), near.end(), [&](int j) { return out.of_node[at(j)] >= 0; })) continue;
    out.of_node[at(i)] = out.count;
    for (const int j : near) out.of_node[at(j)] = out.count;
    ++out.count;
  }
  const std::vector<int> cores = out.of_node;
  for (int i = 0; i < n; ++i) {
    if (cores[at(i)] >= 0) continue;
    float strongest = 0;
    for (int k = strong.begin[at(i)]; k < strong.begin[at(i + 1)]; ++k) {
      const int j = strong.column[at(k)];
      if (cores[at(j)] < 0 || strong.strength[at(k)] <= strongest) continue;
      strongest = strong.strength[at(k)];
      out.of_node[at(i)] = cores[at(j)];
    }
  }
  return out;
}

}  // namespace fascia
