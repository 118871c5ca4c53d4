#pragma once

#include "core/physics/point_physics.hpp"
#include "gpu/lanes.hpp"
#include "gpu/points.hpp"

/// One point of a group at a time, in the layout of core/cpu/group_kernels.hpp.
namespace fascia::gpu::kernels {

template <PointKind::Matter>
struct MaterialOf {
  using Type = SolidMaterial<double>;
};
template <>
struct MaterialOf<PointKind::Matter::neo_hookean> {
  using Type = NeoHookeanMaterial<double>;
};
template <>
struct MaterialOf<PointKind::Matter::thin> {
  using Type = ThinMaterial<double>;
};

template <PointKind::Matter Matter>
FASCIA_HD auto material(const PointsView& set, int group, int lane, double inverse_step) {
  const double* base = set.material + static_cast<std::size_t>(group) * 6 * kGroupSize;
  typename MaterialOf<Matter>::Type m;
  m.volume = row(base, kVolume, lane);
  m.lambda = row(base, kLambda, lane);
  m.mu = row(base, kMu, lane);
  m.stabilization = row(base, kStabilization, lane);
  m.viscosity = row(base, kStiffnessDamping, lane) * inverse_step;
  if constexpr (Matter == PointKind::Matter::thin) {
    const GroupRule& rule = set.rule[group];
    const auto index = static_cast<std::size_t>(rule.axes);
    m.law = rule.rule.law;
    m.transverse = rule.rule.transverse;
    m.axes = matrix(set.axes + index * 9 * kGroupSize, 0, lane);
    if (m.law == Law::tether)
      for (int k = 0; k < 3; ++k) m.target[k] = row(set.targets + index * 3 * kGroupSize, k, lane);
  }
  return m;
}

FASCIA_HD inline const double* shape_of(const PointsView& set, int slot) {
  return set.shape + static_cast<std::size_t>(slot) * 13 * kGroupSize;
}

/// H += u gᵀ + D B, Dbar += w D of one slot.
template <bool Blend>
FASCIA_HD void add_slot(const double* shape, int lane, const Vec3d& u, const Mat3d& D, PointMotion<double>& x) {
  const Vec3d g{{row(shape, 1, lane), row(shape, 2, lane), row(shape, 3, lane)}};
  x.H += outer(u, g) + D * matrix(shape, 4, lane);
  if constexpr (Blend) x.Dbar += D * row(shape, 0, lane);
}

/// Motion of a point. @param u, D  of the nodes; D may be missing
template <bool Blend>
FASCIA_HD PointMotion<double> motion_of(const PointsView& set, int group, int lane, const Vec3d* u, const Mat3d* D) {
  PointMotion<double> x;
  for (int slot = set.slot_begin[group]; slot < set.slot_begin[group + 1]; ++slot) {
    const int node = set.slot_node[slot];
    add_slot<Blend>(shape_of(set, slot), lane, u[node], D == nullptr ? Mat3d{} : D[node], x);
  }
  return x;
}

FASCIA_HD inline Mat3d old_strain(const HistoryView& history, int group, int lane) {
  if (history.E == nullptr) return {};
  return symmetric_matrix(history.E + static_cast<std::size_t>(group) * 6 * kGroupSize, 0, lane);
}

FASCIA_HD inline void store_stress(const PointsView& set, int group, int lane, const Mat3d& P, const Mat3d& Y) {
  double* out = set.stress + static_cast<std::size_t>(group) * 18 * kGroupSize;
  store_matrix(out, 0, lane, P);
  if (set.blends[group] != 0) store_matrix(out, 9, lane, Y);
}

/// The motion of a point for a unit of one degree of freedom of a frame.
template <bool Blend>
FASCIA_HD PointMotion<double> unit_motion(FrameKind kind, int dof, const double* shape, int lane, const Mat3d& Q) {
  PointMotion<double> d;
  if (dof < 3) {
    for (int j = 0; j < 3; ++j) d.H(dof, j) = row(shape, 1 + j, lane);
    return d;
  }
  Mat3d dA;
  if (kind == FrameKind::rigid) {
    Vec3d e;
    e[dof - 3] = 1;
    dA = skew(e) * Q;
  } else {
    dA((dof - 3) % 3, (dof - 3) / 3) = 1;
  }
  add_slot<Blend>(shape, lane, {}, dA, d);
  return d;
}

/// Adds what dP and dY are on a frame to a column of its block.
template <bool Blend>
FASCIA_HD void add_column(FrameKind kind, const double* shape, int lane, const Mat3d& Q, const Mat3d& dP,
                          const Mat3d& dY, double* column) {
  const Vec3d g{{row(shape, 1, lane), row(shape, 2, lane), row(shape, 3, lane)}}, force = dP * g;
  for (int i = 0; i < 3; ++i) column[i] += force[i];
  Mat3d N = times_transpose(dP, matrix(shape, 4, lane));
  if constexpr (Blend) N += dY * row(shape, 0, lane);
  add_moment(kind, N, Q, column + 3);
}

template <PointKind Kind>
FASCIA_HD void add_slot_column(const PointsView& set, int slot, FrameKind kind, const Mat3d& Q, int k,
                               double inverse_step, Tangent tangent, double* column) {
  constexpr bool kBlend = Kind.stabilization != Stabilization::none;
  const int group = set.slot_group[slot];
  const double *point = set.motion + static_cast<std::size_t>(group) * 24 * kGroupSize, *shape = shape_of(set, slot);
  for (int lane = 0; lane < kGroupSize; ++lane) {
    const auto m = material<Kind.matter>(set, group, lane, inverse_step);
    const PointMotion<double> x{matrix(point, 0, lane), matrix(point, 9, lane)},
        unit = unit_motion<kBlend>(kind, k, shape, lane, Q);
    const auto d = point_stress_differential<Kind.stabilization>(x, symmetric_matrix(point, 18, lane), m, tangent,
                                                                 unit.H, unit.Dbar);
    add_column<kBlend>(kind, shape, lane, Q, d.dP * m.volume, d.dY * m.volume, column);
  }
}

/// Calls act.operator()<Kind>() for a rule.
template <class Act>
FASCIA_HD void with_kind(const PointRule& rule, const Act& act) {
  using Matter = PointKind::Matter;
  const Matter matter = rule.law == Law::solid         ? Matter::solid
                        : rule.law == Law::neo_hookean ? Matter::neo_hookean
                                                       : Matter::thin;
  switch (rule.stabilization) {
    case Stabilization::none:
      if (matter == Matter::solid) return act.template operator()<PointKind{Stabilization::none, Matter::solid}>();
      if (matter == Matter::thin) return act.template operator()<PointKind{Stabilization::none, Matter::thin}>();
      return act.template operator()<PointKind{Stabilization::none, Matter::neo_hookean}>();
    case Stabilization::drilling:
      if (matter == Matter::solid) return act.template operator()<PointKind{Stabilization::drilling, Matter::solid}>();
      if (matter == Matter::thin) return act.template operator()<PointKind{Stabilization::drilling, Matter::thin}>();
      return act.template operator()<PointKind{Stabilization::drilling, Matter::neo_hookean}>();
    case Stabilization::affine:
      if (matter == Matter::solid) return act.template operator()<PointKind{Stabilization::affine, Matter::solid}>();
      if (matter == Matter::thin) return act.template operator()<PointKind{Stabilization::affine, Matter::thin}>();
      return act.template operator()<PointKind{Stabilization::affine, Matter::neo_hookean}>();
  }
}

FASCIA_HD inline void add_slot_column(const PointsView& set, int slot, FrameKind kind, const Mat3d& Q, int k,
                                      double inverse_step, Tangent tangent, double* column) {
  with_kind(set.rule[set.slot_group[slot]].rule,
            [&]<PointKind Kind>() { add_slot_column<Kind>(set, slot, kind, Q, k, inverse_step, tangent, column); });
}

}  // namespace fascia::gpu::kernels
