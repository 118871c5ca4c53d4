#pragma once

#include "gpu/blocks.hpp"
#include "gpu/cg.hpp"
#include "gpu/model_data.hpp"

/// Loops over nodes of a product with the tangent.
namespace fascia::gpu::kernels {

/// Vectors of a product in world axes.
struct ProductView {
  ModelView m;
  const Mat3d* Q = nullptr;
  const double* node_blocks = nullptr;
  double *d = nullptr, *y = nullptr;  ///< (degrees of freedom): direction and product
  Vec3d* dx = nullptr;
  Mat3d* dA = nullptr;
};

/// The next direction of a solve, turned into world axes.
struct NextDirection {
  ProductView w;
  CgView v;
  FASCIA_HD void operator()(int i) const {
    const int first = w.m.nodes.dof[i], n = w.m.nodes.size(i);
    double d[kMostDofs];
    for (int k = 0; k < n; ++k) {
      v.next_direction(first + k);
      d[k] = v.p[first + k];
    }
    w.m.to_global(i, d);
    for (int k = 0; k < n; ++k) w.d[first + k] = d[k];
    w.dx[i] = {{d[0], d[1], d[2]}};
    if (w.dA != nullptr) w.dA[i] = frame_variation(w.m.nodes.kind[i], d + 3, w.Q[i]);
  }
};

/// (dx, dA) of a direction in world axes.
struct SplitDirection {
  ProductView w;
  FASCIA_HD void operator()(int i) const {
    const double* d = w.d + w.m.nodes.dof[i];
    w.dx[i] = {{d[0], d[1], d[2]}};
    if (w.dA != nullptr) w.dA[i] = frame_variation(w.m.nodes.kind[i], d + 3, w.Q[i]);
  }
};

/// −gradient − what prescribed motion does, in constraint axes on the free degrees of freedom.
struct RightHandSide {
  ModelView m;
  const double *gradient, *moved;  ///< moved: none where nothing is prescribed
  double* rhs;
  FASCIA_HD void operator()(int i) const {
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    double g[kMostDofs];
    for (int k = 0; k < n; ++k) g[k] = -gradient[first + k];
    m.to_local(i, g);
    for (int k = 0; k < n; ++k)
      rhs[first + k] = m.is_fixed(i, k) ? 0.0 : g[k] - (moved == nullptr ? 0.0 : moved[first + k]);
  }
};

/// y = K d of a node in world axes, from what blocks left.
struct GatherProduct {
  ProductView w;
  BlocksView blocks;

  FASCIA_HD void operator()(int i) const {
    double y[kMostDofs];
    product_of(i, y);
    const int first = w.m.nodes.dof[i];
    for (int k = 0; k < w.m.nodes.size(i); ++k) w.y[first + k] = y[k];
  }
  FASCIA_HD void product_of(int i, double* y) const {
    const FrameKind kind = w.m.nodes.kind[i];
    const int first = w.m.nodes.dof[i], n = w.m.nodes.size(i);
    const double* block = w.node_blocks + w.m.nodes.block[i];
    NodeSums sums;
    blocks.add_sums(i, sums);
    for (int r = 0; r < n; ++r) {
      double sum = r < 3 ? sums.force[r] : 0;
      for (int c = 0; c < n; ++c) sum += block[n * r + c] * w.d[first + c];
      y[r] = sum;
    }
    add_moment(kind, sums.N, w.Q[i], y + 3);
    if (kind == FrameKind::rigid)
      for (int k = 0; k < 3; ++k) y[3 + k] += sums.torque[k];
  }
};

/// y in constraint axes as the solve's Ap, without what is held; Σ p · Ap.
struct FinishProduct {
  ProductView w;
  CgView v;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    double y[kMostDofs];
    const int first = w.m.nodes.dof[i];
    for (int k = 0; k < w.m.nodes.size(i); ++k) y[k] = w.y[first + k];
    finish(i, y, sums);
  }
  FASCIA_HD void finish(int i, double* y, Sums<1>& sums) const {
    const int first = w.m.nodes.dof[i];
    w.m.to_local(i, y);
    for (int k = 0; k < w.m.nodes.size(i); ++k) {
      const double value = w.m.is_fixed(i, k) ? 0.0 : y[k];
      v.Ap[first + k] = value;
      sums.v[0] += v.p[first + k] * value;
    }
  }
};

/// Both in one, where nothing else adds to y.
struct GatherAndFinish {
  GatherProduct gather;
  FinishProduct end;
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

struct TakeCurvature {
  CgView v;
  FASCIA_HD void operator()(const Sums<1>& total) const { v.curvature(total.v[0]); }
};

}  // namespace fascia::gpu::kernels
