#pragma once

#include "core/math/batch.hpp"

#include <utility>

namespace fascia {

/// Turns W batches into one another: lane l of batch k becomes lane k of batch l.
template <int W, int Step = 1>
void transpose_lanes(Batch<W> (&rows)[W]) {
  using Register = typename Batch<W>::Register;
  const auto exchange = []<int... L>(std::integer_sequence<int, L...>, Register & a, Register & b) {
    const Register low = __builtin_shufflevector(a, b, ((L & Step) != 0 ? W + L - Step : L)...);
    b = __builtin_shufflevector(a, b, ((L & Step) != 0 ? W + L : L + Step)...);
    a = low;
  };
  for (int i = 0; i < W; ++i)
    if ((i & Step) == 0) exchange(std::make_integer_sequence<int, W>{}, rows[i].v, rows[i + Step].v);
  if constexpr (2 * Step < W) transpose_lanes<W, 2 * Step>(rows);
}

}  // namespace fascia
