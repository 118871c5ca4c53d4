#pragma once

#include "gpu/elements/element_kernels.hpp"

/// Node-averaged volumetric strain of linear tetrahedra (core/executor/element_average.cpp).
namespace fascia::gpu::kernels {

/// V θ/4 of each element, or its derivative along dx.
template <Law L, class T, class V>
struct ThetaPass {
  ElementBlockOf<T> block;
  const Vec3d* u;
  const Vec3<V>* dx;

  FASCIA_HD void operator()(int e) const {
    const ElementPoints<4, T> x(block, e, {});
    const Mat3<T> H = x.gradient_of_nodes(u);
    const T theta = dx == nullptr ? SolidLaw<L, T>::volumetric_strain(H)
                                  : contract(SolidLaw<L, T>::volumetric_gradient(H), x.gradient_of_nodes(dx));
    block.theta[e] = theta * x.v(0) * T(0.25);
  }
};

/// k times the mean about each node. @param given  of the block; its elements fade alike
template <class T>
struct NodeAveragePass {
  ElementBlockOf<T> block;
  const double* given;

  FASCIA_HD void operator()(int node) const {
    double sum = 0;
    for (int k = block.around_begin[node]; k < block.around_begin[node + 1]; ++k)
      sum += block.theta[block.around[k] / 4];
    block.node_pressure[node] =
        sum == 0 ? T(0) : static_cast<T>(bulk_factor(given) * block.node_modulus[node] * sum / block.node_volume[node]);
  }
};

/// V/4 ∂θ/∂x of each corner.
template <Law L, class T>
struct ThetaGradientPass {
  ElementBlockOf<T> block;
  const Vec3d* u;

  FASCIA_HD void operator()(int e) const {
    const ElementPoints<4, T> x(block, e, {});
    x.store_forces(SolidLaw<L, T>::volumetric_gradient(x.gradient_of_nodes(u)) * (x.v(0) * T(0.25)));
  }
};

/// The node's own block of Σ k_a V_a G_a G_aᵀ, G_a = ∂θ_a/∂x, after ThetaGradientPass: over the nodes a of the elements
/// about it.
template <class T>
struct AverageDiagonalPass {
  ElementBlockOf<T> block;
  NodesView nodes;
  double* blocks;
  const double* given;

  FASCIA_HD void operator()(int node) const {
    const int begin = block.around_begin[node], end = block.around_begin[node + 1];
    Mat3d K;
    for (int k = begin; k < end; ++k)
      for (int b = 0; b < 4; ++b) {
        const int a = corner_node(k, b);
        if (find(begin, k, a) < k) continue;  // it has been met before
        Vec3d G;
        for (int l = k; l < end; l = find(l + 1, end, a)) G += corner_gradient(l);
        K += outer(G, G) * (bulk_factor(given) * block.node_modulus[a] / block.node_volume[a]);
      }
    double* out = blocks + nodes.block[node];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) out[nodes.size(node) * r + c] += K(r, c);
  }

 private:
  FASCIA_HD int corner_node(int k, int corner) const {
    const int e = block.around[k] / 4;
    return node_of(block, e / kLanes, corner, e % kLanes);
  }
  /// The next of the elements [first, end) about the node that has node a, or end.
  FASCIA_HD int find(int first, int end, int a) const {
    for (; first < end; ++first)
      for (int b = 0; b < 4; ++b)
        if (corner_node(first, b) == a) return first;
    return end;
  }
  FASCIA_HD Vec3d corner_gradient(int k) const {
    const int e = block.around[k] / 4, corner = block.around[k] % 4;
    return rounded<double>(gradient(block.corners + at(e / kLanes) * 12 * kLanes, corner, e % kLanes));
  }
};

/// The next column of each node's own block: what unit motions left on the corners.
template <class T>
struct DiagonalColumn {
  ElementsOf<T> set;
  NodesView nodes;
  double* blocks;
  int axis;

  FASCIA_HD void operator()(int node) const {
    NodeSums sums;
    set.add_sums(node, sums);
    double* out = blocks + nodes.block[node];
    for (int r = 0; r < 3; ++r) out[nodes.size(node) * r + axis] += sums.force[r];
  }
};

}  // namespace fascia::gpu::kernels
