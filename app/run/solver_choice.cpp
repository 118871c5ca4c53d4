#include "app/run/solver_choice.hpp"

#include "app/scene/solver_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fascia::app {

namespace {

std::string preconditioned_by(const SolverChoice& choice) {
  if (choice.preconditioner == PreconditionerKind::multigrid)
    return fmt::format("with levels of {} nodes", fmt::join(choice.levels, ", "));
  return std::ranges::find(kPreconditioners, choice.preconditioner, &SolverWord<PreconditionerKind>::kind)->told;
}

}  // namespace

std::string told(const SolverChoice& choice) {
  std::string text = "linear solver: ";
  text += choice.direct ? "Cholesky" : "conjugate gradients " + preconditioned_by(choice);
  if (choice.old > 0)
    text += fmt::format("; {} factors, which {} more solves took as preconditioner", choice.factors, choice.old);
  if (choice.flops == 0) return text;
  return text +
         fmt::format(
             "; a factor {} {:.2g} operations and {:.2g} numbers, {:.0f} operations for each number of the "
             "matrix (beyond {:.0f}, and {} unknowns, \"auto\" takes conjugate gradients; in dynamics it tries them "
             "first)",
             choice.direct ? "takes" : "would take at most", choice.flops, choice.numbers, choice.flops_per_number,
             TangentSolver::kFlopsPerNumber, TangentSolver::kDirectDofs);
}

}  // namespace fascia::app
