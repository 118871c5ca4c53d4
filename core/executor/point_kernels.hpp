#pragma once

#include "core/executor/group_kernels.hpp"
#include "core/executor/point_executor.hpp"
#include "core/math/lane_rows.hpp"

#include <algorithm>
#include <cstring>

/// Loops of PointFrames.
namespace fascia {

/// P and Y of a group's points, with their volumes.
struct GroupStress {
  LaneMatrix P[kGroupSize / kBatchWidth], Y[kGroupSize / kBatchWidth];  ///< Y only where rotations blend
};

namespace kernels {

/// The shape of a frame that carries its surroundings (LaneFrames::carries()).
struct CarriedShape {
  Lanes w, g[3], r[3];

  CarriedShape(const double* shape, int batch) : w(row(shape, 0, batch)) {
    for (int k = 0; k < 3; ++k) {
      g[k] = row(shape, 1 + k, batch);
      r[k] = row(shape, 4 + k, batch);
    }
  }
};

/// Adds (u + D r) gᵀ to H, which lacks Dbar, and w D to Dbar.
inline void add_carried(const CarriedShape& f, const Lanes (&d)[12], PointMotion<Lanes>& x) {
  for (int i = 0; i < 3; ++i) {
    Lanes u = d[i];
    for (int k = 0; k < 3; ++k) u += d[3 + 3 * i + k] * f.r[k];
    for (int k = 0; k < 3; ++k) {
      x.H(i, k) += u * f.g[k];
      x.Dbar(i, k) += f.w * d[3 + 3 * i + k];
    }
  }
}

/// Sets P g and P g rᵀ + w (P + Y).
template <bool Blend>
inline void carried_sums(const CarriedShape& f, const LaneMatrix& P, const LaneMatrix& Y, LaneArray<12>& out) {
  for (int i = 0; i < 3; ++i) {
    const Lanes force = P(i, 0) * f.g[0] + P(i, 1) * f.g[1] + P(i, 2) * f.g[2];
    out.set(i, force);
    for (int j = 0; j < 3; ++j) out.set(3 + 3 * i + j, force * f.r[j] + f.w * (Blend ? P(i, j) + Y(i, j) : P(i, j)));
  }
}

/// Rows, each for eight points, that are kept of a group at a state. No group has more of them than its stabilisation
/// reads: a processor fetches what stands between those that it reads, too.
enum KeptRow { kKeptH = 0, kKeptS = 9, kKeptDbar = 15, kKeptDrilling = 24, kKeptAll = 27 };
/// Counts them.
constexpr int kept_rows(Stabilization tie) {
  if (tie == Stabilization::none) return kKeptDbar;
  return tie == Stabilization::drilling ? kKeptAll : kKeptDrilling;
}

template <Stabilization Tie>
inline PointMotion<Lanes> kept_motion(const double* rows, int b) {
  PointMotion<Lanes> x;
  x.H = matrix(rows, kKeptH, b);
  if constexpr (Tie != Stabilization::none) x.Dbar = matrix(rows, kKeptDbar, b);
  return x;
}

template <Stabilization Tie>
inline TangentStress<Lanes> kept_stress(const double* rows, int b) {
  TangentStress<Lanes> stress{symmetric_matrix(rows, kKeptS, b), {}};
  if constexpr (Tie == Stabilization::drilling)
    for (int k = 0; k < 3; ++k) stress.drilling[k] = row(rows, kKeptDrilling + k, b);
  return stress;
}

template <Stabilization Tie>
inline void keep(const PointMotion<Lanes>& x, const TangentStress<Lanes>& stress, double* rows, int b) {
  store_matrix(rows, kKeptH, b, x.H);
  store_symmetric(rows, kKeptS, b, stress.S);
  if constexpr (Tie != Stabilization::none) store_matrix(rows, kKeptDbar, b, x.Dbar);
  if constexpr (Tie == Stabilization::drilling)
    for (int k = 0; k < 3; ++k) store(rows, kKeptDrilling + k, b, stress.drilling[k]);
}

}  // namespace kernels

template <std::size_t N, class Act>
void PointFrames::for_each_group(const std::array<Rows, N>& motions, bool sums, const Act& act) {
  const int shared = static_cast<int>(shared_.size()), ranges = (shared + kGrain - 1) / kGrain;
  pool_.for_chunks(ranges + lanes_.patch_count(), [&](int chunk) {
    if (chunk < ranges) {
      for (int i = chunk * kGrain; i < std::min(shared, (chunk + 1) * kGrain); ++i) act(shared_[at(i)], motions);
      return;
    }
    const int patch = chunk - ranges;
    const std::span<const int> nodes = lanes_.nodes(patch);
    alignas(64) double near[N][LaneFrames::kPatchNodes * kNumbers];
    std::array<Rows, N> rows;
    for (std::size_t m = 0; m < N; ++m) {
      rows[m] = near[m];
      for (std::size_t k = 0; k < nodes.size(); ++k)
        std::memcpy(near[m] + k * kNumbers, motions[m] + at(nodes[k]) * kNumbers, kNumbers * sizeof(double));
    }
    if (sums) std::fill_n(sums_of(patch_place_[at(patch)]), nodes.size() * kNumbers, 0.0);
    for (const int group : lanes_.groups(patch)) act(group, rows);
  });
}

template <bool Blend>
PointMotion<Lanes> PointFrames::motion(int group, int batch, Rows rows) const {
  using namespace kernels;
  PointMotion<Lanes> x;
  const int count = lanes_.count(group);
  if (count == 0) {
    const std::span<const int> nodes = set_.nodes(group);
    const double* shape = set_.shape_of_slot(set_.slot_begin[at(group)]);
    for (const int node : nodes) {
      const double* d = rows + at(node) * kNumbers;
      add_slot<Blend>(shape, batch, broadcast(d), broadcast(stored_matrix(d + 3)), x);
      shape += 13 * kGroupSize;
    }
    return x;
  }
  const double* shape = lanes_.shape(group);
  const int stride = lanes_.shape_rows(group) * kGroupSize;
  const std::uint16_t* start = lanes_.starts(group) + batch * kBatchWidth;
  const bool carries = lanes_.carries(group);
  for (int k = 0; k < count; ++k, shape += stride, start += kGroupSize) {
    Lanes d[kNumbers];
    gather_rows([&](int lane) { return rows + start[lane]; }, d);
    if (carries)
      add_carried(CarriedShape(shape, batch), d, x);
    else
      add_slot<Blend>(shape, batch, {{d[0], d[1], d[2]}}, matrix_of(d + 3), x);
  }
  if (carries) x.H += x.Dbar;
  return x;
}

template <bool Blend>
void PointFrames::put(int group, const GroupStress& stress) {
  using namespace kernels;
  double* sums = sums_of(group_place_[at(group)]);
  const int count = lanes_.count(group);
  if (count == 0) {
    const int first = set_.slot_begin[at(group)], frames = set_.slot_begin[at(group + 1)] - first;
    for (int s = 0; s < frames; ++s)
      slot_sums<Blend>(set_.shape_of_slot(first + s), stress.P, stress.Y, sums + s * kNumbers);
    return;
  }
  const double* shape = lanes_.shape(group);
  const int stride = lanes_.shape_rows(group) * kGroupSize;
  const std::uint16_t* start = lanes_.starts(group);
  const bool carries = lanes_.carries(group);
  for (int k = 0; k < count; ++k, shape += stride)
    for (int b = 0; b < kBatches; ++b, start += kBatchWidth) {
      LaneArray<kNumbers> out;
      if (carries) carried_sums<Blend>(CarriedShape(shape, b), stress.P[b], stress.Y[b], out);
      for (int i = 0; i < 3 && !carries; ++i) {
        Lanes force;
        add_slot_force(shape, b, stress.P[b], i, force);
        out.set(i, force);
        for (int j = 0; j < 3; ++j) {
          Lanes moment;
          add_slot_moment<Blend>(shape, b, stress.P[b], stress.Y[b], i, j, moment);
          out.set(3 + 3 * i + j, moment);
        }
      }
      add_to_rows<kNumbers>(out, [&](int lane) { return sums + start[lane]; });
    }
}

}  // namespace fascia
