#pragma once

#include "core/math/lane_array.hpp"
#include "core/math/transpose_lanes.hpp"

#include <algorithm>
#include <cstring>

/// Numbers of which every lane has its own row somewhere in memory.
namespace fascia {

inline Lanes load_anywhere(const double* from) {
  Lanes value;
  std::memcpy(&value.v, from, sizeof value.v);
  return value;
}
inline void store_anywhere(double* to, const Lanes& value) { std::memcpy(to, &value.v, sizeof value.v); }

/// Turns rows of N numbers, one a lane, into N batches. @param row  row(lane) is where a lane has its own
template <int N, class Row>
inline void gather_rows(const Row& row, Lanes (&out)[N]) {
  constexpr int W = kBatchWidth;
  static_assert(N >= W);
  for (int first = 0; first < N; first += W) {
    const int begin = std::min(first, N - W);
    Lanes part[W];
    for (int lane = 0; lane < W; ++lane) part[lane] = load_anywhere(row(lane) + begin);
    transpose_lanes(part);
    for (int k = 0; k < W; ++k) out[begin + k] = part[k];
  }
}

/// Stores N batches to the rows of their lanes.
template <int N, class Row>
inline void store_rows(const LaneArray<N>& in, const Row& row) {
  constexpr int W = kBatchWidth;
  static_assert(N >= W);
  for (int first = 0; first < N; first += W) {
    const int begin = std::min(first, N - W);
    Lanes part[W];
    for (int k = 0; k < W; ++k) part[k] = in[begin + k];
    transpose_lanes(part);
    for (int lane = 0; lane < W; ++lane) store_anywhere(row(lane) + begin, part[lane]);
  }
}

/// Adds N batches to the rows of their lanes, which may be the same ones, a lane after the other.
template <int N, class Row>
inline void add_to_rows(const LaneArray<N>& in, const Row& row) {
  constexpr int W = kBatchWidth;
  static_assert(N >= W);
  for (int first = 0; first < N; first += W) {
    const int begin = std::min(first, N - W);
    Lanes part[W];
    for (int k = 0; k < W; ++k) part[k] = begin + k < first ? Lanes{} : in[begin + k];
    transpose_lanes(part);
    for (int lane = 0; lane < W; ++lane) {
      double* to = row(lane) + begin;
      store_anywhere(to, load_anywhere(to) + part[lane]);
    }
  }
}

}  // namespace fascia
