#pragma once

#include "core/linear/block_matrix.hpp"
#include "core/space/pool_space.hpp"
#include "core/step/dependents.hpp"

#include <memory>

namespace fascia {

/// Turns matrices of all nodes into those of the nodes that do not depend on others, with what it works in kept.
class Condensation {
 public:
  /// Dependents, layout and pool belong to the caller.
  /// @param at_once  dependent nodes whose rows are kept at the same time; results do not depend on it
  Condensation(const Dependents<PoolSpace>& dependents, const DofLayout& dofs, ThreadPool& pool, int at_once = 1024);
  ~Condensation();

  /// K ← Tᵀ K T, both halves, with the T of dependent nodes at the rotations that they took. Bits do not depend on the
  /// number of threads. Does nothing where no node depends.
  void condense(BlockMatrix& K);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascia
