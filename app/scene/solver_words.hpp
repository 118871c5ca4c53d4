#pragma once

#include "core/tangent/linear_settings.hpp"

#include <array>
#include <string_view>

namespace fascia::app {

/// A linear solver or a preconditioner, in the words of a scene; the first of a list is its default.
template <class Kind>
struct SolverWord {
  Kind kind;
  const char *word, *meaning;
  const char* told = "";  ///< "conjugate gradients ...", of a preconditioner
};

inline constexpr std::array kLinearSolvers = {
    SolverWord<LinearMethod>{LinearMethod::automatic, "auto", "Chosen by size."},
    SolverWord<LinearMethod>{LinearMethod::cg, "cg", "Conjugate gradients."},
    SolverWord<LinearMethod>{LinearMethod::cholesky, "cholesky", "Sparse factorisation."}};

inline constexpr std::array kPreconditioners = {
    SolverWord<PreconditionerKind>{PreconditionerKind::automatic, "auto", "Chosen by size.", "with blocks"},
    SolverWord<PreconditionerKind>{PreconditionerKind::none, "none", "None.", "without a preconditioner"},
    SolverWord<PreconditionerKind>{PreconditionerKind::jacobi, "jacobi", "Diagonal.", "with the diagonal"},
    SolverWord<PreconditionerKind>{PreconditionerKind::block_jacobi, "block-jacobi", "A block for each node.",
                                   "with blocks"},
    SolverWord<PreconditionerKind>{PreconditionerKind::multigrid, "multigrid",
                                   "Levels of rigid frames: iterations hardly grow with the number of unknowns.",
                                   "with levels"},
    SolverWord<PreconditionerKind>{PreconditionerKind::cholesky, "cholesky", "An older factorisation.",
                                   "with a factor"}};

/// The default where there is none of that name, which the schema has refused.
template <class Words>
constexpr auto kind_of(const Words& words, std::string_view text) {
  for (const auto& known : words)
    if (text == known.word) return known.kind;
  return words[0].kind;
}

}  // namespace fascia::app
