#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/space/pool_space.hpp"
#include "core/step/dependents.hpp"

namespace fascia {

/// K ← Tᵀ K T, both halves, with the T of dependent nodes at the rotations that they took.
void condense(const Dependents<PoolSpace>& dependents, BlockMatrix& K);

}  // namespace fascia
