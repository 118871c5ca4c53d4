#pragma once

#include "core/math/batch.hpp"

#include <utility>

namespace fascia {

/// Turns Rows batches of W lanes into one another, each Rows lanes by themselves: lane l of batch k becomes lane k of
/// batch l, lane Rows + l of batch k lane Rows + k of batch l.
template <int Step = 1, int W, int Rows>
void transpose_lanes(Batch<W> (&rows)[Rows]) {
  static_assert(W % Rows == 0);
  using Register = typename Batch<W>::Register;
  const auto exchange = []<int... L>(std::integer_sequence<int, L...>, Register & a, Register & b) {
    const Register low = __builtin_shufflevector(a, b, ((L & Step) != 0 ? W + L - Step : L)...);
    b = __builtin_shufflevector(a, b, ((L & Step) != 0 ? W + L : L + Step)...);
    a = low;
  };
  if constexpr (Step < Rows) {
    for (int i = 0; i < Rows; ++i)
      if ((i & Step) == 0) exchange(std::make_integer_sequence<int, W>{}, rows[i].v, rows[i + Step].v);
    transpose_lanes<2 * Step>(rows);
  }
}

}  // namespace fascia
