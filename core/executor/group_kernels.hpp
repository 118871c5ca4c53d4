#pragma once

#include "core/executor/block_executor.hpp"
#include "core/math/across_lanes.hpp"
#include "core/math/lane_array.hpp"
#include "core/physics/element_law.hpp"

#include <type_traits>

/// Loads of a batch of lanes from the arrays of a point set.
namespace fascia::kernels {

inline constexpr int kBatches = kGroupSize / kBatchWidth;

inline Lanes row(const double* base, int r, int batch) {
  return Lanes::load(base + r * kGroupSize + batch * kBatchWidth);
}

inline Mat3<Lanes> matrix(const double* base, int first_row, int batch) {
  Mat3<Lanes> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = row(base, first_row + 3 * i + j, batch);
  return m;
}

inline void store(double* base, int r, int batch, const Lanes& value) {
  value.store(base + r * kGroupSize + batch * kBatchWidth);
}

inline void store_matrix(double* base, int first_row, int batch, const Mat3<Lanes>& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) store(base, first_row + 3 * i + j, batch, m(i, j));
}

inline Mat3<Lanes> symmetric_matrix(const double* base, int first_row, int batch) {
  Mat3<Lanes> m;
  for (int k = 0; k < 6; ++k) {
    const Lanes value = row(base, first_row + k, batch);
    m(kSymmetricPlaces[k][0], kSymmetricPlaces[k][1]) = value;
    m(kSymmetricPlaces[k][1], kSymmetricPlaces[k][0]) = value;
  }
  return m;
}

inline void store_symmetric(double* base, int first_row, int batch, const Mat3<Lanes>& m) {
  for (int k = 0; k < 6; ++k) store(base, first_row + k, batch, m(kSymmetricPlaces[k][0], kSymmetricPlaces[k][1]));
}

/// Rows of what a step gives a group, or a batch of points of elements (GivenRow).
inline const double* given_rows(std::span<const double> given, std::size_t group) {
  return given.data() + group * kGivenRows * kGroupSize;
}
inline LawFactors<Lanes> law_factors(const double* rows, GivenRow first, int batch) {
  return {row(rows, first, batch), row(rows, first + 1, batch)};
}

/// @param targets  of tethers: (groups with axes × 3 × 8) [m]
/// @param factors  of points that remember stresses: those of the step, or of what never fades
template <Law L>
inline auto material(const PointSet& set, int group, int batch, const BlockState& state,
                     const AlignedVector<double>& targets, GivenRow factors = kGivenFactors) {
  const double* base = set.material_of_group(group);
  MaterialOf<L, Lanes> m;
  m.volume = row(base, kVolume, batch);
  m.lambda = row(base, kLambda, batch);
  m.mu = row(base, kMu, batch);
  m.stabilization = row(base, kStabilization, batch);
  m.viscosity = row(base, kStiffnessDamping, batch) * Lanes(state.inverse_step);
  if constexpr (!is_thin(L)) {
    if constexpr (constexpr int kOwn = SolidLaw<L, Lanes>::kOwn; kOwn > 0)
      for (int k = 0; k < kOwn; ++k) m.own[k] = row(set.own_of_group(group), k, batch);
  } else {
    const GroupRule& rule = set.rule[static_cast<std::size_t>(group)];
    const auto index = static_cast<std::size_t>(rule.axes);
    m.law = rule.rule.law;
    m.transverse = rule.rule.transverse;
    m.axes = matrix(set.axes.data() + index * 9 * kGroupSize, 0, batch);
    if (m.law == Law::tether)
      for (int k = 0; k < 3; ++k) m.target[k] = row(targets.data() + index * 3 * kGroupSize, k, batch);
  }
  if (!state.given.empty()) scale_constants(law_factors(given_rows(state.given, at(group)), factors, batch), m);
  return m;
}

template <class Vector>
Vec3<Lanes> broadcast(const Vector& a) {
  return {{Lanes(a[0]), Lanes(a[1]), Lanes(a[2])}};
}

inline Mat3d stored_matrix(const double* rows) {
  Mat3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = rows[3 * i + j];
  return m;
}

/// Nine batches by rows.
inline Mat3<Lanes> matrix_of(const Lanes* rows) {
  Mat3<Lanes> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = rows[3 * i + j];
  return m;
}

inline Mat3<Lanes> broadcast(const Mat3d& a) {
  Mat3<Lanes> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = Lanes(a(i, j));
  return m;
}

/// H += u gᵀ + D B and, where blended rotations matter, Dbar += w D of one slot; u and D may be a direction (dx, [dr]×
/// Q).
template <bool Blend>
inline void add_slot(const double* shape, int batch, const Vec3<Lanes>& u, const Mat3<Lanes>& D,
                     PointMotion<Lanes>& x) {
  const Lanes w = row(shape, 0, batch);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      x.H(i, j) += u[i] * row(shape, 1 + j, batch) + D(i, 0) * row(shape, 4 + j, batch) +
                   D(i, 1) * row(shape, 7 + j, batch) + D(i, 2) * row(shape, 10 + j, batch);
      if constexpr (Blend) x.Dbar(i, j) += w * D(i, j);
    }
  }
}

/// force += P g of one slot, its component i.
inline void add_slot_force(const double* shape, int batch, const LaneMatrix& P, int i, Lanes& force) {
  for (int k = 0; k < 3; ++k) force += P(i, k) * row(shape, 1 + k, batch);
}
/// moment += P Bᵀ + w Y of one slot, its component (i, j).
template <bool Blend>
inline void add_slot_moment(const double* shape, int batch, const LaneMatrix& P, const LaneMatrix& Y, int i, int j,
                            Lanes& moment) {
  for (int k = 0; k < 3; ++k) moment += P(i, k) * row(shape, 4 + 3 * j + k, batch);
  if constexpr (Blend) moment += row(shape, 0, batch) * Y(i, j);
}

/// Σ over lanes of v P g (3) and v (P Bᵀ + w Y) (9) of one slot; P and Y already carry v.
template <bool Blend>
inline void slot_sums(const double* shape, const LaneMatrix (&P)[kBatches], const LaneMatrix (&Y)[kBatches],
                      double* out) {
  for (int i = 0; i < 3; ++i) {
    Lanes force;
    for (int b = 0; b < kBatches; ++b) add_slot_force(shape, b, P[b], i, force);
    out[i] = lane_sum(force);
    for (int j = 0; j < 3; ++j) {
      Lanes moment;
      for (int b = 0; b < kBatches; ++b) add_slot_moment<Blend>(shape, b, P[b], Y[b], i, j, moment);
      out[3 + 3 * i + j] = lane_sum(moment);
    }
  }
}

/// Rotation − I of a node, or A − I.
inline const Mat3d& turn_of(const BlockState& state, int node) {
  static constexpr Mat3d kNone{};
  return state.D.empty() ? kNone : state.D[static_cast<std::size_t>(node)];
}

/// Strain of a group's batch at the start of the step; zero where nothing is damped.
inline Mat3<Lanes> old_strain(const BlockState& state, int group, int batch) {
  if (state.E.empty()) return {};
  return symmetric_matrix(state.E.data() + static_cast<std::size_t>(group) * 6 * kGroupSize, 0, batch);
}

inline Mat3<Lanes> first_piola(const Mat3<Lanes>& H, const Mat3<Lanes>& S) { return S + H * S; }

/// S₀ of a group's batch: a stress that stays during the step. Only where there is one.
inline Mat3<Lanes> given_stress(const BlockState& state, int group, int batch) {
  return symmetric_matrix(given_rows(state.given, at(group)), kGivenStress, batch);
}

}  // namespace fascia::kernels
