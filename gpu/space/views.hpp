#pragma once

#include "core/structure/dof_layout.hpp"

#include <cstddef>

/// What kernels see: pointers into a space and values, copied into each kernel.
namespace fascia::gpu {

/// Nodes of the model.
struct NodesView {
  int count = 0;
  const FrameKind* kind = nullptr;
  const int* dof = nullptr;             ///< first degree of freedom
  const std::size_t* block = nullptr;   ///< where the node's own square block starts among all of them
  const int* part = nullptr;            ///< connected part
  const double* part_length = nullptr;  ///< of each part [m]

  FASCIA_HD int size(int node) const { return dof[node + 1] - dof[node]; }
};

/// Displacement and Q − I or A − I of each node. Where no node turns there is no D.
struct PoseView {
  const Vec3d* u = nullptr;
  const Mat3d* D = nullptr;

  FASCIA_HD Mat3d D_of(int node) const { return D == nullptr ? Mat3d{} : D[node]; }
};

/// A small motion of all nodes: by degrees of freedom, and as (dx, dA) of each node.
/// @tparam T  scalar of products, V  of vectors (core/solver/settings.hpp, Precision)
template <class T, class V>
struct DirectionOf {
  const V* d = nullptr;         ///< (degrees of freedom)
  const Vec3<V>* dx = nullptr;  ///< (nodes)
  const Mat3<T>* dA = nullptr;  ///< (nodes); none where no node turns
};
using DirectionView = DirectionOf<double, double>;

/// A step of Newton's method that led to a pose, along which its tangent extrapolates stresses. None: no start.
struct TakenStepView {
  PoseView start;
  DirectionView direction;
  double length = 0;  ///< in directions

  FASCIA_HD bool known() const { return start.u != nullptr; }
};

/// Strains of one block at the start of a step, and 1/dt of viscous stress; no strains where nothing is damped.
struct HistoryView {
  const double* E = nullptr;
  double inverse_step = 0;
  const double* S = nullptr;  ///< extrapolated stresses of a tangent, in the layout of E; none: those of the state
};

/// What a node feels: a force, N conjugate to Q or A, and a torque beside it.
struct NodeSums {
  Vec3d force{}, torque{};
  Mat3d N{};
};

/// What a point, element or spring has at a state: energies [J], and squares of the rounding in its forces and of the
/// pull of tethers [N²].
enum Quantity { kElastic, kStabilizing, kViscous, kRounding, kTether, kQuantities };

}  // namespace fascia::gpu
