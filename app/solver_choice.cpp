#include "app/solver_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fascia::app {

std::string told(const SolverChoice& choice) {
  std::string solver = "Cholesky";
  if (!choice.direct)
    solver = choice.levels.empty()
                 ? "conjugate gradients with blocks"
                 : fmt::format("conjugate gradients with levels of {} nodes", fmt::join(choice.levels, ", "));
  return fmt::format(
      "linear solver: {}; a factor {} {:.2g} operations and {:.2g} numbers, {:.0f} operations for each number of the "
      "matrix (beyond {:.0f}, and {} unknowns, \"auto\" takes conjugate gradients)",
      solver, choice.direct ? "takes" : "would take", choice.flops, choice.numbers, choice.flops_per_number,
      TangentSolver::kFlopsPerNumber, TangentSolver::kDirectDofs);
}

}  // namespace fascia::app
