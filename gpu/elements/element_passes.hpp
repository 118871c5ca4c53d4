#pragma once

#include "core/math/polar.hpp"
#include "core/space/space.hpp"
#include "gpu/elements/element_state.hpp"

/// Loops over elements, and over the points and corners of those with several points: what passes between these loops
/// is in points_buffer.
namespace fascia::gpu::kernels {

/// Σ u gᵀ of a point. Of 32 bits, u counts from the first node's, as Σ g = 0.
template <class T, class V>
FASCIA_HD Mat3<T> point_gradient(const ElementBlockOf<T>& block, int batch, int q, int lane, const Vec3<V>* values) {
  const T* g = gradient_of(block, batch, q);
  [[maybe_unused]] Vec3<V> first;
  if constexpr (!std::is_same_v<T, double>) first = values[node_of(block, batch, 0, lane)];
  Mat3<T> H;
  for (int a = 0; a < block.nodes; ++a) {
    Vec3<T> u;
    if constexpr (std::is_same_v<T, double>)
      u = values[node_of(block, batch, a, lane)];
    else
      u = rounded<T>(values[node_of(block, batch, a, lane)] - first);
    H += outer(u, gradient(g, a, lane));
  }
  return H;
}

/// Displacement gradients at the points of elements. @param values  by node of the model
template <class T, class V>
struct GradientPass {
  ElementBlockOf<T> block;
  const Vec3<V>* values;
  T* out;  ///< (batches × points × 9 × 8)

  FASCIA_HD int count() const { return block.lanes() * block.points; }
  FASCIA_HD void operator()(int i) const {
    const int lane = i % kLanes, q = i / kLanes % block.points, batch = i / kLanes / block.points;
    store_matrix(point_rows(out, block, batch, q), 0, lane, point_gradient(block, batch, q, lane, values));
  }
};

/// Forces on corners: Σ v P g over the points.
template <class T>
struct CornerPass {
  ElementBlockOf<T> block;

  FASCIA_HD int count() const { return block.lanes() * block.nodes; }
  FASCIA_HD void operator()(int i) const {
    const int lane = i % kLanes, a = i / kLanes % block.nodes, batch = i / kLanes / block.nodes;
    Vec3<T> force;
    for (int q = 0; q < block.points; ++q)
      force += matrix(point_rows(block.points_buffer, block, batch, q), 0, lane) *
               gradient(gradient_of(block, batch, q), a, lane);
    store_corner(block, batch, a, lane, force);
  }
};

/// Square of what rounding leaves in a point's forces (core/executor/element_forces.cpp).
FASCIA_HD inline double rounding_of(const Mat3d& H, const Mat3d& P, const ElementMaterial<double>& m, double v,
                                    double squared_gradient, double motion) {
  const double stiffness = v * (m.lambda + m.mu * 2.0) * (1.0 + m.viscosity), strain = contract(H, H);
  const double moved = squared_gradient * motion * motion;
  return squared_gradient * (v * v * contract(P, P) + stiffness * stiffness * (strain + moved) * (1.0 + strain));
}

/// One thread has a whole element, or one of its points where these do not need each other.
template <Law L, int N, class T>
struct ElementPass {
  ElementBlockOf<T> block;
  HistoryView history;
  bool split = false;  ///< by points

  /// @param whole  even where points do not need each other
  ElementPass(const ElementBlockOf<T>& b, const HistoryView& past, bool whole)
      : block(b), history(past), split(N == 0 && !whole && L != Law::corotational && !b.penalised) {}
  FASCIA_HD int count() const { return block.lanes() * (split ? block.points : 1); }
  /// @param u  displacements of the model's nodes, H  of points: used where the element has one point, or several
  FASCIA_HD ElementPoints<N, T> points_of(int i, const Vec3d* u, const T* H) const {
    if constexpr (N == 4) {
      ElementPoints<4, T> x(block, i, history);
      x.gradient_at_state = x.gradient_of_nodes(u);
      return x;
    } else {
      const int lane = i % kLanes, rest = i / kLanes;
      if (!split) return {block, rest, lane, 0, block.points, history, H};
      const int q = rest % block.points;
      return {block, rest / block.points, lane, q, q + 1, history, H};
    }
  }
};

/// The rotation of an element's mean. @param kept  that of the linearisation
template <Law L, int N, class T>
FASCIA_HD ElementTurn<T> turn_of(const ElementPoints<N, T>& x, bool kept) {
  ElementTurn<T> turn;
  if constexpr (L == Law::corotational) {
    turn.H = mean_gradient(x);
    if (!kept) {
      turn.D = rounded<T>(nearest_rotation_increment(rounded<double>(turn.H)));
      return turn;
    }
    const T* rows = x.block.turn + at(x.batch) * 6 * kLanes;
    Vec3<T> d[2], e[2];
    for (int k = 0; k < 2; ++k) {
      d[k] = gradient(rows, k, x.lane);
      e[k][k] = 1;
    }
    // (e₁ + d₁) × (e₂ + d₂) − e₃
    turn.D = Mat3<T>::from_columns(d[0], d[1], cross(e[0], d[1]) + cross(d[0], e[1]) + cross(d[0], d[1]));
  }
  return turn;
}

template <Law L, int N>
struct ForcesPass : ElementPass<L, N, double> {
  using ElementPass<L, N, double>::block;
  using ElementPass<L, N, double>::history;
  NodesView nodes;
  const Vec3d* u;
  const double* part_motion;

