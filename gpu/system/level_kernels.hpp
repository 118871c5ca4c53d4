#pragma once

#include "core/levels/block_rows.hpp"
#include "core/levels/multigrid.hpp"
#include "core/space/space.hpp"

/// Loops of a cycle through levels of rigid frames.
namespace fascia::gpu::kernels {

/// Nodes of a level: of the model on the finest, of which `dof` and `block` are; rigid frames on all others.
struct LevelNodes {
  int count = 0;
  const int* dof = nullptr;
  const std::size_t* block = nullptr;

  FASCIA_HD int begin(int node) const { return dof != nullptr ? dof[node] : kFrameDofs * node; }
  FASCIA_HD int size(int node) const { return dof != nullptr ? dof[node + 1] - dof[node] : kFrameDofs; }
  FASCIA_HD std::size_t block_begin(int node) const {
    return block != nullptr ? block[node] : static_cast<std::size_t>(kFrameDofs * kFrameDofs) * node;
  }
};

/// Rows of blocks in a space: their columns are rigid frames, or on the finest level nodes of the model.
struct BlockRowsView {
  const int *begin = nullptr, *column = nullptr;
  const int* before = nullptr;  ///< of each block: degrees of freedom of the columns before it in its row; none: frames
  const std::size_t* value_begin = nullptr;  ///< of each row
  const double* values = nullptr;

  /// Block k, of a row of so many degrees of freedom.
  FASCIA_HD const double* block(int row, int k, int size) const {
    const int columns = before != nullptr ? before[k] : kFrameDofs * (k - begin[row]);
    return values + value_begin[row] + static_cast<std::size_t>(size) * static_cast<std::size_t>(columns);
  }
};

/// A smoother of a level: D⁻¹, and what it makes of residuals.
struct Smoother {
  LevelNodes nodes;
  const double* inverse = nullptr;
  Smoothing by;

  /// z = D⁻¹ r of a node.
  FASCIA_HD void apply(int node, const double* r, double* z) const {
    const int n = nodes.size(node);
    const double* block = inverse + nodes.block_begin(node);
    for (int i = 0; i < n; ++i) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += block[n * i + j] * r[j];
      z[i] = sum;
    }
  }
  /// x += again d + next D⁻¹ r of a node.
  FASCIA_HD void finish(int node, const double* r, const double* d, double* x) const {
    double z[kMostDofs];
    apply(node, r, z);
    const int first = nodes.begin(node);
    for (int i = 0; i < nodes.size(node); ++i) x[first + i] += by.again * d[first + i] + by.next * z[i];
  }
};

/// d = first D⁻¹ r, x ← d or x + d.
struct BeginSmoothing {
  Smoother smoother;
  const double* r;
  double *d, *x;
  bool from_zero;
  FASCIA_HD void operator()(int node) const {
    double z[kMostDofs];
    const int first = smoother.nodes.begin(node);
    smoother.apply(node, r + first, z);
    for (int i = 0; i < smoother.nodes.size(node); ++i) {
      const double value = smoother.by.first * z[i];
      d[first + i] = value;
      x[first + i] = from_zero ? value : x[first + i] + value;
    }
  }
};

/// (K x) of a node, eight of its neighbours at a time. @tparam N  degrees of freedom of the largest node
template <int N>
struct LevelProduct {
  LevelNodes nodes;
  BlockRowsView K;
  const double* x;
  FASCIA_HD void operator()(int node, int lane, Sums<N>& sums) const {
    const int n = nodes.size(node);
    for (int k = K.begin[node] + lane; k < K.begin[node + 1]; k += kSpaceLanes) {
      const int column = K.column[k], m = nodes.size(column);
      const double *block = K.block(node, k, n), *of = x + nodes.begin(column);
      for (int i = 0; i < N; ++i)
        if (i < n)
          for (int j = 0; j < m; ++j) sums.v[i] += block[m * i + j] * of[j];
    }
  }
};

/// Ends a product of d with the end of smoothing.
template <int N>
struct EndSmoothing {
  Smoother smoother;
  const double *r, *d;
  double* x;
  FASCIA_HD void operator()(int node, const Sums<N>& Kd) const {
    double left[N];
    const int first = smoother.nodes.begin(node), n = smoother.nodes.size(node);
    for (int i = 0; i < N; ++i) left[i] = i < n ? r[first + i] - Kd.v[i] : 0;
    smoother.finish(node, left, d, x);
  }
};

/// Ends a product of x: r = b − K x.
template <int N>
struct Difference {
  LevelNodes nodes;
  const double* b;
  double* r;
  FASCIA_HD void operator()(int node, const Sums<N>& Kx) const {
    const int first = nodes.begin(node), n = nodes.size(node);
    for (int i = 0; i < N; ++i)
      if (i < n) r[first + i] = b[first + i] - Kx.v[i];
  }
};

/// Pᵀ r of a coarser frame: of the nodes whose rows it is a column of, in ascending order.
struct Restrict {
  LevelNodes finer;
  const int *begin, *row;
  const std::size_t* block;  ///< where the block of each of those starts
  const double *values, *r;
  FASCIA_HD void operator()(int coarse, int lane, Sums<kFrameDofs>& sums) const {
    for (int k = begin[coarse] + lane; k < begin[coarse + 1]; k += kSpaceLanes) {
      const int node = row[k];
      const double *P = values + block[k], *of = r + finer.begin(node);
      for (int i = 0; i < finer.size(node); ++i)
        for (int j = 0; j < kFrameDofs; ++j) sums.v[j] += P[kFrameDofs * i + j] * of[i];
    }
  }
};

struct TakeRestricted {
  double* b;
  FASCIA_HD void operator()(int coarse, const Sums<kFrameDofs>& total) const {
    for (int j = 0; j < kFrameDofs; ++j) b[kFrameDofs * coarse + j] = total.v[j];
  }
};

/// x += P of what the coarser level found.
struct Prolong {
  LevelNodes nodes;
  BlockRowsView P;
  const double* coarse;
  double* x;
  FASCIA_HD void operator()(int node) const {
    const int first = nodes.begin(node), n = nodes.size(node);
    const double* block = P.block(node, P.begin[node], n);
    for (int k = P.begin[node]; k < P.begin[node + 1]; ++k, block += n * kFrameDofs) {
      const double* of = coarse + kFrameDofs * P.column[k];
      for (int i = 0; i < n; ++i) {
        double sum = 0;
        for (int j = 0; j < kFrameDofs; ++j) sum += block[kFrameDofs * i + j] * of[j];
        x[first + i] += sum;
      }
    }
  }
};

/// Entry of K⁻¹ b with all entries of the inverse.
struct DenseProduct {
  int n;
  const double *inverse, *b;
  FASCIA_HD void operator()(int row, int lane, Sums<1>& sums) const {
    const double* own = inverse + static_cast<std::size_t>(n) * row;
    for (int k = lane; k < n; k += kSpaceLanes) sums.v[0] += own[k] * b[k];
  }
};

struct TakeEntry {
  double* x;
  FASCIA_HD void operator()(int row, const Sums<1>& total) const { x[row] = total.v[0]; }
};

}  // namespace fascia::gpu::kernels
