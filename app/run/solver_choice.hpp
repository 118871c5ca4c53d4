#pragma once

#include "core/tangent/tangent_solver.hpp"

#include <string>

namespace fascia::app {

/// "linear solver: Cholesky; a factor takes 1.2e+09 operations ...": which one was taken, with the counts behind it.
std::string told(const SolverChoice& choice);

}  // namespace fascia::app
