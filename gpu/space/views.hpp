#pragma once

#include "core/step/model_view.hpp"
#include "core/structure/stress_memory.hpp"

/// Views of a model for kernels of blocks: pointers into a space and values, copied into each kernel.
namespace fascia::gpu {

/// A small motion of all nodes: by degrees of freedom, and as (dx, dA) of each node.
/// @tparam T  scalar of products, V  of vectors (core/tangent/linear_settings.hpp, Precision)
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

/// Strains of one block at the start of a step, and 1/dt of viscous stress; no strains where nothing is damped. What a
/// step gives the points that remember stresses (GivenRow); none where nothing fades.
struct HistoryView {
  const double* E = nullptr;
  double inverse_step = 0;
  const double* S = nullptr;  ///< extrapolated stresses of a tangent, in the layout of E; none: those of the state
  const double* given = nullptr;
};

/// Rows of the lanes of a batch (GivenRow).
FASCIA_HD inline const double* given_rows(const double* given, std::size_t batch) {
  return given + batch * kGivenRows * MemoryLayout::kLanes;
}
template <class T>
FASCIA_HD LawFactors<T> law_factors(const double* rows, GivenRow first, int lane) {
  return {static_cast<T>(rows[first * MemoryLayout::kLanes + lane]),
          static_cast<T>(rows[(first + 1) * MemoryLayout::kLanes + lane])};
}

/// Sums of what acts on a node: a force, N conjugate to Q or A, and a torque beside it.
struct NodeSums {
  Vec3d force{}, torque{};
  Mat3d N{};
};

/// Quantities of a point, element or spring at a state: energies [J], and squares of the rounding in its forces and of
/// the pull of tethers [N²].
enum Quantity { kElastic, kStabilizing, kViscous, kRounding, kTether, kQuantities };

}  // namespace fascia::gpu
