#pragma once

#include "app/scene/scene.hpp"
#include "core/solver/settings.hpp"
#include "core/solver/time_scheme.hpp"

namespace fascia::app {

/// What a scene's solver asks of Newton's method and the linear solver.
SolverSettings settings_of(const Solver& solver);

/// Implicit Euler where the solver has no scheme of its own.
TimeScheme scheme_of(SolverKind kind);

}  // namespace fascia::app