  FASCIA_HD void operator()(int i) const {
    const ElementPoints<N, double> x = this->points_of(i, u, block.points_buffer);
    if (x.batch * kLanes + x.lane >= block.count) return;
    const auto m = element_material<L>(block, x.batch, x.lane, history);
    const double pressure = block.averaged ? mean_of_nodes(block, x.batch, x.lane) : 0.0;
    const ElementAt<L, N, double> element(x, m, turn_of<L>(x, false), pressure, true);
    double elastic = 0, viscous = 0, rounding = 0, motion = 0;
    if (part_motion != nullptr) motion = part_motion[nodes.part[node_of(block, x.batch, 0, x.lane)]];
    for (int q = x.begin(); q < x.end(); ++q) {
      const double v = x.v(q);
      const Mat3d P = element.first_piola(q);
      if (part_motion != nullptr) {
        elastic += v * element.elastic_density(q);
        if (block.damped) viscous += v * element.viscous_density(q);
        if (history.given != nullptr) split(element, x, q, elastic, viscous);
        rounding += rounding_of(x.H(q), P, m, v, x.squared_gradient(q), motion);
      }
      if constexpr (N == 4)
        x.store_forces(P * v);
      else
        store_matrix(point_rows(block.points_buffer, block, x.batch, q), 0, x.lane, P * v);
    }
    if (part_motion == nullptr) return;
    double* quantities = block.quantities + at(i) * kQuantities;
    const double averaged = averaged_energy(x);
    const double lasting = bulk_factor(history.given, kLastingFactors) / bulk_factor(history.given);
    quantities[kElastic] = elastic + element.penalty_energy() + averaged * lasting;
    quantities[kViscous] = viscous + averaged * (1 - lasting);
    quantities[kRounding] = rounding;
  }

 private:
  /// Where points remember stresses, what never fades is elastic, and the rest of the step's potential viscous.
  FASCIA_HD void split(const ElementAt<L, N, double>& element, const ElementPoints<N, double>& x, int q,
                       double& elastic, double& viscous) const {
    const auto lasting = element_material<L>(block, x.batch, x.lane, history, kLastingFactors);
    const double fading = element.elastic_density(q) - element.elastic_density(q, lasting);
    elastic -= x.v(q) * fading;
    viscous += x.v(q) * (fading + contract(x.given(q), element.strain(q)));
  }
  /// The element's share of k V θ²/2 of its nodes.
  FASCIA_HD static double averaged_energy(const ElementPoints<N, double>& x) {
    const ElementBlockView& block = x.block;
    if (!block.averaged) return 0;
    double energy = 0;
    for (int a = 0; a < 4; ++a) {
      const int node = node_of(block, x.batch, a, x.lane);
      const double k = block.node_modulus[node], p = block.node_pressure[node];
      if (k != 0) energy += 0.125 * x.v(0) * p * p / k;
    }
    return energy / bulk_factor(x.history.given);
  }
};

/// Keeps rotations and mean pressures.
template <Law L, int N, class T>
struct LinearizePass : ElementPass<L, N, T> {
  using ElementPass<L, N, T>::block;
  const Vec3d* u;

  FASCIA_HD void operator()(int i) const {
    const ElementPoints<N, T> x = this->points_of(i, u, block.H);
    if (block.averaged) block.pressure[i] = mean_of_nodes(block, x.batch, x.lane);
    if constexpr (L == Law::corotational) {
      const Mat3<T> D = turn_of<L>(x, false).D;
      T* rows = block.turn + at(x.batch) * 6 * kLanes;
      for (int k = 0; k < 2; ++k)
        for (int r = 0; r < 3; ++r) rows[(3 * k + r) * kLanes + x.lane] = D(r, k);
    }
  }
};

/// Where a point is computed alone, the gradient of dx needs no pass of its own.
template <Law L, int N, class T, class V, bool Plain>
struct ProductPass : ElementPass<L, N, T> {
  using ElementPass<L, N, T>::block;
  using ElementPass<L, N, T>::history;
  const Vec3d* u;
  const Vec3<V>* dx;
  bool full;

