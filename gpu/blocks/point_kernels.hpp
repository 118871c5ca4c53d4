#pragma once

#include "core/physics/point_physics.hpp"
#include "gpu/blocks/points.hpp"
#include "gpu/space/lanes.hpp"

/// One point of a group at a time, in the layout of core/executor/group_kernels.hpp.
namespace fascia::gpu::kernels {

/// @param given    rows of all groups, or null
/// @param factors  those of the step, or of what never fades
template <Law L, class T>
FASCIA_HD auto material(const PointsOf<T>& set, int group, int lane, double inverse_step, const double* given,
                        GivenRow factors = kGivenFactors) {
  const T* base = set.material + static_cast<std::size_t>(group) * 6 * kGroupSize;
  MaterialOf<L, T> m;
  m.volume = row(base, kVolume, lane);
  m.lambda = row(base, kLambda, lane);
  m.mu = row(base, kMu, lane);
  m.stabilization = row(base, kStabilization, lane);
  m.viscosity = row(base, kStiffnessDamping, lane) * static_cast<T>(inverse_step);
  if constexpr (!is_thin(L)) {
    if constexpr (constexpr int kOwn = SolidLaw<L, T>::kOwn; kOwn > 0)
      for (int k = 0; k < kOwn; ++k) m.own[k] = row(set.own, set.rule[group].own + k, lane);
  } else {
    const GroupRule& rule = set.rule[group];
    const auto index = static_cast<std::size_t>(rule.axes);
    m.law = rule.rule.law;
    m.transverse = rule.rule.transverse;
    m.axes = matrix(set.axes + index * 9 * kGroupSize, 0, lane);
    if (m.law == Law::tether)
      for (int k = 0; k < 3; ++k) m.target[k] = static_cast<T>(row(set.targets + index * 3 * kGroupSize, k, lane));
  }
  if (given != nullptr)
    scale_constants(law_factors<T>(given_rows(given, static_cast<std::size_t>(group)), factors, lane), m);
  return m;
}

/// S₀ of a point, which stays during the step.
FASCIA_HD inline Mat3d given_stress(const double* given, int group, int lane) {
  return symmetric_matrix(given_rows(given, static_cast<std::size_t>(group)), kGivenStress, lane);
}
FASCIA_HD inline Mat3d first_piola(const Mat3d& H, const Mat3d& S) { return S + H * S; }

template <class T>
FASCIA_HD const T* shape_of(const PointsOf<T>& set, int slot) {
  return set.shape + static_cast<std::size_t>(slot) * 13 * kGroupSize;
}

/// H += u gᵀ + D B, Dbar += w D of one slot.
template <bool Blend, class T>
FASCIA_HD void add_slot(const T* shape, int lane, const Vec3<T>& u, const Mat3<T>& D, PointMotion<T>& x) {
  const Vec3<T> g{{row(shape, 1, lane), row(shape, 2, lane), row(shape, 3, lane)}};
  x.H += outer(u, g) + D * matrix(shape, 4, lane);
  if constexpr (Blend) x.Dbar += D * row(shape, 0, lane);
}

/// Motion of a point. Of 32 bits, displacements count from the first node's where a translation leaves the point at
/// rest: Σ g = 0 but for a tether. @param u, D  of the nodes; D may be missing
template <bool Blend, class T, class V>
FASCIA_HD PointMotion<T> motion_of(const PointsOf<T>& set, int group, int lane, const Vec3<V>* u, const Mat3<T>* D) {
  PointMotion<T> x;
  const int begin = set.slot_begin[group], end = set.slot_begin[group + 1];
  [[maybe_unused]] Vec3<V> origin;
  if constexpr (!std::is_same_v<T, double>)
    if (set.rule[group].rule.law != Law::tether) origin = u[set.slot_node[begin]];
  for (int slot = begin; slot < end; ++slot) {
    const int node = set.slot_node[slot];
    Vec3<T> moved;
    if constexpr (std::is_same_v<T, double>)
      moved = u[node];
    else
      moved = rounded<T>(u[node] - origin);
    add_slot<Blend>(shape_of(set, slot), lane, moved, D == nullptr ? Mat3<T>{} : D[node], x);
  }
  return x;
}

FASCIA_HD inline Mat3d old_strain(const HistoryView& history, int group, int lane) {
  if (history.E == nullptr) return {};
  return symmetric_matrix(history.E + static_cast<std::size_t>(group) * 6 * kGroupSize, 0, lane);
}

/// Rows that a linearisation kept of a group.
template <class T>
FASCIA_HD const T* linearized_rows(const PointsOf<T>& set, int group) {
  return set.motion + static_cast<std::size_t>(group) * kPointRows * kGroupSize;
}
template <bool Blend, class T>
FASCIA_HD PointMotion<T> linearized_motion(const T* rows, int lane) {
  return {matrix(rows, 0, lane), Blend ? matrix(rows, 9, lane) : Mat3<T>{}};
}
template <bool Drilling, class T>
FASCIA_HD TangentStress<T> linearized_stress(const T* rows, int lane) {
  TangentStress<T> s{symmetric_matrix(rows, 18, lane), {}};
  if constexpr (Drilling)
    for (int k = 0; k < 3; ++k) s.drilling[k] = row(rows, 24 + k, lane);
  return s;
}

/// dP and dY of a direction at the linearisation.
template <PointKind Kind, class T, class Material>
FASCIA_HD PointStressDifferential<T> differential_of(const T* rows, int lane, const Material& m, Tangent tangent,
                                                     const PointMotion<T>& d) {
  constexpr Stabilization kTie = Kind.stabilization;
  return point_stress_differential<kTie>(linearized_motion<kTie != Stabilization::none>(rows, lane),
                                         linearized_stress<kTie == Stabilization::drilling>(rows, lane), m, tangent, d);
}

template <class T>
FASCIA_HD void store_stress(const PointsOf<T>& set, int group, int lane, const Mat3<T>& P, const Mat3<T>& Y) {
  T* out = set.stress + static_cast<std::size_t>(group) * 18 * kGroupSize;
  store_matrix(out, 0, lane, P);
  if (set.blends[group] != 0) store_matrix(out, 9, lane, Y);
}

/// The motion of a point for a unit of one degree of freedom of a frame.
template <bool Blend, class T>
FASCIA_HD PointMotion<T> unit_motion(FrameKind kind, int dof, const T* shape, int lane, const Mat3<T>& Q) {
  PointMotion<T> d;
  if (dof < 3) {
    for (int j = 0; j < 3; ++j) d.H(dof, j) = row(shape, 1 + j, lane);
    return d;
  }
  Mat3<T> dA;
  if (kind == FrameKind::rigid) {
    Vec3<T> e;
    e[dof - 3] = 1;
    dA = skew(e) * Q;
  } else {
    dA((dof - 3) % 3, (dof - 3) / 3) = 1;
  }
  add_slot<Blend>(shape, lane, {}, dA, d);
  return d;
}

/// Adds what dP and dY are on a frame to a column of its block.
template <bool Blend, class T>
FASCIA_HD void add_column(FrameKind kind, const T* shape, int lane, const Mat3d& Q, const Mat3<T>& dP,
                          const Mat3<T>& dY, double* column) {
  const Vec3<T> g{{row(shape, 1, lane), row(shape, 2, lane), row(shape, 3, lane)}}, force = dP * g;
  for (int i = 0; i < 3; ++i) column[i] += force[i];
  Mat3<T> N = times_transpose(dP, matrix(shape, 4, lane));
  if constexpr (Blend) N += dY * row(shape, 0, lane);
  add_moment(kind, rounded<double>(N), Q, column + 3);
}

template <PointKind Kind, class T>
FASCIA_HD void add_slot_column(const PointsOf<T>& set, int slot, FrameKind kind, const Mat3d& Q, int k,
                               double inverse_step, const double* given, Tangent tangent, double* column) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const int group = set.slot_group[slot];
  const T *rows = linearized_rows(set, group), *shape = shape_of(set, slot);
  for (int lane = 0; lane < kGroupSize; ++lane) {
    const auto m = material<Kind.law>(set, group, lane, inverse_step, given);
    const PointMotion<T> unit = unit_motion<kBlend>(kind, k, shape, lane, rounded<T>(Q));
    const auto d = differential_of<Kind>(rows, lane, m, tangent, unit);
    add_column<kBlend>(kind, shape, lane, Q, d.dP * m.volume, d.dY * m.volume, column);
  }
}

template <class T>
FASCIA_HD void add_slot_column(const PointsOf<T>& set, int slot, FrameKind kind, const Mat3d& Q, int k,
                               double inverse_step, const double* given, Tangent tangent, double* column) {
  with_kind(set.rule[set.slot_group[slot]].rule, [&]<PointKind Kind>() {
    add_slot_column<Kind>(set, slot, kind, Q, k, inverse_step, given, tangent, column);
  });
}

}  // namespace fascia::gpu::kernels
