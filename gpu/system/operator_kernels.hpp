#pragma once

#include "core/step/model_data.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/space/lanes.hpp"
#include "gpu/system/cg.hpp"

/// Loops over nodes of a product with the tangent.
namespace fascia::gpu::kernels {

/// Vectors of a product in world axes. @tparam T, V  as of DirectionOf
template <class T, class V>
struct ProductView {
  ModelView m;
  const Mat3d* Q = nullptr;
  const V* node_blocks = nullptr;
  V* d = nullptr;       ///< (degrees of freedom): direction
  double* y = nullptr;  ///< (degrees of freedom): product
  Vec3<V>* dx = nullptr;
  Mat3<T>* dA = nullptr;

  DirectionOf<T, V> direction() const { return {d, dx, dA}; }
  /// Takes a direction of a node.
  FASCIA_HD void split(int i, const double* own) const {
    dx[i] = rounded<V>(Vec3d{{own[0], own[1], own[2]}});
    if (dA != nullptr) dA[i] = rounded<T>(frame_variation(m.nodes.kind[i], own + 3, Q[i]));
  }
};

/// The next direction of a solve, turned into world axes.
/// @tparam C  scalar of the solve's vectors
template <class T, class V, class C>
struct NextDirection {
  ProductView<T, V> w;
  CgView<C> v;
  FASCIA_HD void operator()(int i) const {
    const int first = w.m.nodes.dof[i], n = w.m.nodes.size(i);
    double d[kMostDofs];
    for (int k = 0; k < n; ++k) {
      v.next_direction(first + k);
      d[k] = v.p[first + k];
    }
    w.m.to_global(i, d);
    for (int k = 0; k < n; ++k) w.d[first + k] = static_cast<V>(d[k]);
    w.split(i, d);
  }
};

/// (dx, dA) of a direction in world axes.
struct SplitDirection {
  ProductView<double, double> w;
  FASCIA_HD void operator()(int i) const { w.split(i, w.d + w.m.nodes.dof[i]); }
};

/// A direction with the scalars of products and vectors.
template <class T, class V>
struct RoundDirection {
  ProductView<double, double> from;
  ProductView<T, V> to;
  FASCIA_HD void operator()(int i) const {
    if (to.dA != nullptr) to.dA[i] = rounded<T>(from.dA[i]);
    if constexpr (!std::is_same_v<V, double>) {
      to.dx[i] = rounded<V>(from.dx[i]);
      for (int k = from.m.nodes.dof[i]; k < from.m.nodes.dof[i + 1]; ++k) to.d[k] = static_cast<V>(from.d[k]);
    }
  }
};

/// Values of another scalar.
template <class V>
struct Round {
  const double* from;
  V* to;
  FASCIA_HD void operator()(std::size_t i) const { to[i] = static_cast<V>(from[i]); }
};

/// −gradient − what prescribed motion does, in constraint axes on the free degrees of freedom.
template <class V>
struct RightHandSide {
  ModelView m;
  const double *gradient, *moved;  ///< moved: none where nothing is prescribed
  V* rhs;
  FASCIA_HD void operator()(int i) const {
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    double g[kMostDofs];
    for (int k = 0; k < n; ++k) g[k] = -gradient[first + k];
    m.to_local(i, g);
    for (int k = 0; k < n; ++k)
      rhs[first + k] = static_cast<V>(m.is_fixed(i, k) ? 0.0 : g[k] - (moved == nullptr ? 0.0 : moved[first + k]));
  }
};

/// y = K d of a node in world axes, from what blocks left.
template <class T, class V>
struct GatherProduct {
  ProductView<T, V> w;
  BlocksOf<T> blocks;

  FASCIA_HD void operator()(int i) const {
    double y[kMostDofs];
    product_of(i, y);
    const int first = w.m.nodes.dof[i];
    for (int k = 0; k < w.m.nodes.size(i); ++k) w.y[first + k] = y[k];
  }
  FASCIA_HD void product_of(int i, double* y) const {
    const FrameKind kind = w.m.nodes.kind[i];
    const int first = w.m.nodes.dof[i], n = w.m.nodes.size(i);
    const V* block = w.node_blocks + w.m.nodes.block[i];
    NodeSums sums;
    blocks.add_sums(i, sums);
    for (int r = 0; r < n; ++r) {
      double sum = r < 3 ? sums.force[r] : 0;
      for (int c = 0; c < n; ++c) sum += static_cast<double>(block[n * r + c]) * w.d[first + c];
      y[r] = sum;
    }
    add_moment(kind, sums.N, w.Q[i], y + 3);
    if (kind == FrameKind::rigid)
      for (int k = 0; k < 3; ++k) y[3 + k] += sums.torque[k];
  }
};

/// y in constraint axes as the solve's Ap, without what is held; Σ p · Ap.
template <class V>
struct FinishProduct {
  ModelView m;
  CgView<V> v;
  const double* product;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    double y[kMostDofs];
    const int first = m.nodes.dof[i];
    for (int k = 0; k < m.nodes.size(i); ++k) y[k] = product[first + k];
    finish(i, y, sums);
  }
  FASCIA_HD void finish(int i, double* y, Sums<1>& sums) const {
    const int first = m.nodes.dof[i];
    m.to_local(i, y);
    for (int k = 0; k < m.nodes.size(i); ++k) {
      const double value = m.is_fixed(i, k) ? 0.0 : y[k];
      v.Ap[first + k] = static_cast<V>(value);
      sums.v[0] += v.p[first + k] * value;
    }
  }
};

/// Both in one, where nothing else adds to y.
template <class T, class V, class C>
struct GatherAndFinish {
  GatherProduct<T, V> gather;
  FinishProduct<C> end;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    double y[kMostDofs];
    gather.product_of(i, y);
    end.finish(i, y, sums);
  }
};

/// |b − y|² and |b|²
struct LinearResidual {
  const double *b, *y;
  FASCIA_HD void operator()(int i, Sums<2>& sums) const {
    const double r = b[i] - y[i];
    sums.v[0] += r * r;
    sums.v[1] += b[i] * b[i];
  }
};

template <class V>
struct TakeCurvature {
  CgView<V> v;
  FASCIA_HD void operator()(const Sums<1>& total) const { v.curvature(total.v[0]); }
};

}  // namespace fascia::gpu::kernels
