#pragma once

#include "core/math/lane_array.hpp"
#include "core/math/transpose_lanes.hpp"

#include <cstring>
#include <type_traits>
#include <utility>

/// Numbers of which every lane has its own row somewhere in memory. Rows go by whole registers, and a rest that is half
/// a register by halves; any other rest begins early, so that it is a whole one too.
namespace fascia {

/// Loads a register from memory that need not be aligned.
template <class Register>
inline Register load_anywhere(const double* from) {
  Register value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// Stores a register to memory that need not be aligned.
template <class Register>
inline void store_anywhere(double* to, const Register& value) {
  std::memcpy(to, &value, sizeof value);
}

/// Takes W/2 lanes from the lane `First` on.
template <int First, int W>
inline auto half_of(const Batch<W>& batch) {
  return [&]<int... L>(std::integer_sequence<int, L...>) {
    return __builtin_shufflevector(batch.v, batch.v, (First + L)...);
  }
  (std::make_integer_sequence<int, W / 2>{});
}

/// Makes a register of W lanes of two halves.
template <int W, class Half>
inline auto joined(const Half& low, const Half& high) {
  return [&]<int... L>(std::integer_sequence<int, L...>) { return __builtin_shufflevector(low, high, L...); }
  (std::make_integer_sequence<int, W>{});
}

/// Says how rows of N numbers are cut: what goes by whole registers of W lanes, and the rest.
template <int N, int W>
struct RowParts {
  static_assert(N >= W);
  static constexpr int kRest = N % W, kWhole = N - kRest;
  static constexpr bool kHalf = 2 * kRest == W;
  static constexpr int kEarly = N - W;  ///< where a rest begins that is no half
};

/// Turns rows of N numbers, one a lane, into N batches. @param row  row(lane) is where a lane has its own
template <int N, int W, class Row>
inline void gather_rows(const Row& row, Batch<W> (&out)[N]) {
  using Parts = RowParts<N, W>;
  const auto gather = [&](int begin) {
    Batch<W> part[W];
    for (int lane = 0; lane < W; ++lane) part[lane].v = load_anywhere<typename Batch<W>::Register>(row(lane) + begin);
    transpose_lanes(part);
    for (int k = 0; k < W; ++k) out[begin + k].v = part[k].v;
  };
  for (int first = 0; first < Parts::kWhole; first += W) gather(first);
  if constexpr (Parts::kHalf) {
    using Half = decltype(half_of<0>(out[0]));
    Batch<W> part[W / 2];
    for (int lane = 0; lane < W / 2; ++lane)
      part[lane].v = joined<W>(load_anywhere<Half>(row(lane) + Parts::kWhole),
                               load_anywhere<Half>(row(lane + W / 2) + Parts::kWhole));
    transpose_lanes(part);
    for (int k = 0; k < W / 2; ++k) out[Parts::kWhole + k].v = part[k].v;
  } else if constexpr (Parts::kRest > 0) {
    gather(Parts::kEarly);
  }
}

/// Calls act(lane, begin, numbers) with N batches turned into rows: each lane's numbers from `begin` on, as registers
/// or halves of them. @tparam Again  a rest that begins early has the numbers before it again, and not zero
template <bool Again, int N, int W, class Act>
inline void turn_into_rows(const LaneArray<N, W>& in, const Act& act) {
  using Parts = RowParts<N, W>;
  const auto turn = [&](int begin, int zeros) {
    Batch<W> part[W];
    for (int k = 0; k < W; ++k) part[k].v = k < zeros ? typename Batch<W>::Register{} : in[begin + k].v;
    transpose_lanes(part);
    for (int lane = 0; lane < W; ++lane) act(lane, begin, part[lane].v);
  };
  for (int first = 0; first < Parts::kWhole; first += W) turn(first, 0);
  if constexpr (Parts::kHalf) {
    Batch<W> part[W / 2];
    for (int k = 0; k < W / 2; ++k) part[k].v = in[Parts::kWhole + k].v;
    transpose_lanes(part);
    for (int lane = 0; lane < W / 2; ++lane) act(lane, Parts::kWhole, half_of<0>(part[lane]));
    for (int lane = 0; lane < W / 2; ++lane) act(lane + W / 2, Parts::kWhole, half_of<W / 2>(part[lane]));
  } else if constexpr (Parts::kRest > 0) {
    turn(Parts::kEarly, Again ? 0 : W - Parts::kRest);
  }
}

/// Stores N batches to the rows of their lanes.
template <int N, int W, class Row>
inline void store_rows(const LaneArray<N, W>& in, const Row& row) {
  turn_into_rows<true>(in,
                       [&](int lane, int begin, const auto& numbers) { store_anywhere(row(lane) + begin, numbers); });
}

/// Has the processor fetch what will be added to: blocks of a large matrix are in no cache.
inline void prefetch_to_add(const double* numbers, int count) {
  constexpr int kLine = 8;
  for (int k = 0; k < count; k += kLine) __builtin_prefetch(numbers + k, 1);
}

/// Adds N batches to the rows of their lanes, which may be the same ones, a lane after the other.
template <int N, int W, class Row>
inline void add_to_rows(const LaneArray<N, W>& in, const Row& row) {
  turn_into_rows<false>(in, [&](int lane, int begin, const auto& numbers) {
    double* to = row(lane) + begin;
    store_anywhere(to, load_anywhere<std::decay_t<decltype(numbers)>>(to) + numbers);
  });
}

}  // namespace fascia
