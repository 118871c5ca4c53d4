#pragma once

#include "core/math/batch.hpp"

#include <utility>

/// Numbers that come together in lanes, or from them. Not for GPU code: nvcc's host pass loses the packs here.
namespace fascia {

/// The batch of value(lane), which goes through no memory.
template <class Value>
Lanes lanes_of(const Value& value) {
  return [&]<int... Lane>(std::integer_sequence<int, Lane...>) { return Lanes::of(Lanes::Register{value(Lane)...}); }
  (std::make_integer_sequence<int, kBatchWidth>{});
}

/// Lanes from First on, half as many.
template <int First, int W, int... I>
Batch<W / 2> half_of(const Batch<W>& a, std::integer_sequence<int, I...>) {
  return Batch<W / 2>::of(__builtin_shufflevector(a.v, a.v, (First + I)...));
}

/// Sum over the lanes, always in the same order.
template <int W>
double lane_sum(const Batch<W>& a) {
  if constexpr (W == 2) {
    return a.v[0] + a.v[1];
  } else {
    constexpr std::make_integer_sequence<int, W / 2> half;
    return lane_sum(half_of<0>(a, half) + half_of<W / 2>(a, half));
  }
}

}  // namespace fascia