  FASCIA_HD void operator()(int i) const {
    const ElementPoints<N, T> x = this->points_of(i, u, block.H);
    const auto m = element_material<L>(block, x.batch, x.lane, history);
    ElementAt<L, N, T, Plain> element(x, m, turn_of<L>(x, true), block.averaged ? block.pressure[i] : T(0), full);
    if constexpr (N == 4) {
      const Mat3<T> dF = x.gradient_of_nodes(dx);
      element.begin_direction([&](int) { return dF; });
      Mat3<T> dP = element.differential(0, dF);
      if constexpr (L != Law::corotational)
        if (block.averaged) dP += SolidLaw<L, T>::volumetric_gradient(x.H(0)) * mean_of_nodes(block, x.batch, x.lane);
      x.store_forces(dP * x.v(0));
    } else {
      const auto dF = [&](int q) {
        return this->split ? point_gradient(block, x.batch, q, x.lane, dx)
                           : matrix(point_rows(block.points_buffer, block, x.batch, q), 0, x.lane);
      };
      element.begin_direction(dF);
      for (int q = x.begin(); q < x.end(); ++q)
        store_matrix(point_rows(block.points_buffer, block, x.batch, q), 0, x.lane,
                     element.differential(q, dF(q)) * x.v(q));
    }
  }
};

/// Force on a node for a unit motion of its own along `axis`: a thread for each corner of an element.
template <Law L, int N, class T>
struct DiagonalPass : ElementPass<L, N, T> {
  using ElementPass<L, N, T>::block;
  using ElementPass<L, N, T>::history;
  const Vec3d* u;
  bool full;
  int axis;

  FASCIA_HD int count() const { return block.lanes() * block.nodes; }
  FASCIA_HD void operator()(int i) const {
    const int lane = i % kLanes, corner = i / kLanes % block.nodes, batch = i / kLanes / block.nodes;
    const int e = batch * kLanes + lane;
    const ElementPoints<N, T> x = this->points_of(e, u, block.H);
    const auto m = element_material<L>(block, batch, lane, history);
    ElementAt<L, N, T> element(x, m, turn_of<L>(x, true), block.averaged ? block.pressure[e] : T(0), full);
    const auto gradient_at = [&](int q) { return gradient(gradient_of(block, batch, q), corner, lane); };
    const auto dF = [&](int q) {
      Vec3<T> unit;
      unit[axis] = 1;
      return outer(unit, gradient_at(q));
    };
    element.begin_direction(dF);
    Vec3<T> force;
    for (int q = x.begin(); q < x.end(); ++q) force += element.differential(q, dF(q)) * gradient_at(q) * x.v(q);
    store_corner(block, batch, corner, lane, force);
  }
};

/// Stresses extrapolated along a step. Of several points, H at its start is in points_buffer.
template <Law L, int N>
struct ExtrapolationPass : ElementPass<L, N, double> {
  using ElementPass<L, N, double>::block;
  using ElementPass<L, N, double>::history;
  TakenStepView taken;
  double* S;

  FASCIA_HD void operator()(int i) const {
    const ElementPoints<N, double> x = this->points_of(i, taken.start.u, block.points_buffer);
    const ElementAt<L, N, double> element(x, element_material<L>(block, x.batch, x.lane, history), turn_of<L>(x, false),
                                          0, true);
    for (int q = x.begin(); q < x.end(); ++q) {
      const Mat3d dF = point_gradient(block, x.batch, q, x.lane, taken.direction.dx) * taken.length;
      store_symmetric(S + (at(x.batch) * at(block.points) + at(q)) * 6 * kLanes, 0, x.lane,
                      element.extrapolated_stress(q, dF));
    }
  }
};

/// The largest rotation of a motion at a point, to first order.
struct SpinPass {
  ElementBlockView block;
  const Vec3d* dx;

  FASCIA_HD int count() const { return block.lanes() * block.points; }
  FASCIA_HD void operator()(int i, Sums<0, 1>& sums) const {
    const int lane = i % kLanes, q = i / kLanes % block.points, batch = i / kLanes / block.points;
    sums.note(0, 0.5 * norm(axl(point_gradient(block, batch, q, lane, dx))));
  }
};

/// Stores what fades: the law's stress, in the element's axes where it turns.
template <Law L, int N>
struct FadingPass : ElementPass<L, N, double> {
  using ElementPass<L, N, double>::block;
  using ElementPass<L, N, double>::history;
  const Vec3d* u;
  double* S;

  FASCIA_HD void operator()(int i) const {
    const ElementPoints<N, double> x = this->points_of(i, u, block.points_buffer);
    const double pressure = block.averaged ? mean_of_nodes(block, x.batch, x.lane) : 0.0;
    const ElementAt<L, N, double> element(x, element_material<L>(block, x.batch, x.lane, history), turn_of<L>(x, false),
                                          pressure, true);
    for (int q = x.begin(); q < x.end(); ++q)
      store_symmetric(S + (at(x.batch) * at(block.points) + at(q)) * 6 * kLanes, 0, x.lane, element.stress(q));
  }
};

template <Law L, int N>
struct StrainPass : ElementPass<L, N, double> {
  using ElementPass<L, N, double>::block;
  const Vec3d* u;
  double* E;

  FASCIA_HD void operator()(int i) const {
    const ElementPoints<N, double> x = this->points_of(i, u, block.points_buffer);
    const ElementAt<L, N, double> element(x, element_material<L>(block, x.batch, x.lane, HistoryView{}),
                                          turn_of<L>(x, false), 0, true);
    for (int q = x.begin(); q < x.end(); ++q)
      store_symmetric(E + (at(x.batch) * at(block.points) + at(q)) * 6 * kLanes, 0, x.lane, element.strain(q));
  }
};

}  // namespace fascia::gpu::kernels
